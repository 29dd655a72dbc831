// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Members of somebody else's class that are not public. SLOPE_REVEAL(CLASS, TYPE, MEMBER) makes CLASS_MEMBER::at(), a
   pointer to this member, or nullptr where the class has none of this name and type: then it compiles all the same.
   For one source file, outside of any namespace. */

#ifndef SLOPE_REVEAL_H
#define SLOPE_REVEAL_H

#include <type_traits>

namespace Slope {

template <typename Tag, typename Type> struct RevealedMember {
  static Type &at()
  {
    static Type pointer = nullptr;
    return pointer;
  }
  template <typename Other> static void take(Other pointer)
  {
    take_if(std::is_convertible<Other, Type>(), pointer);
  }

 private:
  template <typename Other> static void take_if(std::true_type, Other pointer) { at() = pointer; }
  template <typename Other> static void take_if(std::false_type, Other) {}
};

// C++ does not check access in the arguments of an explicit instantiation, which take it from there when the program starts

template <typename Tag, typename Type, Type pointer> struct Reveal {
  struct AtStart {
    AtStart() { Tag::take(pointer); }
  };
  static AtStart at_start;
};
template <typename Tag, typename Type, Type pointer>
typename Reveal<Tag, Type, pointer>::AtStart Reveal<Tag, Type, pointer>::at_start;

// Owner: the class if it has such a member, of whatever access; beside one that is inherited too, its name means two things

#define SLOPE_REVEAL(CLASS, TYPE, MEMBER)                                                     \
  struct CLASS##_##MEMBER : Slope::RevealedMember<CLASS##_##MEMBER, TYPE(CLASS::*)> {         \
    struct None {                                                                             \
      char MEMBER;                                                                            \
    };                                                                                        \
    template <typename T> struct Both : T, None {                                             \
    };                                                                                        \
    template <typename T> static None *owner(decltype(&Both<T>::MEMBER));                     \
    template <typename T> static T *owner(...);                                               \
    typedef std::remove_pointer<decltype(owner<CLASS>(nullptr))>::type Owner;                 \
  };                                                                                          \
  template struct Slope::Reveal<CLASS##_##MEMBER, decltype(&CLASS##_##MEMBER::Owner::MEMBER), \
                                &CLASS##_##MEMBER::Owner::MEMBER>;

// whether all of these members are known
template <typename... Member> bool revealed()
{
  bool all = true;
  for (bool known : {(Member::at() != nullptr)...}) all = all && known;
  return all;
}

}    // namespace Slope

#endif

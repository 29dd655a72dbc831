/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CONTINUATION_H
#define SLOPE_CONTINUATION_H

#include "pointers.h"

#include "vector3.h"

#include <vector>

namespace LAMMPS_NS {

// A run in pieces, or from a restart file, is the uncut one, to the bit as long as the neighbor lists have
// the same order. LAMMPS finds the forces anew at a set-up, with the velocities of the end of the last
// step, while that step made them with those of its middle. So the force on each ball at the end of a run
// is kept, moves between ranks with it and goes into restart files; taken back, it gives the velocities of
// the middle, and with these the set-up finds the forces of the last step once more, but for rounding.
// Before the first step those that were kept take their place. If they differ by more, something has been
// changed in between, and those of the set-up stand. Where others than fix nve/sphere move balls, as fix move does, a force
// may change nothing: what it changed in the last step is kept, too. So is by how much the velocities that normal dashpots
// acted on differed from those of the middle.
class Continuation : protected Pointers {
 public:
  explicit Continuation(class LAMMPS *);
  ~Continuation() override;

  bool forces_known() const;    // those of the last step, of this length
  void keep_forces();

  // at the set-up; until it is over the balls have the velocities of the middle of the step: empty if
  // these are not known, and the same as LAMMPS has them
  void find_half_step();
  void forget_half_step();
  std::vector<Slope::Vector> v, omega;

  void note_half_step();    // in the middle of each step
  void begin_step();        // the first one takes the forces back

  // Velocities that normal dashpots act on, of scheme exact (AHEAD of contact_step.h): those of the middle of the step, and
  // a part of what the last step's force adds to them until its end. look_ahead() finds them while LAMMPS still has that
  // force, before balls change ranks; balls that come after that have no such force. At a set-up they are the last step's.
  void look_ahead();
  Slope::Vector *
  to_look_ahead();    // where a style that goes through all balls may put them; then:
  void note_looked();
  void look_ahead_of_new_balls();    // when the balls of the step are known
  Slope::Vector *ahead();            // room for ghosts, which others fill

  // --- storage by atom ---

  static constexpr int STORED = 13;    // numbers of each ball
  void grow(int nmax);
  void copy(int from, int to);
  void clear(int i);
  int pack(int i, double *) const;
  int unpack(int i, const double *);

  template <class Archive> void archive(Archive &a)    // members of a restart file
  {
    a.number("last_step", step);
    a.number("step_size", dt);
  }

 private:
  static constexpr int FORCE = 6, CHANGED = FORCE, BEYOND = FORCE + 1, KEPT = BEYOND + 3;
  double **force;        // and torque, on each ball in the last step; what they changed: changed();
                         // velocities that dashpots acted on, less those of the middle
  double **ahead_now;    // of this step
  std::vector<Slope::Vector> ahead_again;    // of the last step, at a set-up
  bigint looked;                             // step that ahead_now is of
  bigint step;                               // the step that they belong to
  double dt;                                 // and its length
  bool guided;    // some balls may be moved by others than fix nve/sphere
  std::vector<Slope::Vector> v_half, omega_half;    // then, in the middle of this step

  bool others_move() const;
  void take_back_half_step();
  void swap_velocities();    // v and omega with LAMMPS'
  void keep_ahead();
  int changed(int i) const;
};

// LAMMPS keeps the rows of such an array one after the other
inline Slope::Vector *vectors(double **array)
{
  return reinterpret_cast<Slope::Vector *>(array ? array[0] : nullptr);
}

// what changes velocities in the second half of a step beside the forces; a class, as the style that does so is in a room
// above
class Kick {
 public:
  virtual void take_back_kick() = 0;    // from LAMMPS' velocities of this rank's balls

 protected:
  ~Kick() = default;
};

}    // namespace LAMMPS_NS

#endif

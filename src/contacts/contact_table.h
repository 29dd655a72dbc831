/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact laws of all pairs of atom types, and the balls of each type that they are for: what can touch,
   how near, and in which time step. The words that the laws come from: contact_coeffs.h. */

#ifndef SLOPE_CONTACT_TABLE_H
#define SLOPE_CONTACT_TABLE_H

#include "pointers.h"

#include "contact_coeffs.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ContactTable : protected Pointers {
 public:
  // masses (kg) and radii (m) of the balls of a type, over all ranks
  struct TypeRange {
    double mass_min, mass_max, radius_dynamic, radius_frozen;
    bool moving, frozen;
  };

  explicit ContactTable(LAMMPS *);

  void allocate();                                          // for the types that there are now
  void set(const ContactSettings &);                        // changes the laws that are there
  void set(int itype, int jtype, const ContactCoeffs &);    // in both orders

  bool is_exact() const { return !settings.plain; }
  bool is_set(int itype, int jtype) const { return coeffs[index(itype, jtype)].set(); }
  const Slope::ContactLaw &law(int itype, int jtype) const { return laws[index(itype, jtype)]; }
  const Slope::ContactLaw &law(size_t k) const
  {
    return laws[k];
  }    // k: itype * (ntypes + 1) + jtype
  const TypeRange &range(int type) const { return ranges[type]; }

  // the balls of each type, and those that fix pour and fix deposit will add; collective
  void find_ranges(int freeze_group_bit);

  // at init, each wall: it meets the balls of a group
  void forget_walls();
  void add_wall(int type, int groupbit, const char *style);

  // one side moves, the other one does too, is frozen or a wall
  bool can_touch(int itype, int jtype) const;    // and there is a law
  bool balls_can_touch(int itype,
                       int jtype) const;          // without walls; balls that are to be poured, too
  double cutoff(int itype, int jtype) const;      // m, largest sum of the radii
  double largest_cutoff() const;                  // of balls that can touch
  double lightest(int itype, int jtype) const;    // mass of the lightest moving ball, kg
  Slope::SpringDashpot normal(int itype,
                              int jtype) const;        // of that ball, fixed on the other type
  double bound_on_step(int itype, int jtype) const;    // s, the smaller one of:
  double spring_bound(int itype, int jtype) const;
  double dashpot_bound(int itype, int jtype) const;    // infinite with scheme exact

  // coefficients for the lightest balls of each pair of types; dt: time step, s
  std::string text(double dt) const;

  // members of a restart file
  void archive_settings(Slope::Archive &);
  void archive_coeffs(Slope::Archive &);

  double memory_usage() const;

 private:
  ContactSettings settings;
  std::vector<ContactCoeffs> coeffs;      // (ntypes+1) x (ntypes+1), both triangles filled
  std::vector<Slope::ContactLaw> laws;    // same layout
  std::vector<TypeRange> ranges;          // by type
  std::vector<char> wall_type;            // by type: 1 if a wall fix uses it

  int index(int itype, int jtype) const;
};

}    // namespace LAMMPS_NS

#endif

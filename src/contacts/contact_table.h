/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact laws of all pairs of atom types: what pair_style and pair_coeff were given, the laws
   made from it, and the balls of each type that they are for. */

#ifndef SLOPE_CONTACT_TABLE_H
#define SLOPE_CONTACT_TABLE_H

#include "pointers.h"

#include "contact_law.h"

#include <cstdio>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class ContactTable : protected Pointers {
 public:
  // what pair_coeff was given for a pair of types
  struct Coeff {
    int set;
    int restitution_set;    // 1: dashpots from e, 0: cn and ct as given
    int spring_set;         // 1: kr and cr as given
    double kn, kt, e, cn, ct, phi, rolling, kr, cr;
  };

  // masses (kg) and radii (m) of the balls of a type, over all ranks
  struct TypeRange {
    double mass_min, mass_max, radius_dynamic, radius_frozen;
    bool moving, frozen;
  };

  explicit ContactTable(LAMMPS *);

  void allocate();                             // for the types that there are now
  void read_settings(int narg, char **arg);    // keywords of pair_style
  Coeff read_coeff(const std::string &types, int narg,
                   char **arg) const;               // of pair_coeff, after the types
  void set(int itype, int jtype, const Coeff &);    // in both orders
  void make_laws();                                 // after set()

  bool is_exact() const { return scheme == EXACT; }
  bool is_set(int itype, int jtype) const { return coeff(itype, jtype).set; }
  const Coeff &coeff(int itype, int jtype) const { return coeffs[index(itype, jtype)]; }
  const Slope::ContactLaw &law(int itype, int jtype) const { return laws[index(itype, jtype)]; }
  const Slope::ContactLaw &law(size_t k) const
  {
    return laws[k];
  }    // k: itype * (ntypes + 1) + jtype
  const TypeRange &range(int type) const { return ranges[type]; }
  bool is_plain() const { return scheme == PLAIN; }

  // at init: the balls of each type; walls are announced afterwards
  void find_ranges(int freeze_group_bit);
  void add_wall(int type, int groupbit, const char *style);    // meets the balls of a group

  // one side moves, the other one does too, is frozen or a wall
  bool can_touch(int itype, int jtype) const;    // and there is a law
  bool balls_can_touch(int itype,
                       int jtype) const;          // without walls; balls that are to be poured, too
  double cutoff(int itype, int jtype) const;      // m, largest sum of the radii
  double lightest(int itype, int jtype) const;    // mass of the lightest moving ball, kg
  double bound_on_step(int itype, int jtype) const;    // s, the smaller one of:
  double spring_bound(int itype, int jtype) const;
  double dashpot_bound(int itype, int jtype) const;    // infinite with scheme exact

  // coefficients for the lightest balls of each pair of types; dt: time step, s
  std::string text(double dt) const;

  // restart files
  void write_settings(FILE *) const;    // by rank 0
  void write_coeffs(FILE *) const;
  void read_settings(FILE *);    // collective
  void read_coeffs(FILE *);

  double memory_usage() const;

 private:
  int mass_ball;          // mass ball instead of mass pair
  int limit_damping;      // the normal force never pulls
  int rolling_reduced;    // rolling radius RiRj/(Ri+Rj) instead of its double
  enum Scheme { EXACT, PLAIN };
  int scheme;    // which velocities the dashpots have: theory.rst

  void check_coeff(const std::string &types, const Coeff &, bool stiffness, bool damping) const;

  std::vector<Coeff> coeffs;              // (ntypes+1) x (ntypes+1), both triangles filled
  std::vector<Slope::ContactLaw> laws;    // same layout
  std::vector<TypeRange> ranges;          // by type
  std::vector<char> wall_type;            // by type: 1 if a wall fix uses it

  int index(int itype, int jtype) const;
  std::string line(int itype, int jtype, double dt) const;
};

}    // namespace LAMMPS_NS

#endif

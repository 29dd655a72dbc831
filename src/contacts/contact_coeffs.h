/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What a deck says of the contact law: the one place where the words of pair_style gran/restitution and of its
   pair_coeff are read and checked, named in restart files, made into a ContactLaw and printed. */

#ifndef SLOPE_CONTACT_COEFFS_H
#define SLOPE_CONTACT_COEFFS_H

#include "lammps.h"

#include "contact_law.h"

#include <cmath>
#include <string>

namespace Slope {
class Archive;
}

namespace LAMMPS_NS {

// of pair_style, for all pairs of types
struct ContactSettings {
  bool mass_ball = false;          // mass ball instead of mass pair
  bool limit_damping = false;      // the normal force never pulls
  bool rolling_reduced = false;    // rolling radius RiRj/(Ri+Rj) instead of its double
  bool plain = false;              // scheme plain: which velocities the dashpots have, theory.rst

  void read(LAMMPS *, int narg, char **arg);
  void archive(Slope::Archive &);    // members of a restart file
};

// of pair_coeff, for a pair of types
struct ContactCoeffs {
  static constexpr int VERSION =
      20261126;    // of what restart files hold of these and the settings

  // numbers of the words, NaN of a word that was not given; some stand for 0 then, see law()
  double kn = NAN, kt = NAN;    // stiffness
  double e = NAN;               // restitution
  double cn = NAN, ct = NAN;    // damping
  double phi = NAN;             // friction
  double rolling = NAN;
  double kr = NAN, cr = NAN;    // rolling_spring

  bool set() const { return !std::isnan(kn); }    // by any pair_coeff

  void read(LAMMPS *, const std::string &types, int narg, char **arg);    // after the types: "I J"
  void archive(Slope::Archive &);
  Slope::ContactLaw law(const ContactSettings &) const;

  // A line of the table in the log, and its heading. mi, mj: mass (kg) of the lightest moving balls of the two
  // types, 0 of one that has none; dt: time step, s
  static const char *heading();
  std::string line(const Slope::ContactLaw &, double mi, double mj, double dt) const;
};

}    // namespace LAMMPS_NS

#endif

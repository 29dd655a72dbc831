/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RELEASE_H
#define SLOPE_DEPOSIT_RELEASE_H

#include "deposit_summary.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// What fix deposit/grid finds out about the balls of its group when they are released. All
// methods are collective; an invalid release ends the run with one line.
class DepositRelease : protected Pointers {
 public:
  typedef Slope::DepositSummary::Released Released;
  typedef Released::Mass Mass;

  DepositRelease(class LAMMPS *, const class DepositBalls &, const class DepositOptions &);

  // heights of the ground at the cell centres, NaN where there is none, row by row from the south; on rank 0
  std::vector<double> ground() const;

  Released find() const;    // without volume, stiffness_number: FixDepositGrid::start()

  // K, the stiffness of the softest contacts between the balls over density of the ground, gravity, largest
  // thickness of the body and largest diameter; 0 where there is no body, weight or such contact
  double stiffness_number(const Released &) const;

  // to the log
  void log(const std::string &fix_id, const Released &) const;

 private:
  const class DepositBalls &balls;
  const class DepositOptions &options;

  // every ball has ground below and around it, or the run ends: a hole in the elevation model under the mass
  // would swallow it
  void check_ground() const;

  Mass find_mass() const;
  struct Body {
    double volume, thick;
  };
  Body find_body(const Mass &) const;
  class Region *body() const;
  Body integrate(class Region *) const;
  void check_balls(class Region *, const Mass &) const;
  double gravity(int groups) const;    // groups: bits of this rank's balls
};

}    // namespace LAMMPS_NS

#endif

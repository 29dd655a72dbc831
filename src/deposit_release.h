/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RELEASE_H
#define SLOPE_DEPOSIT_RELEASE_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

// What fix deposit/grid finds out about the balls of its group when they are released. All
// methods are collective; what must not be ends the run with one line.
class DepositRelease : protected Pointers {
 public:
  struct Mass {    // of all ranks; numbers only, for restart files
    double number;
    double solid;     // volume of the balls
    double x, y;      // centre of mass
    double top[3];    // place of the highest ball, of several the one with the lowest ID
  };

  DepositRelease(class LAMMPS *, const class DepositBalls &);

  Mass find() const;

  // volume of the region that the balls stand for
  double body_volume(const std::string &region, const Mass &) const;

 private:
  const class DepositBalls &balls;

  class Region *body(const std::string &id) const;
  double integrate(class Region *) const;
  void check_balls(class Region *, const Mass &) const;
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_GROUND_H
#define SLOPE_DEPOSIT_GROUND_H

#include "deposit_rasters.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

// The ground of fix deposit/grid: the upper boundary of a region. Methods are collective.
class DepositGround : protected Pointers {
 public:
  DepositGround(class LAMMPS *lmp, const std::string &region_id) : Pointers(lmp), region(region_id)
  {
  }

  // heights at the cell centres, NaN where there is none, into the rows of this rank
  void read(Slope::DepositRasters &);

  // Every ball has ground below and around it, or the run ends: a hole in the elevation model
  // under the mass would swallow it.
  void check(const class DepositBalls &);

 private:
  std::string region;
};

}    // namespace LAMMPS_NS

#endif

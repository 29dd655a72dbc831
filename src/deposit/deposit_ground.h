/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_GROUND_H
#define SLOPE_DEPOSIT_GROUND_H

#include "plan_grid.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// The ground of fix deposit/grid: the upper boundary of a region. Methods are collective.
class DepositGround : protected Pointers {
 public:
  DepositGround(class LAMMPS *lmp, const std::string &region_id) : Pointers(lmp), region(region_id)
  {
  }

  // heights at the cell centres, NaN where there is none, row by row from the south; on rank 0
  std::vector<double> read(const Slope::PlanGrid &) const;

  // Every ball has ground below and around it, or the run ends: a hole in the elevation model
  // under the mass would swallow it.
  void check(const class DepositBalls &);

 private:
  std::string region;
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RESULTS_H
#define SLOPE_DEPOSIT_RESULTS_H

#include "deposit_release.h"

namespace LAMMPS_NS {

// State of the mass after a sample of fix deposit/grid, the same on all ranks.
struct DepositResults {
  enum {    // the fix's vector
    RELEASED,
    ON_GRID,
    OFF_GRID,
    LOST,
    RESIDUAL,
    CHANGE,
    FRONT,
    REACH,
    CENTROID,
    NLOST,
    FAST_SHARE,
    NUMBER
  };
  static bool extensive(int k) { return k <= RESIDUAL || k == NLOST; }

  double vector[NUMBER];
  double present;    // number of balls
  double time;
  DepositRelease::Released released;
};

}    // namespace LAMMPS_NS

#endif

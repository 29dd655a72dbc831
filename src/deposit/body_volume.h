// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BODY_VOLUME_H
#define SLOPE_BODY_VOLUME_H

#include <functional>
#include <vector>

namespace Slope {

struct PlanBox {
  double lo[2], hi[2];
};

// The ranks that share the columns of a body; all get the same volume, to the bit, whatever their number.
struct ColumnRanks {
  int me, number;
  std::function<void(std::vector<double> &)> sum;    // of all ranks, on all ranks; empty: one
};

// Volume (m3) of the body in a box, given the length of the vertical line at x, y in it (m): a column in
// each of square cells, at places that repeat no grid, and in finer and finer cells around what these have
// found until two sums differ by less than 3e-4. likely: where some of it is sure to be, so that a body much
// smaller than the box is not missed. 0 for no body; std::runtime_error if the sum does not settle.
double body_volume(const PlanBox &, const PlanBox &likely,
                   const std::function<double(double x, double y)> &length,
                   const ColumnRanks & = {0, 1, nullptr});

}    // namespace Slope

#endif

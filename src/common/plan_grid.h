// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_PLAN_GRID_H
#define SLOPE_PLAN_GRID_H

#include <algorithm>
#include <cmath>

namespace Slope {

// Square cells in plan, from a south-west corner on; columns along x (0), rows along y (1).
struct PlanGrid {
  int n[2];                 // cells along x and y
  double lo[2], hi[2];      // south-west and north-east corner
  double cell, cell_inv;    // size, 1/size

  PlanGrid() : n{0, 0}, lo{0.0, 0.0}, hi{0.0, 0.0}, cell(1.0), cell_inv(1.0) {}

  // as many whole cells as cover the extent xlo xhi ylo yhi; their numbers must fit in n
  PlanGrid(const double *extent, double size) : cell(size), cell_inv(1.0 / size)
  {
    for (int dim = 0; dim < 2; dim++) {
      n[dim] = (int) cells_in(extent[2 * dim], extent[2 * dim + 1], size);
      lo[dim] = extent[2 * dim];
      hi[dim] = lo[dim] + n[dim] * cell;
    }
  }

  static double cells_in(double from, double to, double size)
  {
    return std::max(1.0, std::ceil((to - from) / size - 1.0e-9));
  }

  double ncells() const { return (double) n[0] * n[1]; }

  // of a coordinate in the grid; one on the upper edge is in the last cell
  int cell_of(int dim, double x) const
  {
    return std::min(n[dim] - 1, (int) ((x - lo[dim]) * cell_inv));
  }

  double centre(int dim, int k) const { return lo[dim] + (k + 0.5) * cell; }
};

}    // namespace Slope

#endif

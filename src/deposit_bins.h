/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_BINS_H
#define SLOPE_DEPOSIT_BINS_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace Slope {

// Square cells in plan, from a south-west corner on; columns along x (0), rows along y (1).
struct PlanGrid {
  int n[2];                 // cells along x and y
  double lo[2], hi[2];      // south-west and north-east corner
  double cell, cell_inv;    // size, 1/size

  PlanGrid() : n{0, 0}, lo{0.0, 0.0}, hi{0.0, 0.0}, cell(1.0), cell_inv(1.0) {}

  // as many whole cells as cover the extent xlo xhi ylo yhi; its size must fit in n
  PlanGrid(const double *extent, double size);

  // of a coordinate in the grid; one on the upper edge is in the last cell
  int cell_of(int dim, double x) const
  {
    return std::min(n[dim] - 1, (int) ((x - lo[dim]) * cell_inv));
  }
};

// The part of a plan grid that some balls occupy. Per cell: the volume that lies over it, and of
// the balls whose centre is over it the largest speed (-1: no centre) and the largest energy.
struct DepositWindow {
  int first[2], size[2];
  std::vector<double> values;    // volumes of all cells, then speeds, then energies

  DepositWindow() : first{0, 0}, size{0, 0} {}
  size_t index(int i, int j) const { return (size_t) j * size[0] + i; }
  size_t ncells() const { return (size_t) size[0] * size[1]; }
  double &volume(int i, int j) { return values[index(i, j)]; }
  double &speed(int i, int j) { return values[ncells() + index(i, j)]; }
  double &energy(int i, int j) { return values[2 * ncells() + index(i, j)]; }

  void clear();                         // as many values as cells, nothing in them
  void cover(const DepositWindow &);    // its cells grow to hold those of another window, too
};

// Balls of a deposit in the cells of a plan grid. A ball stands for a cube of ground; the cube's
// square in plan is cut exactly by the cells, so that no volume is lost on any grid.
//
// start(), show() of every ball, open(), bin() of every ball; then window() holds the sums.
class DepositBins {
 public:
  DepositBins() : periodic{false, false}, boxlo{0.0, 0.0}, boxhi{0.0, 0.0}, largest(0.0) {}

  void set_grid(const PlanGrid &grid_in) { grid = grid_in; }

  // squares that reach out of this box along an axis go on at its other side
  void set_period(int dim, bool periodic, double boxlo, double boxhi);

  void start();

  void show(const double *x, double side)
  {
    for (int dim = 0; dim < 2; dim++) {
      const double at = wrap(dim, x[dim]);
      low[dim] = std::min(low[dim], at - 0.5 * side);
      high[dim] = std::max(high[dim], at + 0.5 * side);
    }
    largest = std::max(largest, side);
  }

  void open();

  // a ball's place, the side of its cube; returns the part of its volume that is off the grid,
  // exactly 0 for a square that does not touch the edge
  double bin(const double *x, double side, double speed, double energy);

  DepositWindow &window() { return bins; }
  const DepositWindow &window() const { return bins; }

 private:
  struct Shares {    // of one ball's square in the cells along one axis
    std::vector<int> cell;
    std::vector<double> part;
    int count;
  };

  PlanGrid grid;
  bool periodic[2];
  double boxlo[2], boxhi[2];
  double low[2], high[2], largest;    // of the squares shown; their largest side
  DepositWindow bins;
  Shares shares[2];

  double wrap(int dim, double x) const    // balls leave a periodic box a little
  {
    if (!periodic[dim]) return x;
    const double prd = boxhi[dim] - boxlo[dim];
    return x - prd * std::floor((x - boxlo[dim]) / prd);
  }
  void cut(int dim, double centre, double side, double &beyond);
  void cut_piece(int dim, double a, double b, double side, double &beyond);
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_BINS_H
#define SLOPE_DEPOSIT_BINS_H

#include "deposit_blocks.h"
#include "plan_grid.h"

#include <cmath>
#include <vector>

namespace Slope {

// Balls of a deposit in the cells of a plan grid. A ball represents a cube of ground; the cube's
// square in plan is cut exactly by the cells, so that no volume is lost on any grid.
class DepositBins {
 public:
  // of a cell: the volume that lies over it, and of the balls whose centre is over it the largest
  // speed (-1: no centre) and the largest energy
  enum { VOLUME, SPEED, ENERGY, KINDS };
  typedef DepositBlocks<KINDS> Blocks;

  DepositBins();

  void set_grid(const PlanGrid &);

  // squares that reach beyond this box along an axis continue at its other side
  void set_period(int dim, bool periodic, double boxlo, double boxhi);

  void clear() { bins.clear(); }

  // a ball's place, the side of its cube; returns the part of its volume that is off the grid,
  // exactly 0 for a square that does not touch the edge
  double bin(const double *x, double side, double speed, double energy);

  const Blocks &blocks() const { return bins; }

 private:
  struct Shares {    // of one ball's square in the cells along one axis
    std::vector<int> cell;
    std::vector<double> part;
    int count;
  };

  PlanGrid grid;
  bool periodic[2];
  double boxlo[2], boxhi[2];
  Blocks bins;
  Shares shares[2];

  double wrap(int dim, double x) const    // balls leave a periodic box a little
  {
    if (!periodic[dim]) return x;
    const double prd = boxhi[dim] - boxlo[dim];
    return x - prd * std::floor((x - boxlo[dim]) / prd);
  }
  void add_volume(double volume);
  void add_centre(const double *place, double speed, double energy);
  void cut(int dim, double centre, double side, double &beyond);
  void cut_piece(int dim, double a, double b, double side, double &beyond);
};

}    // namespace Slope

#endif

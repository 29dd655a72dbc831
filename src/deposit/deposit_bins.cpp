// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_bins.h"

#include <algorithm>

using namespace Slope;

// of a cell without a ball: volume, speed (no centre), energy
static const double NOTHING[] = {0.0, -1.0, 0.0};
static_assert(sizeof(NOTHING) / sizeof(double) == DepositBins::KINDS, "one of each kind");

enum { X, Y };

/* ---------------------------------------------------------------------- */

DepositBins::DepositBins() : periodic{false, false}, boxlo{0.0, 0.0}, boxhi{0.0, 0.0}, bins(NOTHING)
{
}

/* ---------------------------------------------------------------------- */

void DepositBins::set_grid(const PlanGrid &grid_in)
{
  grid = grid_in;
  bins.set_grid(grid);
}

/* ---------------------------------------------------------------------- */

void DepositBins::set_period(int dim, bool periodic_in, double boxlo_in, double boxhi_in)
{
  periodic[dim] = periodic_in;
  boxlo[dim] = boxlo_in;
  boxhi[dim] = boxhi_in;
}

/* ---------------------------------------------------------------------- */

double DepositBins::bin(const double *x, double side, double speed, double energy)
{
  const double volume = side * side * side;
  double place[2], beyond[2];
  for (int dim = X; dim <= Y; dim++) {
    place[dim] = wrap(dim, x[dim]);
    cut(dim, place[dim], side, beyond[dim]);
  }
  if (cuts[X].count > 0) add_volume(volume);
  add_centre(place, speed, energy);
  if (beyond[X] == 0.0 && beyond[Y] == 0.0) return 0.0;
  return volume * (1.0 - (1.0 - beyond[X] / side) * (1.0 - beyond[Y] / side));
}

/* ----------------------------------------------------------------------
   to the cells below the square that was cut
------------------------------------------------------------------------- */

void DepositBins::add_volume(double volume)
{
  for (int l = 0; l < cuts[Y].count; l++) {
    const int j = cuts[Y].cell[l];
    const double strip = volume * cuts[Y].part[l];
    double *volumes = nullptr;
    int column = -1;
    for (int k = 0; k < cuts[X].count; k++) {
      const int i = cuts[X].cell[k];
      if (BlockOfCells::of_cell(i) != column) {
        column = BlockOfCells::of_cell(i);
        volumes = bins.make(column, BlockOfCells::of_cell(j)).values[VOLUME];
      }
      volumes[BlockOfCells::index(i, j)] += strip * cuts[X].part[k];
    }
  }
}

/* ----------------------------------------------------------------------
   speed and energy to the cell below the centre
------------------------------------------------------------------------- */

void DepositBins::add_centre(const double *place, double speed, double energy)
{
  if (!(place[X] >= grid.lo[X] && place[X] < grid.hi[X] && place[Y] >= grid.lo[Y] &&
        place[Y] < grid.hi[Y]))
    return;
  const int i = grid.cell_of(X, place[X]), j = grid.cell_of(Y, place[Y]);
  Blocks::Block &block = bins.make(BlockOfCells::of_cell(i), BlockOfCells::of_cell(j));
  double &most_speed = block.values[SPEED][BlockOfCells::index(i, j)];
  double &most_energy = block.values[ENERGY][BlockOfCells::index(i, j)];
  most_speed = std::max(most_speed, speed);
  most_energy = std::max(most_energy, energy);
}

/* ----------------------------------------------------------------------
   cuts of a ball's square along one axis, and beyond, the length that is off the grid
------------------------------------------------------------------------- */

void DepositBins::cut(int dim, double centre, double side, double &beyond)
{
  double a = centre - 0.5 * side, b = centre + 0.5 * side;
  cuts[dim].count = 0;
  const size_t most = (size_t) std::min(side * grid.cell_inv, 1.0 * grid.n[dim]) + 6;
  if (cuts[dim].cell.size() < most) {    // two pieces, each with two cut cells
    cuts[dim].cell.resize(most);
    cuts[dim].part.resize(most);
  }
  beyond = 0.0;
  if (!periodic[dim]) {
    cut_piece(dim, a, b, side, beyond);
    return;
  }

  // parts beyond the periodic box continue at its other side

  const double prd = boxhi[dim] - boxlo[dim];
  if (a < boxlo[dim]) {
    cut_piece(dim, a + prd, boxhi[dim], side, beyond);
    a = boxlo[dim];
  } else if (b > boxhi[dim]) {
    cut_piece(dim, boxlo[dim], b - prd, side, beyond);
    b = boxhi[dim];
  }
  cut_piece(dim, a, b, side, beyond);
}

/* ---------------------------------------------------------------------- */

void DepositBins::cut_piece(int dim, double a, double b, double side, double &beyond)
{
  const double from = std::max(a, grid.lo[dim]);
  const double to = std::min(b, grid.hi[dim]);
  beyond += b - a;
  if (!(from < to)) return;
  beyond -= to - from;

  Cuts &found = cuts[dim];
  const int last = grid.cell_of(dim, to);
  for (int c = grid.cell_of(dim, from); c <= last; c++) {
    const double left = std::max(from, grid.lo[dim] + c * grid.cell);
    const double right = std::min(to, grid.lo[dim] + (c + 1) * grid.cell);
    if (!(left < right)) continue;
    found.cell[found.count] = c;
    found.part[found.count] = (right - left) / side;
    found.count++;
  }
}

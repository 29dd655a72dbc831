/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_bins.h"

using namespace Slope;

enum { X, Y };

/* ---------------------------------------------------------------------- */

PlanGrid::PlanGrid(const double *extent, double size) : cell(size), cell_inv(1.0 / size)
{
  for (int dim = X; dim <= Y; dim++) {
    const double length = extent[2 * dim + 1] - extent[2 * dim];
    n[dim] = (int) std::max(1.0, std::ceil(length / cell - 1.0e-9));
    lo[dim] = extent[2 * dim];
    hi[dim] = lo[dim] + n[dim] * cell;
  }
}

/* ---------------------------------------------------------------------- */

void DepositWindow::clear()
{
  values.assign(3 * ncells(), 0.0);
  std::fill_n(values.begin() + ncells(), ncells(), -1.0);    // speed: no centre was here
}

/* ---------------------------------------------------------------------- */

void DepositWindow::cover(const DepositWindow &other)
{
  if (other.ncells() == 0) return;
  const bool empty = ncells() == 0;
  for (int dim = X; dim <= Y; dim++) {
    int end = other.first[dim] + other.size[dim];
    if (!empty) end = std::max(end, first[dim] + size[dim]);
    first[dim] = empty ? other.first[dim] : std::min(first[dim], other.first[dim]);
    size[dim] = end - first[dim];
  }
}

/* ---------------------------------------------------------------------- */

void DepositBins::set_period(int dim, bool periodic_in, double boxlo_in, double boxhi_in)
{
  periodic[dim] = periodic_in;
  boxlo[dim] = boxlo_in;
  boxhi[dim] = boxhi_in;
}

/* ---------------------------------------------------------------------- */

void DepositBins::start()
{
  for (int dim = X; dim <= Y; dim++) {
    low[dim] = HUGE_VAL;
    high[dim] = -HUGE_VAL;
  }
  largest = 0.0;
}

/* ----------------------------------------------------------------------
   an empty window around the squares that were shown
------------------------------------------------------------------------- */

void DepositBins::open()
{
  for (int dim = X; dim <= Y; dim++) {
    double a = low[dim], b = high[dim];

    // what goes on at the other side of a periodic box may be anywhere

    if (periodic[dim] && (a < boxlo[dim] || b > boxhi[dim])) {
      a = grid.lo[dim];
      b = grid.hi[dim];
    }
    a = std::max(a, grid.lo[dim]);
    b = std::min(b, grid.hi[dim]);
    bins.first[dim] = a < b ? grid.cell_of(dim, a) : 0;
    bins.size[dim] = a < b ? grid.cell_of(dim, b) - bins.first[dim] + 1 : 0;
  }
  for (Shares &s : shares) {
    s.cell.resize((size_t) (largest * grid.cell_inv) + 6);    // two pieces, each with two cut cells
    s.part.resize(s.cell.size());
  }
  bins.clear();
}

/* ----------------------------------------------------------------------
   volume to the cells below the square, speed and energy to the cell below the centre
------------------------------------------------------------------------- */

double DepositBins::bin(const double *x, double side, double speed, double energy)
{
  const double volume = side * side * side;

  double place[2], beyond[2];
  for (int dim = X; dim <= Y; dim++) {
    place[dim] = wrap(dim, x[dim]);
    cut(dim, place[dim], side, beyond[dim]);
  }
  for (int j = 0; j < shares[Y].count && shares[X].count > 0; j++) {
    double *row = &bins.volume(0, shares[Y].cell[j]);
    const double strip = volume * shares[Y].part[j];
    for (int k = 0; k < shares[X].count; k++) row[shares[X].cell[k]] += strip * shares[X].part[k];
  }

  if (place[X] >= grid.lo[X] && place[X] < grid.hi[X] && place[Y] >= grid.lo[Y] &&
      place[Y] < grid.hi[Y]) {
    const int i = grid.cell_of(X, place[X]) - bins.first[X];
    const int j = grid.cell_of(Y, place[Y]) - bins.first[Y];
    double &most_speed = bins.speed(i, j), &most_energy = bins.energy(i, j);
    most_speed = std::max(most_speed, speed);
    most_energy = std::max(most_energy, energy);
  }
  if (beyond[X] == 0.0 && beyond[Y] == 0.0) return 0.0;
  return volume * (1.0 - (1.0 - beyond[X] / side) * (1.0 - beyond[Y] / side));
}

/* ----------------------------------------------------------------------
   a ball's square along one axis: its shares in the cells there, and beyond, the length that is
   off the grid
------------------------------------------------------------------------- */

void DepositBins::cut(int dim, double centre, double side, double &beyond)
{
  double a = centre - 0.5 * side, b = centre + 0.5 * side;
  shares[dim].count = 0;
  beyond = 0.0;
  if (!periodic[dim]) {
    cut_piece(dim, a, b, side, beyond);
    return;
  }

  // what is out of the periodic box goes on at its other side

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

  Shares &found = shares[dim];
  const int last = grid.cell_of(dim, to);
  for (int c = grid.cell_of(dim, from); c <= last; c++) {
    const double left = std::max(from, grid.lo[dim] + c * grid.cell);
    const double right = std::min(to, grid.lo[dim] + (c + 1) * grid.cell);
    if (!(left < right)) continue;
    found.cell[found.count] = c - bins.first[dim];
    found.part[found.count] = (right - left) / side;
    found.count++;
  }
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_BANDS_H
#define SLOPE_DEPOSIT_BANDS_H

#include "plan_grid.h"

#include <algorithm>
#include <cstddef>

namespace Slope {

// Which rank holds which rows of a plan grid: bands of ROWS rows go round the ranks, so that each has
// its share of the cells wherever the mass is.
class DepositBands {
 public:
  static constexpr int ROWS = 8;

  DepositBands() : me(0), nranks(1), columns(0), rows(0) {}
  DepositBands(const PlanGrid &grid, int me_in, int nranks_in) :
      me(me_in), nranks(nranks_in), columns(grid.n[0]), rows(grid.n[1])
  {
  }

  int number() const { return rows / ROWS + (rows % ROWS > 0); }
  int owner(int band) const { return band % nranks; }
  bool mine(int band) const { return owner(band) == me; }
  static int band_of(int row) { return row / ROWS; }

  int cells_in_band() const { return std::min<long long>(ROWS * (long long) columns, 1 << 30); }
  int first_row(int band) const { return band * ROWS; }
  int end_row(int band) const { return std::min(rows, first_row(band) + ROWS); }

  // bands of this rank are first(), first() + step() ...
  int first() const { return me; }
  int step() const { return nranks; }

  // of the cells of this rank, whose bands follow each other
  size_t place(int i, int j) const
  {
    return ((size_t) (band_of(j) / nranks) * ROWS + j % ROWS) * columns + i;
  }
  size_t ncells() const
  {
    size_t count = 0;
    for (int band = first(); band < number(); band += step())
      count += (size_t) (end_row(band) - first_row(band)) * columns;
    return count;
  }

 private:
  int me, nranks, columns, rows;
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_PIECES_H
#define SLOPE_DEPOSIT_PIECES_H

#include "deposit_bands.h"
#include "deposit_rasters.h"
#include "plan_grid.h"

#include <algorithm>
#include <cmath>

namespace Slope {

// The bands of a plan grid in pieces, each so small that its cells fit into so many bytes of a restart
// file even if the mass touches all of them. The same on any number of ranks.
class DepositPieces {
 public:
  static constexpr double MOST_BYTES = 2147483647.0 - 1024.0;    // an int, less what else a fix has

  DepositPieces(const PlanGrid &grid, double most_bytes) : bands(DepositBands(grid, 0, 1).number())
  {
    const double fit = std::floor(most_bytes / bytes_of_band(grid));
    bands_in_piece = (int) std::max(1.0, std::min(1.0 * bands, fit));
  }

  // if this is more than most_bytes, the band does not fit and is a piece all the same
  static double bytes_of_band(const PlanGrid &grid)
  {
    return 8.0 * DepositRasters::PER_CELL * DepositBands::ROWS * grid.n[0];
  }

  int number() const { return (bands - 1) / bands_in_piece + 1; }
  int first_band(int piece) const { return piece * bands_in_piece; }
  int last_band(int piece) const { return std::min(bands, first_band(piece) + bands_in_piece) - 1; }

 private:
  int bands, bands_in_piece;
};

}    // namespace Slope

#endif

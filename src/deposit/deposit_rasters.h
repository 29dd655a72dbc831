// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RASTERS_H
#define SLOPE_DEPOSIT_RASTERS_H

#include "deposit_bands.h"
#include "deposit_bins.h"
#include "deposit_blocks.h"
#include "plan_grid.h"

#include <cstdint>
#include <vector>

namespace Slope {

// The rasters of a deposit, the rows of one rank: the ground without the body, the thickness now, and
// the records of each cell so far. A sample is clear(), add() of all blocks of bins, finish().
class DepositRasters {
 public:
  enum Name {
    THICKNESS,
    MAX_THICKNESS,
    MAX_SPEED,
    MAX_ENERGY,
    ARRIVAL,
    LAST_MOTION,
    SNAPSHOT,
    KINDS
  };

  // if the mass was in every cell: base, all kinds, and the bins of the balls
  static constexpr double MOST_BYTES_PER_CELL = 8.0 * (1 + KINDS + DepositBins::KINDS);

  DepositRasters();

  void create(const PlanGrid &, int me, int nranks);
  const PlanGrid &grid() const { return cells; }
  const DepositBands &bands() const { return rows; }

  // height of the ground, NaN where there is none, of a cell of this rank
  double &base(int i, int j) { return ground[rows.place(i, j)]; }
  double base(int i, int j) const { return ground[rows.place(i, j)]; }

  // --- a sample; time: now; motion: a faster ball moves; record: also maxima and times ---

  void clear();
  void add(int column, int band, const double *bins, bool record, double time, double motion);
  double finish(bool record);    // returns the volume that the thickness raster holds here

  // --- change since the last snapshot ---

  double moved() const;    // volume that went to another cell, of these cells

  // share: of the released volume, moved in all cells since the last snapshot, if there was one
  void take_snapshot(double time, double share);

  // --- what the rows hold ---

  double at(Name, int i, int j) const;
  void row(Name, int j, double *values) const;    // of all columns
  double largest(Name) const;                     // of those that begin with 0
  double bytes() const;

  // what cells that the mass touched saw, of a band and in the order of rows and columns, for restart
  // files: number of the cell, all kinds but the thickness
  static constexpr int PER_CELL = KINDS;
  std::vector<double> touched(int band) const;
  void restore(const double *values);    // of one cell; nothing if it is another rank's

  double snapshot_time, change;    // NaN before the first one; per time, 1 before the second one

 private:
  PlanGrid cells;
  DepositBands rows;
  std::vector<double> ground;
  DepositBlocks blocks;
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RASTERS_H
#define SLOPE_DEPOSIT_RASTERS_H

#include "atomic_file.h"
#include "deposit_bins.h"
#include "plan_grid.h"

#include <string>
#include <vector>

namespace Slope {

// The rasters of a deposit: the ground without the body, the thickness now, and the records of each cell
// so far. A sample is clear(), add() of all blocks of bins, finish(). One rank holds them: on the others nothing
// is added, and all volumes are 0.
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
    KINDS,
    BASE = KINDS,    // of files alone: the ground, and with what lies on it
    SURFACE
  };

  // if the mass was in every cell: base, all kinds, and the bins of the balls
  static constexpr double MOST_BYTES_PER_CELL = 8.0 * (1 + KINDS + DepositBins::KINDS);

  DepositRasters();

  void create(const PlanGrid &);

  // heights of the ground, row by row from the south, NaN where there is none
  void set_base(std::vector<double> heights);
  double base(int i, int j) const { return ground[(size_t) j * cells.n[0] + i]; }

  // --- a sample; time: now; motion: a faster ball moves; record: also maxima and times ---

  void clear();
  void add(const DepositBins::Blocks::Block &, bool record, double time, double motion);
  double finish(bool record);    // returns the volume that the thickness raster holds

  // --- change since the last snapshot ---

  double moved() const;    // volume that went to another cell

  // fraction: of the released volume, moved since the last snapshot, if there was one
  void take_snapshot(double time, double fraction);

  // --- what the cells hold ---

  void row(Name, int j, double *values) const;    // of all columns
  double largest(Name) const;                     // of those that begin with 0
  double bytes() const;

  // what cells of a row that the mass touched saw, for restart files: number of the cell, all kinds but
  // the thickness
  static constexpr int PER_CELL = KINDS;
  std::vector<double> touched(int j) const;
  void restore(const double *values);    // of one cell

  // --- files ---

  struct File {
    std::string path;
    int content;    // a Name
    int digits;
  };

  // PREFIX.base.asc, .thickness.asc, ...; number: also PREFIX.NUMBER.thickness.asc, or empty
  static std::vector<File> files(const std::string &prefix, const std::string &number);
  void write(AtomicFile &, const File &) const;

  double snapshot_time, change;    // NaN before the first one; per time, 1 before the second one

 private:
  PlanGrid cells;
  std::vector<double> ground;
  DepositBlocks<KINDS> blocks;
};

}    // namespace Slope

#endif

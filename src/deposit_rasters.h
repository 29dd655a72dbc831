/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RASTERS_H
#define SLOPE_DEPOSIT_RASTERS_H

#include "atomic_file.h"
#include "deposit_bins.h"
#include "elevation_grid.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace Slope {

// Files that appear together: on a full disk either all of them are new, or none.
class FileSet {
 public:
  AtomicFile &add(const std::string &path);
  std::vector<std::string> names() const;    // without their folder, in the order they were added
  void commit();

 private:
  std::vector<std::unique_ptr<AtomicFile>> files;
  std::vector<std::string> paths;
};

// The rasters of a deposit: the ground without the body, the thickness now, and what each cell saw
// so far. A sample is start(), add() of every rank's window, finish().
class DepositRasters {
 public:
  static constexpr double BYTES_PER_CELL = 72.0;    // eight rasters, one more to write a file

  DepositRasters() : snapshot_step(-1), snapshot_time(0.0), change(1.0) {}

  void create(const PlanGrid &);    // std::bad_alloc

  // --- a sample; time: now; motion: a faster ball moves; record: also maxima and times ---

  void start();
  void add(DepositWindow &, bool record, double time, double motion);
  double finish(bool record);    // returns the volume that the thickness raster holds

  // the share of the released volume that went to another cell since the snapshot before, per
  // time: known if that was window steps ago, else it stays as it is
  void take_snapshot(int64_t step, int window, double time, double released);

  // --- files ---

  // PREFIX.base.asc, .thickness.asc, ...; number: also PREFIX.NUMBER.thickness.asc, or empty
  void write(FileSet &, const std::string &prefix, const std::string &number) const;

  // what cells that the mass touched saw, for restart files
  static constexpr int PER_CELL = 7;
  std::vector<double> touched() const;
  void restore(const double *values);    // of one cell

  size_t ncells() const { return base.z.size(); }

  ElevationGrid base, thickness, max_thickness, max_speed, max_energy, arrival, last_motion;
  int64_t snapshot_step;
  double snapshot_time, change;

 private:
  PlanGrid grid;
  ElevationGrid snapshot;    // thickness when the window began
  DepositWindow filled;      // cells of thickness that may not be 0
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_restart.h"

#include "comm.h"
#include "error.h"
#include "restart_count.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using Slope::DepositRasters;
using Slope::PlanGrid;

static constexpr double FORMAT = 5.0;    // first number of what a restart file holds
static constexpr int PER_CELL = DepositRasters::PER_CELL;
static constexpr double BYTES_PER_CELL = PER_CELL * sizeof(double);
static constexpr int MOST_CELLS = (MAXSMALLINT - 1024) / static_cast<int>(BYTES_PER_CELL);

static std::string too_many(double ncells)
{
  return fmt::format("in which it may have {} cells that the mass touched, got {:.0f}: start "
                     "again, with a larger cell",
                     MOST_CELLS, std::fabs(ncells));
}

/* ---------------------------------------------------------------------- */

DepositRestart::DepositRestart(LAMMPS *lmp, const DepositOptions &options) :
    Pointers(lmp),
    key({FORMAT, options.grid.cell, (double) options.grid.n[0], (double) options.grid.n[1],
         options.grid.lo[0], options.grid.lo[1], options.bulk})
{
}

/* ---------------------------------------------------------------------- */

void DepositRestart::write(FILE *fp, const std::string &fix_id, const Saved &saved,
                           const DepositRasters &rasters) const
{
  if (comm->me > 0) return;
  const int nrows = rasters.grid().n[1];
  double ncells = 0.0;
  for (int j = 0; j < nrows; j++) ncells += rasters.touched(j).size() / PER_CELL;
  const bool fits = ncells <= MOST_CELLS;
  const RestartCount count(fits ? ncells : -ncells);
  const double head = sizeof(Key) + sizeof(Saved) + sizeof(count);
  const int size = (int) (head + (fits ? ncells * BYTES_PER_CELL : 0.0));
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&key, sizeof(Key), 1, fp);
  fwrite(&saved, sizeof(Saved), 1, fp);
  fwrite(&count, sizeof(count), 1, fp);
  for (int j = 0; j < nrows && fits; j++) {
    const std::vector<double> cells = rasters.touched(j);
    fwrite(cells.data(), sizeof(double), cells.size(), fp);
  }
  if (!fits)
    error->warning(FLERR, "Fix deposit/grid {}: nothing can go on from this restart file, {}",
                   fix_id, too_many(ncells));
}

/* ---------------------------------------------------------------------- */

void DepositRestart::read(const std::string &fix_id, const char *buffer, Saved &saved,
                          DepositRasters &rasters) const
{
  auto take = [&](void *to, size_t bytes) {
    memcpy(to, buffer, bytes);
    buffer += bytes;
  };

  Key found;
  take(&found, sizeof(Key));
  check_key(fix_id, found);
  take(&saved, sizeof(Saved));
  RestartCount count;
  take(&count, sizeof(count));
  if (count.number < 0.0 && count.again == RestartCount(count.number).again)
    error->all(FLERR, "Fix deposit/grid {} cannot go on from this restart file, {}", fix_id,
               too_many(count.number));
  const size_t ncells = count.check(lmp, "Fix deposit/grid " + fix_id,
                                    std::min<double>(MOST_CELLS, rasters.grid().ncells()));
  for (size_t c = 0; c < ncells; c++) {
    double values[PER_CELL];
    take(values, sizeof(values));
    if (!(values[0] >= 0.0 && values[0] < rasters.grid().ncells()))
      error->all(FLERR,
                 "Fix deposit/grid {} must have a whole restart file, got cell {:g} of {:.0f}",
                 fix_id, values[0], rasters.grid().ncells());
    if (comm->me == 0) rasters.restore(values);
  }
}

/* ---------------------------------------------------------------------- */

void DepositRestart::check_key(const std::string &fix_id, const Key &found) const
{
  if (found.format != key.format)
    error->all(
        FLERR,
        "Fix deposit/grid {} must have restart data of format {:.0f}, got {:.0f}: the file is "
        "of another version of SLOPE: continue with that version, or start again",
        fix_id, key.format, found.format);
  if (memcmp(&found, &key, sizeof(Key)) == 0) return;
  auto text = [](const Key &k) {
    return fmt::format("cell {:.10g}, {:.0f} x {:.0f} cells from {:.10g} {:.10g}, bulk {}", k.cell,
                       k.nx, k.ny, k.xlo, k.ylo,
                       k.bulk > 0.0 ? fmt::format("{:.10g}", k.bulk) : "region");
  };
  error->all(FLERR, "Fix deposit/grid {} must have the grid of the restart file, {}; got {}",
             fix_id, text(found), text(key));
}

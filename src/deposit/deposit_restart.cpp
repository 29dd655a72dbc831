/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_restart.h"

#include "comm.h"
#include "error.h"
#include "restart_archive.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using Slope::DepositRasters;

static const std::string STYLE = "deposit/grid", CALLER = "Fix deposit/grid ";
static constexpr int VERSION = 6;    // of what restart files hold
static constexpr int PER_CELL = DepositRasters::PER_CELL;
static constexpr double BYTES_PER_CELL = PER_CELL * sizeof(double);
static constexpr int MOST_CELLS = (MAXSMALLINT - 4096) / static_cast<int>(BYTES_PER_CELL);

static std::string too_many(double ncells)
{
  return fmt::format("in which it may have {} cells that the mass touched, got {:.0f}: start "
                     "again, with a larger cell",
                     MOST_CELLS, ncells);
}

/* ---------------------------------------------------------------------- */

DepositRestart::DepositRestart(LAMMPS *lmp, const DepositOptions &options) :
    Pointers(lmp), grid(options.grid), bulk(options.bulk)
{
}

/* ----------------------------------------------------------------------
   the grid, then numbers; the cells follow the archive
------------------------------------------------------------------------- */

void DepositRestart::archive(Slope::Archive &archive, Saved &saved) const
{
  const Key mine = {grid.cell,  (double) grid.n[0], (double) grid.n[1],
                    grid.lo[0], grid.lo[1],         bulk};
  Key found = mine;
  archive.number("cell", found.cell);
  archive.number("columns", found.nx);
  archive.number("rows", found.ny);
  archive.number("xlo", found.xlo);
  archive.number("ylo", found.ylo);
  archive.number("bulk", found.bulk);
  check_key(found, mine);

  DepositRelease::Released &released = saved.released;
  archive.number("started", saved.started);
  archive.number("released_number", released.mass.number);
  archive.number("released_solid", released.mass.solid);
  archive.number("released_x", released.mass.x);
  archive.number("released_y", released.mass.y);
  archive.numbers("released_top", released.mass.top, 3);
  archive.number("released_volume", released.volume);
  archive.number("body", released.body);
  archive.number("front", released.front);
  archive.number("bulk_of_the_release", saved.bulk);
  archive.number("lost_number", saved.lost.number);
  archive.number("lost_volume", saved.lost.volume);
  archive.number("losses_in_the_log", saved.nlogged);
  archive.number("elapsed", saved.elapsed);
  archive.number("snapshot_time", saved.snapshot_time);
  archive.number("change", saved.change);
  archive.same("numbers_of_a_cell", PER_CELL);
}

/* ---------------------------------------------------------------------- */

void DepositRestart::write(FILE *fp, const std::string &fix_id, Saved saved,
                           const DepositRasters &rasters) const
{
  if (comm->me > 0) return;
  const int nrows = rasters.grid().n[1];
  double ncells = 0.0;
  for (int j = 0; j < nrows; j++) ncells += rasters.touched(j).size() / PER_CELL;
  const bool fits = ncells <= MOST_CELLS;
  double left_out = fits ? 0.0 : ncells;

  Slope::Archive to(STYLE, VERSION);
  archive(to, saved);
  to.number("cells_left_out", left_out);
  to.count("cells", fits ? static_cast<size_t>(ncells) : 0, MOST_CELLS);
  write_archive(lmp, fp, CALLER + fix_id, to, fits ? ncells * BYTES_PER_CELL : 0.0);
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
  read_archive(lmp, CALLER + fix_id, [&]() {
    Slope::Archive from(STYLE, VERSION, buffer);
    archive(from, saved);
    double left_out = 0.0;
    from.number("cells_left_out", left_out);
    if (left_out > 0.0)
      throw std::runtime_error("nothing can go on from this restart file, " + too_many(left_out));
    const size_t ncells =
        from.count("cells", 0, std::min<double>(MOST_CELLS, rasters.grid().ncells()));
    const char *next = from.rest();
    for (size_t c = 0; c < ncells; c++, next += sizeof(double) * PER_CELL) {
      double values[PER_CELL];
      memcpy(values, next, sizeof(values));
      if (!(values[0] >= 0.0 && values[0] < rasters.grid().ncells()))
        throw std::runtime_error(
            fmt::format("the restart file must be whole, got cell {:g} of {:.0f}", values[0],
                        rasters.grid().ncells()));
      if (comm->me == 0) rasters.restore(values);
    }
  });
}

/* ---------------------------------------------------------------------- */

void DepositRestart::check_key(const Key &found, const Key &mine)
{
  if (memcmp(&found, &mine, sizeof(Key)) == 0) return;
  auto text = [](const Key &k) {
    return fmt::format("cell {:.10g}, {:.0f} x {:.0f} cells from {:.10g} {:.10g}, bulk {}", k.cell,
                       k.nx, k.ny, k.xlo, k.ylo,
                       k.bulk > 0.0 ? fmt::format("{:.10g}", k.bulk) : "region");
  };
  throw std::runtime_error(fmt::format("the grid must be that of the restart file, {}; got {}",
                                       text(found), text(mine)));
}

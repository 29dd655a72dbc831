/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_restart.h"

#include "comm.h"
#include "error.h"
#include "modify.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

using namespace LAMMPS_NS;
using Slope::DepositRasters;
using Slope::PlanGrid;

static constexpr double FORMAT = 3.0;    // first number of what a restart file holds
static constexpr int PER_CELL = DepositRasters::PER_CELL;

/* ---------------------------------------------------------------------- */

DepositRestart::DepositRestart(LAMMPS *lmp, const DepositOptions &options) :
    Pointers(lmp),
    key({FORMAT, options.grid.cell, (double) options.grid.n[0], (double) options.grid.n[1],
         options.grid.lo[0], options.grid.lo[1], options.bulk}),
    pieces(options.grid, most_bytes(lmp)), exchange(lmp)
{
}

/* ----------------------------------------------------------------------
   tests cannot fill 2 GB: they make pieces smaller
------------------------------------------------------------------------- */

double DepositRestart::most_bytes(LAMMPS *lmp)
{
  const char *smaller = getenv("SLOPE_RESTART_PIECE");
  double bytes = Slope::DepositPieces::MOST_BYTES;
  if (smaller) bytes = utils::is_double(smaller) ? strtod(smaller, nullptr) : 0.0;
  MPI_Bcast(&bytes, 1, MPI_DOUBLE, 0, lmp->world);
  if (!(bytes > 0.0)) lmp->error->all(FLERR, "SLOPE_RESTART_PIECE must be a number of bytes > 0");
  return std::min(bytes, +Slope::DepositPieces::MOST_BYTES);
}

/* ---------------------------------------------------------------------- */

void DepositRestart::add_parts(const std::string &fix_id)
{
  for (int piece = 1; piece < pieces.number(); piece++) {
    parts.push_back(fmt::format("{}_DEPOSIT_GRID_PART_{}", fix_id, piece));
    modify->add_fix(fmt::format("{} all DEPOSIT_GRID_PART {} {}", parts.back(), fix_id, piece));
  }
}

/* ---------------------------------------------------------------------- */

void DepositRestart::remove_parts()
{
  for (const std::string &id : parts)
    if (modify->nfix && modify->find_fix(id) >= 0) modify->delete_fix(id);
  parts.clear();
}

/* ----------------------------------------------------------------------
   the cells go to rank 0 band by band, so that it never holds more than one
------------------------------------------------------------------------- */

void DepositRestart::write(FILE *fp, int piece, const Saved &saved, const DepositRasters &rasters)
{
  const Slope::DepositBands &bands = rasters.bands();
  const int first = pieces.first_band(piece), last = pieces.last_band(piece);
  double mine = 0.0, ncells;
  for (int band = first; band <= last; band++)
    if (bands.mine(band)) mine += rasters.touched(band).size() / PER_CELL;
  MPI_Allreduce(&mine, &ncells, 1, MPI_DOUBLE, MPI_SUM, world);

  if (comm->me == 0) {
    const double head = sizeof(Key) + (piece == 0 ? sizeof(Saved) : 0) + sizeof(double);
    const int size = (int) (head + ncells * PER_CELL * sizeof(double));
    fwrite(&size, sizeof(int), 1, fp);
    fwrite(&key, sizeof(Key), 1, fp);
    if (piece == 0) fwrite(&saved, sizeof(Saved), 1, fp);
    fwrite(&ncells, sizeof(double), 1, fp);
  }
  auto make = [&](int band) {
    const std::vector<double> cells = rasters.touched(band);
    return std::string(reinterpret_cast<const char *>(cells.data()), cells.size() * sizeof(double));
  };
  auto take = [fp](const std::string &bytes) {
    fwrite(bytes.data(), 1, bytes.size(), fp);
  };
  exchange.to_rank_zero(bands, first, last, make, take);
}

/* ---------------------------------------------------------------------- */

void DepositRestart::read(const std::string &fix_id, const char *buffer, int piece, Saved &saved,
                          DepositRasters &rasters) const
{
  auto take = [&](void *to, size_t bytes) {
    memcpy(to, buffer, bytes);
    buffer += bytes;
  };

  Key found;
  take(&found, sizeof(Key));
  check_key(fix_id, found);
  if (piece == 0) take(&saved, sizeof(Saved));
  double ncells;
  take(&ncells, sizeof(double));
  for (double c = 0.0; c < ncells; c++) {
    double values[PER_CELL];
    take(values, sizeof(values));
    if (!(values[0] >= 0.0 && values[0] < rasters.grid().ncells()))
      error->all(FLERR,
                 "Fix deposit/grid {} must have a whole restart file, got cell {:g} of {:.0f}",
                 fix_id, values[0], rasters.grid().ncells());
    rasters.restore(values);
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

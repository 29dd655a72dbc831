/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_options.h"

#include "deposit_rasters.h"
#include "deposit_summary.h"
#include "elevation_grid.h"
#include "lammps_compat.h"
#include "region_surface.h"
#include "style_argument.h"

#include "atom.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using Slope::DepositRasters;
using Slope::DepositSummary;
using Slope::PlanGrid;

static constexpr double MAXBULK = 1.0e3;     // a ball's square must not be cut by countless cells
static constexpr double MAXCELL = 1.0e12;    // the area of a cell must be finite

// reads and checks them, one by one
namespace {
class Words : public DepositOptions, protected Pointers {
 public:
  Words(LAMMPS *, int narg, char **arg);

 private:
  const int narg;
  int iarg;
  char **const arg;
  bool extent_set;
  double extent[4];

  const char *text(int k) const;
  double positive() const;
  int keyword();
  int read_bulk();
  int read_window();
  int read_series();
  int read_extent();
  void check() const;
  void make_grid();
};
}    // namespace

DepositOptions DepositOptions::read(LAMMPS *lmp, int narg, char **arg)
{
  return Words(lmp, narg, arg);
}

/* ----------------------------------------------------------------------
   fix ID group deposit/grid Nevery Nfreq cell S terrain REGION output PREFIX keyword value ...
------------------------------------------------------------------------- */

Words::Words(LAMMPS *lmp, int narg_in, char **arg_in) :
    Pointers(lmp), narg(narg_in), iarg(5), arg(arg_in), extent_set(false)
{
  if (narg < 5)
    error->all(FLERR, "Fix deposit/grid needs Nevery Nfreq cell S terrain REGION output PREFIX");
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag)
    error->all(FLERR, "Fix deposit/grid requires balls: atom_style must be sphere, got {}",
               atom->atom_style);
  if (domain->dimension != 3)
    error->all(FLERR, "Fix deposit/grid requires a simulation in 3 dimensions, got 2");

  nevery = whole_number_argument(lmp, "Fix deposit/grid Nevery", arg[3]);
  if (nevery < 1) error->all(FLERR, "Fix deposit/grid Nevery must be >= 1, got {}", nevery);
  nfreq = whole_number_argument(lmp, "Fix deposit/grid Nfreq", arg[4]);
  if (nfreq < 0 || nfreq % nevery)
    error->all(FLERR, "Fix deposit/grid Nfreq must be 0 or a multiple of Nevery {}, got {}", nevery,
               nfreq);

  while (iarg < narg) iarg += 1 + keyword();
  check();
  if (window == 0) window = nfreq > 0 ? nfreq : 10 * nevery;
  make_grid();
}

/* ----------------------------------------------------------------------
   value k of the keyword
------------------------------------------------------------------------- */

const char *Words::text(int k) const
{
  if (iarg + k >= narg) error->all(FLERR, "Fix deposit/grid {}: value {} is missing", arg[iarg], k);
  return arg[iarg + k];
}

/* ---------------------------------------------------------------------- */

double Words::positive() const
{
  const std::string what = std::string("Fix deposit/grid ") + arg[iarg];
  const double value = number_argument(lmp, what, text(1));
  if (!(value > 0.0)) error->all(FLERR, "{} must be > 0, got {}", what, arg[iarg + 1]);
  return value;
}

/* ----------------------------------------------------------------------
   the keyword at iarg; returns how many values it has
------------------------------------------------------------------------- */

int Words::keyword()
{
  const std::string keyword = arg[iarg];
  if (keyword == "cell") {
    cell = positive();
    if (cell > MAXCELL)
      error->all(FLERR, "Fix deposit/grid cell must be at most {:g}, got {}", MAXCELL, text(1));
    return 1;
  }
  if (keyword == "terrain" || keyword == "output") {
    (keyword == "terrain" ? terrain : prefix) = text(1);
    return 1;
  }
  if (keyword == "motion") {
    motion = positive();
    return 1;
  }
  if (keyword == "rest") {
    rest = positive();
    if (rest > DepositSummary::MOVING_SHARE)
      error->all(FLERR, "Fix deposit/grid rest must be at most {:g}, got {}",
                 DepositSummary::MOVING_SHARE, text(1));
    return 1;
  }
  if (keyword == "bulk") return read_bulk();
  if (keyword == "window") return read_window();
  if (keyword == "series") return read_series();
  if (keyword == "extent") return read_extent();
  error->all(FLERR,
             "Fix deposit/grid: unknown keyword {}, must be cell, terrain, output, bulk, "
             "extent, motion, rest, window or series",
             keyword);
  return 0;
}

/* ---------------------------------------------------------------------- */

int Words::read_bulk()
{
  if (strcmp(text(1), "region") == 0) {
    body = text(2);
    bulk = 0.0;
    return 2;
  }
  body.clear();
  bulk = positive();
  if (bulk > MAXBULK)
    error->all(FLERR, "Fix deposit/grid bulk must be at most {:g}, got {}", MAXBULK, text(1));
  return 1;
}

/* ---------------------------------------------------------------------- */

int Words::read_window()
{
  window = whole_number_argument(lmp, "Fix deposit/grid window", text(1));
  if (window < 1 || window % nevery)
    error->all(FLERR, "Fix deposit/grid window must be a multiple of Nevery {}, got {}", nevery,
               window);
  return 1;
}

/* ---------------------------------------------------------------------- */

int Words::read_series()
{
  if (strcmp(text(1), "yes") != 0 && strcmp(text(1), "no") != 0)
    error->all(FLERR, "Fix deposit/grid series must be yes or no, got {}", text(1));
  series = strcmp(text(1), "yes") == 0;
  return 1;
}

/* ---------------------------------------------------------------------- */

int Words::read_extent()
{
  for (int k = 0; k < 4; k++)
    extent[k] = number_argument(lmp, "Fix deposit/grid extent", text(k + 1));
  extent_set = true;
  return 4;
}

/* ---------------------------------------------------------------------- */

void Words::check() const
{
  if (cell == 0.0) error->all(FLERR, "Fix deposit/grid keyword cell is missing");
  if (terrain.empty()) error->all(FLERR, "Fix deposit/grid keyword terrain is missing");
  if (prefix.empty()) error->all(FLERR, "Fix deposit/grid keyword output is missing");
  if (!body.empty() && !compat::find_region(lmp, body))
    error->all(FLERR, "Fix deposit/grid bulk region {} does not exist", body);
}

/* ----------------------------------------------------------------------
   whole cells cover the extent, from its south-west corner on
------------------------------------------------------------------------- */

void Words::make_grid()
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", terrain.c_str(),
                             RegionSurface::UPPER);
  if (!ground.has_boundary())
    error->all(FLERR, "Fix deposit/grid terrain region {} must have an upper boundary, got INF",
               terrain);
  const double whole[4] = {ground.xlo, ground.xhi, ground.ylo, ground.yhi};
  if (!extent_set) std::copy(whole, whole + 4, extent);
  const std::string got =
      fmt::format("{:.10g} {:.10g} {:.10g} {:.10g}", extent[0], extent[1], extent[2], extent[3]);
  if (!(extent[0] < extent[1] && extent[2] < extent[3]))
    error->all(FLERR, "Fix deposit/grid extent must have xlo < xhi and ylo < yhi, got {}", got);
  const double tiny = 1.0e-3 * cell;    // coordinates in decks are rounded
  for (int k = 0; k < 4; k += 2)
    if (!(extent[k] >= whole[k] - tiny && extent[k + 1] <= whole[k + 1] + tiny))
      error->all(FLERR,
                 "Fix deposit/grid extent must lie in that of region {}, {:.10g} {:.10g} {:.10g} "
                 "{:.10g}, got {}",
                 terrain, whole[0], whole[1], whole[2], whole[3], got);

  const double ncells = PlanGrid::cells_in(extent[0], extent[1], cell) *
      PlanGrid::cells_in(extent[2], extent[3], cell);
  const double most = Slope::ElevationGrid::MAXCELLS;    // as many as the readers of rasters take
  if (ncells > most)
    error->all(FLERR,
               "Fix deposit/grid cell must give at most {:.0f} cells, got {:.0f} cells, they need "
               "{:.3g} GB of memory",
               most, ncells, 1.0e-9 * ncells * DepositRasters::MOST_BYTES_PER_CELL);
  grid = PlanGrid(extent, cell);
}

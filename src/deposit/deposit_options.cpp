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

using namespace LAMMPS_NS;
using Slope::DepositRasters;
using Slope::DepositSummary;
using Slope::PlanGrid;

static constexpr double MAXBULK = 1.0e3;     // a ball's square must not be cut by countless cells
static constexpr double MAXCELL = 1.0e12;    // the area of a cell must be finite

/* ----------------------------------------------------------------------
   fix ID group deposit/grid Nevery Nfreq cell S terrain REGION output PREFIX keyword value ...
------------------------------------------------------------------------- */

DepositOptions::DepositOptions(LAMMPS *lmp, int narg, char **arg) : Pointers(lmp)
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

  read_keywords(narg - 5, arg + 5);
  check();
  if (window == 0) window = nfreq > 0 ? nfreq : 10 * nevery;
  make_grid();
}

/* ---------------------------------------------------------------------- */

void DepositOptions::read_keywords(int narg, char **arg)
{
  KeywordReader word(lmp, "Fix deposit/grid", narg, arg);
  const auto positive_up_to = [&word](double most) {
    const double value = word.positive();
    word.must(value <= most, fmt::format("at most {:g}", most));
    return value;
  };
  while (word.next())
    if (word.is("cell", "S"))
      cell = positive_up_to(MAXCELL);
    else if (word.is("terrain", "REGION"))
      terrain = word.text();
    else if (word.is("output", "PREFIX"))
      prefix = word.text();
    else if (word.is("bulk", "B|region")) {
      body.clear();
      bulk = 0.0;
      if (word.text() == std::string("region")) {
        word.more("REGION");
        body = word.text(2);
      } else
        bulk = positive_up_to(MAXBULK);
    } else if (word.is("extent", "xlo xhi ylo yhi")) {
      extent = {word.number(1), word.number(2), word.number(3), word.number(4)};
    } else if (word.is("motion", "V"))
      motion = word.positive();
    else if (word.is("rest", "SHARE"))
      rest = positive_up_to(DepositSummary::MOVING_SHARE);
    else if (word.is("window", "N")) {
      window = word.whole_number();
      word.must(window >= 1 && window % nevery == 0,
                fmt::format("a multiple of Nevery {}", nevery));
    } else if (word.is("series", "yes|no"))
      series = word.choice({"yes", "no"}) == 0;
    else
      word.unknown();
}

/* ---------------------------------------------------------------------- */

void DepositOptions::check() const
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

void DepositOptions::make_grid()
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", terrain.c_str(),
                             RegionSurface::UPPER);
  if (!ground.has_boundary())
    error->all(FLERR, "Fix deposit/grid terrain region {} must have an upper boundary, got INF",
               terrain);
  const double whole[4] = {ground.xlo, ground.xhi, ground.ylo, ground.yhi};
  if (extent.empty()) extent.assign(whole, whole + 4);
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
  grid = PlanGrid(extent.data(), cell);
}

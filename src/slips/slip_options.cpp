/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_options.h"

#include "constants.h"
#include "lammps_compat.h"
#include "rank_zero.h"
#include "region_polygon.h"
#include "region_terrain.h"
#include "style_argument.h"

#include "comm.h"
#include "error.h"

#include <cctype>
#include <cmath>

using namespace LAMMPS_NS;
using Slope::ElevationGrid;
using Slope::SlipFactor;
using Slope::SlipSoil;

static constexpr int MOST_KEPT = 1000;

/* ----------------------------------------------------------------------
   find_slip REGION strength C PHI DENSITY keyword value ... output PREFIX
------------------------------------------------------------------------- */

SlipOptions::SlipOptions(LAMMPS *lmp, int narg_in, char **arg_in) :
    Pointers(lmp), lone(false), narg(narg_in), iarg(1), arg(arg_in), ru(0.0),
    has_strength(false), top{0.0, 0.0, 0.0}
{
  if (narg < 1)
    error->all(FLERR,
               "Find_slip needs REGION strength C PHI DENSITY ... output PREFIX, got no "
               "arguments");
  region = arg[0];
  while (iarg < narg) iarg += 1 + keyword();
  check();
}

/* ----------------------------------------------------------------------
   value k of the keyword
------------------------------------------------------------------------- */

const char *SlipOptions::text(int k) const
{
  if (iarg + k >= narg) error->all(FLERR, "Find_slip {}: value {} is missing", arg[iarg], k);
  return arg[iarg + k];
}

double SlipOptions::number(int k, const std::string &of) const
{
  return number_argument(lmp, std::string("Find_slip ") + arg[iarg] + of, text(k));
}

SlipSoil::Strength SlipOptions::strength(int k) const
{
  const std::string what = std::string("Find_slip ") + arg[iarg];
  const double c = number(k, " C"), phi = number(k + 1, " PHI"),
               density = number(k + 2, " DENSITY");
  if (c < 0.0) error->all(FLERR, "{} C must be >= 0 (Pa), got {}", what, text(k));
  if (!(phi >= 0.0 && phi < 90.0))
    error->all(FLERR, "{} PHI must be 0 to below 90 (degrees), got {}", what, text(k + 1));
  if (c == 0.0 && phi == 0.0) error->all(FLERR, "{} C or PHI must be > 0, got 0 and 0", what);
  if (!(density > 0.0))
    error->all(FLERR, "{} DENSITY must be > 0 (kg/m3), got {}", what, text(k + 2));
  return {c, std::tan(phi * Slope::DEGREE), density};
}

/* ----------------------------------------------------------------------
   the keyword at iarg; returns how many values it has
------------------------------------------------------------------------- */

int SlipOptions::keyword()
{
  const std::string keyword = arg[iarg];
  if (keyword == "strength") {
    top = strength(1);
    has_strength = true;
    return 3;
  }
  if (keyword == "layer") {
    layers.push_back({text(1), strength(2)});
    return 4;
  }
  if (keyword == "output" || keyword == "bedrock" || keyword == "within") {
    (keyword == "output" ? output : keyword == "bedrock" ? bedrock : within) = text(1);
    return 1;
  }
  if (keyword == "water") return read_water();
  if (keyword == "seismic") return read_seismic();
  if (keyword == "direction") return read_direction();
  if (keyword == "volume" || keyword == "depth") return read_limits();
  if (keyword == "keep") {
    limits.keep = whole_number_argument(lmp, "Find_slip keep", text(1));
    if (limits.keep < 1 || limits.keep > MOST_KEPT)
      error->all(FLERR, "Find_slip keep must be 1 to {}, got {}", MOST_KEPT, text(1));
    return 1;
  }
  if (keyword == "method") return read_method();
  if (keyword == "shape") return read_shape();
  if (keyword == "surface") return read_surface();
  error->all(FLERR,
             "Find_slip: unknown keyword {}, must be strength, layer, water, bedrock, seismic, "
             "within, volume, depth, keep, direction, method, shape, surface or output",
             keyword);
  return 0;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_water()
{
  const std::string kind = text(1);
  if (kind == "table") {
    table = text(2);
    ru = 0.0;
  } else if (kind == "ru") {
    ru = number(2, " ru");
    table.clear();
    if (!(ru >= 0.0 && ru < 1.0))
      error->all(FLERR, "Find_slip water ru must be 0 to below 1, got {}", text(2));
  } else
    error->all(FLERR, "Find_slip water must be ru or table, got {}", kind);
  return 2;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_seismic()
{
  task.seismic = {number(1, " KH"), 0.0};
  if (task.seismic.horizontal < 0.0)
    error->all(FLERR, "Find_slip seismic KH must be >= 0 (of the weight), got {}", text(1));
  if (iarg + 2 >= narg || isalpha(static_cast<unsigned char>(arg[iarg + 2][0]))) return 1;
  task.seismic.vertical = number(2, " KV");
  if (!(std::fabs(task.seismic.vertical) < 1.0))
    error->all(FLERR, "Find_slip seismic KV must be above -1 and below 1 (of the weight), got {}",
               text(2));
  return 2;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_direction()
{
  task.any_direction = strcmp(text(1), "search") == 0;
  if (!task.any_direction) task.direction = number(1) * Slope::DEGREE;
  return 1;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_limits()
{
  const double lo = number(1, " LO"), hi = number(2, " HI");
  if (!(lo >= 0.0 && lo < hi))
    error->all(FLERR, "Find_slip {} must be LO HI with 0 <= LO < HI, got {} {}", arg[iarg], text(1),
               text(2));
  const bool volume = strcmp(arg[iarg], "volume") == 0;
  (volume ? limits.volume_lo : limits.depth_lo) = lo;
  (volume ? limits.volume_hi : limits.depth_hi) = hi;
  return 2;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_method()
{
  const std::string method = text(1);
  if (method == "bishop")
    task.method = SlipFactor::BISHOP;
  else if (method == "ordinary")
    task.method = SlipFactor::ORDINARY;
  else if (method == "spencer")
    task.method = SlipFactor::SPENCER;
  else
    error->all(FLERR, "Find_slip method must be bishop, ordinary or spencer, got {}", method);
  return 1;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_shape()
{
  const std::string shape = text(1);
  if (shape != "sphere" && shape != "ellipsoid")
    error->all(FLERR, "Find_slip shape must be sphere or ellipsoid, got {}", shape);
  limits.ellipsoids = shape == "ellipsoid";
  return 1;
}

/* ---------------------------------------------------------------------- */

int SlipOptions::read_surface()
{
  const std::string kind = text(1);
  if (kind == "raster") error->all(FLERR, "Find_slip surface raster is not available");
  if (kind != "sphere" && kind != "ellipsoid")
    error->all(FLERR, "Find_slip surface must be sphere or ellipsoid, got {}", kind);
  surface = {number(2, " X"), number(3, " Y"), number(4, " Z"), number(5, " R")};
  if (!(surface.radius > 0.0))
    error->all(FLERR, "Find_slip surface R must be > 0, got {}", text(5));
  lone = true;
  if (kind == "sphere") return 5;
  surface.along = number(6, " A");
  surface.across = number(7, " B");
  surface.straight = number(8, " L");
  if (!(surface.along > 0.0 && surface.across > 0.0))
    error->all(FLERR, "Find_slip surface A and B must be > 0 (of R), got {} {}", text(6), text(7));
  if (!(surface.straight >= 0.0))
    error->all(FLERR, "Find_slip surface L must be >= 0, got {}", text(8));
  return 8;
}

/* ---------------------------------------------------------------------- */

void SlipOptions::check()
{
  if (!has_strength) error->all(FLERR, "Find_slip keyword strength is missing");
  if (output.empty()) error->all(FLERR, "Find_slip keyword output is missing");
  if (lone && !surface.round() && task.any_direction)
    error->all(FLERR,
               "Find_slip direction DEG must be given with surface ellipsoid, whose A is along it");
  bool loose = top.cohesion == 0.0;
  for (const Layer &layer : layers) loose |= layer.strength.cohesion == 0.0;
  if (!lone && loose && limits.volume_lo == 0.0)
    error->all(
        FLERR,
        "Find_slip volume LO must be > 0 where C is 0, as the factor falls with the depth of "
        "the body, got 0");

  name = output.substr(output.rfind('/') + 1);
  bool good = !name.empty();
  for (const char c : name) good &= isalnum(static_cast<unsigned char>(c)) || c == '_';
  if (!good)
    error->all(FLERR,
               "Find_slip output PREFIX must end with letters, digits or _, as it is the beginning "
               "of variables' names, got {}",
               output);

  check_region<RegTerrain>("Find_slip", region, "terrain");
  if (!within.empty()) check_region<RegPolygon>("Find_slip within:", within, "polygon");
}

template <class Kind>
void SlipOptions::check_region(const char *what, const std::string &named, const char *style) const
{
  Region *found = compat::find_region(lmp, named);
  if (!found) error->all(FLERR, "{} region {} does not exist", what, named);
  if (!dynamic_cast<Kind *>(found))
    error->all(FLERR, "{} region {} must be of style {}, got {}", what, named, style, found->style);
  if (found->dynamic_check() || !found->interior)
    error->all(FLERR, "{} region {} must stand still and have side in", what, named);
}

/* ---------------------------------------------------------------------- */

const ElevationGrid &SlipOptions::ground() const
{
  return dynamic_cast<RegTerrain *>(compat::find_region(lmp, region))->grid();
}

/* ---------------------------------------------------------------------- */

std::vector<char> SlipOptions::allowed() const
{
  std::vector<char> flags;
  if (within.empty()) return flags;
  const auto prism = dynamic_cast<RegPolygon *>(compat::find_region(lmp, within));
  const ElevationGrid &grid = ground();
  for (int j = 0; j < grid.ny; j++)
    for (int i = 0; i < grid.nx; i++)
      flags.push_back(
          prism->covers(grid.xlo + (i + 0.5) * grid.cell, grid.ylo + (j + 0.5) * grid.cell));
  return flags;
}

/* ----------------------------------------------------------------------
   one rank reads; its errors end the run on all ranks
------------------------------------------------------------------------- */

ElevationGrid SlipOptions::raster(const std::string &file) const
{
  ElevationGrid grid;
  on_rank_zero(lmp, "Find_slip", [&]() {
    grid = ElevationGrid::read(file);
  });
  int size[2] = {grid.nx, grid.ny};
  double place[3] = {grid.xlo, grid.ylo, grid.cell};
  MPI_Bcast(size, 2, MPI_INT, 0, world);
  MPI_Bcast(place, 3, MPI_DOUBLE, 0, world);
  on_all_ranks(lmp, "Find_slip", [&]() {
    if (comm->me > 0) grid = ElevationGrid(size[0], size[1], place[0], place[1], place[2], 0.0);
  });
  for (int j = 0; j < grid.ny; j++) MPI_Bcast(&grid.at(0, j), grid.nx, MPI_DOUBLE, 0, world);
  return grid;
}

SlipSoil SlipOptions::soil() const
{
  SlipSoil soil(top);
  for (const Layer &layer : layers) soil.add_layer(raster(layer.file), layer.strength);
  soil.set_ratio(ru);
  if (!table.empty()) soil.set_table(raster(table));
  if (!bedrock.empty()) soil.set_bedrock(raster(bedrock));
  const std::string problem = soil.contradiction(ground());
  if (!problem.empty()) error->all(FLERR, "Find_slip {}", problem);
  return soil;
}

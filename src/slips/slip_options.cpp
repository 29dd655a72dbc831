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

#include <cmath>

using namespace LAMMPS_NS;
using Slope::ElevationGrid;
using Slope::SlipFactor;
using Slope::SlipSoil;

static constexpr int MOST_KEPT = 1000;

/* ----------------------------------------------------------------------
   find_slip REGION strength C PHI DENSITY keyword value ... output PREFIX
------------------------------------------------------------------------- */

SlipOptions::SlipOptions(LAMMPS *lmp, int narg, char **arg) :
    Pointers(lmp), lone(false), ru(0.0), has_strength(false), top{0.0, 0.0, 0.0}
{
  if (narg < 1)
    error->all(FLERR,
               "Find_slip needs REGION strength C PHI DENSITY ... output PREFIX, got no "
               "arguments");
  region = arg[0];
  for (KeywordReader word(lmp, "Find_slip", narg - 1, arg + 1); word.next();)
    if (!read_soil(word) && !read_search(word)) word.unknown();
  check();
}

/* ----------------------------------------------------------------------
   values k to k + 2
------------------------------------------------------------------------- */

SlipSoil::Strength SlipOptions::strength(const KeywordReader &word, int k) const
{
  const double c = word.number(k), phi = word.number(k + 1), density = word.number(k + 2);
  word.must(c >= 0.0, ">= 0 (Pa)", k);
  word.must(phi >= 0.0 && phi < 90.0, "0 to below 90 (degrees)", k + 1);
  if (c == 0.0 && phi == 0.0)
    error->all(FLERR, "Find_slip {} C or PHI must be > 0, got 0 and 0", *word.begin());
  word.must(density > 0.0, "> 0 (kg/m3)", k + 2);
  return {c, std::tan(phi * Slope::DEGREE), density};
}

/* ----------------------------------------------------------------------
   keywords of the soil and its loads, and of the surfaces: whether it is one of them
------------------------------------------------------------------------- */

bool SlipOptions::read_soil(KeywordReader &word)
{
  if (word.is("strength", "C PHI DENSITY")) {
    top = strength(word, 1);
    has_strength = true;
  } else if (word.is("layer", "FILE C PHI DENSITY")) {
    layers.push_back({word.text(1), strength(word, 2)});
  } else if (word.is("water", "ru|table")) {
    const bool is_table = word.choice({"ru", "table"}) == 1;
    word.more(is_table ? "FILE" : "R");
    table = is_table ? word.text(2) : "";
    ru = is_table ? 0.0 : word.number(2);
    word.must(ru >= 0.0 && ru < 1.0, "0 to below 1", 2);
  } else if (word.is("bedrock", "FILE")) {
    bedrock = word.text();
  } else if (word.is("seismic", "KH")) {
    const bool both = word.value_follows();
    if (both) word.more("KV");
    task.seismic = {word.number(1), both ? word.number(2) : 0.0};
    word.must(task.seismic.horizontal >= 0.0, ">= 0 (horizontal, of the weight)", 1);
    word.must(std::fabs(task.seismic.vertical) < 1.0, "above -1 and below 1 (of the weight)", 2);
  } else {
    return false;
  }
  return true;
}

bool SlipOptions::read_search(KeywordReader &word)
{
  if (word.is("within", "REGION")) {
    within = word.text();
  } else if (word.is("volume", "LO HI")) {
    read_limits(word, limits.volume_lo, limits.volume_hi);
  } else if (word.is("depth", "LO HI")) {
    read_limits(word, limits.depth_lo, limits.depth_hi);
  } else if (word.is("keep", "N")) {
    limits.keep = word.whole_number();
    word.must(limits.keep >= 1 && limits.keep <= MOST_KEPT, fmt::format("1 to {}", MOST_KEPT));
  } else if (word.is("direction", "DEG|search")) {
    task.any_direction = word.text() == std::string("search");
    if (!task.any_direction) task.direction = word.number() * Slope::DEGREE;
  } else if (word.is("method", "bishop|ordinary|spencer")) {
    static_assert(SlipFactor::ORDINARY == 0 && SlipFactor::SPENCER == 2, "the order of the words");
    task.method = static_cast<SlipFactor::Method>(word.choice({"ordinary", "bishop", "spencer"}));
  } else if (word.is("shape", "sphere|ellipsoid")) {
    limits.ellipsoids = word.choice({"sphere", "ellipsoid"}) == 1;
  } else if (word.is("surface", "sphere|ellipsoid")) {
    read_surface(word);
  } else if (word.is("output", "PREFIX")) {
    output = word.text();
  } else {
    return false;
  }
  return true;
}

void SlipOptions::read_limits(const KeywordReader &word, double &lo, double &hi) const
{
  lo = word.number(1);
  hi = word.number(2);
  if (!(lo >= 0.0 && lo < hi))
    error->all(FLERR, "Find_slip {} must be LO HI with 0 <= LO < HI, got {} {}", *word.begin(),
               word.text(1), word.text(2));
}

void SlipOptions::read_surface(KeywordReader &word)
{
  const bool ellipsoid = word.choice({"sphere", "ellipsoid"}) == 1;
  word.more("X Y Z R");
  surface = {word.number(2), word.number(3), word.number(4), word.positive(5)};
  lone = true;
  if (!ellipsoid) return;
  word.more("A B L");
  surface.along = word.positive(6);
  surface.across = word.positive(7);
  surface.straight = word.number(8);
  word.must(surface.straight >= 0.0, ">= 0", 8);
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
  Region *found = region_argument(lmp, what, named);
  if (!dynamic_cast<Kind *>(found))
    error->all(FLERR, "{} region {} must be of style {}, got {}", what, named, style, found->style);
  if (!found->interior) error->all(FLERR, "{} region {} must have side in, got out", what, named);
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

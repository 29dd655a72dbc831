/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "placement_arguments.h"

#include "constants.h"
#include "error.h"
#include "region_surface.h"
#include "scattered_sampler.h"
#include "style_argument.h"

#include <cmath>

using namespace LAMMPS_NS;
using Slope::FARTHEST;

static constexpr double LEAST_SINK = 0.05;    // in diameters: the closer, the more columns it takes

/* ---------------------------------------------------------------------- */

PlacementArguments::PlacementArguments(LAMMPS *lmp, const std::string &caller_in,
                                       double diameter_in, double smallest_in, int narg, char **arg,
                                       bool of_wall) :
    Pointers(lmp),
    caller(caller_in), diameter(diameter_in), side(RegionSurface::UPPER),
    spacing(0.0), origin{0.0, 0.0}, scattered(false), seed(1), angle(0.0), sink(0.0),
    outside_sink(-1.0), smallest(smallest_in)
{
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    error->all(FLERR, "{} diameter must be > 0, got {}", caller, diameter);
  parse(narg, arg, of_wall);
  if (region.empty())
    smallest = 0.0;
  else if (!(smallest > 0.0 && smallest < diameter))
    smallest = diameter;
  check_zones();
  if (scattered) check_pattern();
}

/* ---------------------------------------------------------------------- */

void PlacementArguments::parse(int narg, char **arg, bool of_wall)
{
  const std::string first = of_wall ? "surface or file" : "surface, file or fill";
  KeywordReader word(lmp, caller, narg, arg);
  if (!word.next()) error->all(FLERR, "{} needs {}, got neither", caller, first);
  if (word.is("surface", "REGION side")) {
    region = word.text(1);
    side = word.choice({"upper", "lower"}, 2) == 0 ? RegionSurface::UPPER : RegionSurface::LOWER;
  } else if (word.is("file", "FILE")) {
    file = word.text();
  } else {
    error->all(FLERR, "{} needs {}, got {}", caller, first, arg[0]);
  }

  while (word.next())
    if (!(!region.empty() && parse_surface(word)) && !parse_filter(word) &&
        !(of_wall && parse_of_wall(word)))
      word.unknown();
  if (!region.empty() && spacing == 0.0)
    error->all(FLERR, "{} surface needs a spacing, got none", caller);
  if (outside_sink >= 0.0 && outside.empty())
    error->all(FLERR, "{} sunk needs outside REGION, got none", caller);
}

// keywords of a surface, of all, and of a wall: whether it is one of them

bool PlacementArguments::parse_surface(KeywordReader &word)
{
  if (word.is("spacing", "S")) {
    spacing = word.positive();
  } else if (word.is("origin", "x y")) {
    for (int d = 0; d < 2; d++) {
      origin[d] = word.number(1 + d);
      word.must(std::fabs(origin[d]) <= FARTHEST, fmt::format("within +-{:g}", FARTHEST), 1 + d);
    }
  } else if (word.is("pattern", "grid|scattered")) {
    scattered = word.choice({"grid", "scattered"}) == 1;
    if (!scattered || !word.value_follows()) return true;
    word.more("SEED");
    seed = word.whole_number(2);
    word.must(seed >= 1, "> 0", 2);
  } else if (word.is("angle", "DEG")) {
    angle = word.number() * Slope::PI / 180.0;
    word.must(std::fabs(angle) <= 2.0 * Slope::PI, "within +-360 (degrees)");
  } else if (word.is("sink", "H") || word.is("sunk", "H")) {
    const double value = word.number(), least = LEAST_SINK * diameter;
    word.must(value == 0.0 || value >= least,
              fmt::format("0 or at least {:.6g} ({} diameters)", least, LEAST_SINK));
    (word.is("sink", "H") ? sink : outside_sink) = value;
  } else if (word.is("smallest", "D")) {
    smallest = word.positive();
  } else if (*word.begin() == std::string("rim")) {
    error->all(FLERR,
               "{} rim is no keyword any more, ground and slip surface are one surface now; make "
               "the site anew, slope site FOLDER",
               caller);
  } else {
    return false;
  }
  return true;
}

bool PlacementArguments::parse_filter(KeywordReader &word)
{
  const bool within = word.is("inside", "REGION");
  if (!within && !word.is("outside", "REGION")) return false;
  std::string &filter = within ? inside : outside;
  if (!filter.empty())
    error->all(FLERR, "{} can be {} one region, got {} as well: a union", caller,
               within ? "inside" : "outside", word.text());
  filter = word.text();
  return true;
}

bool PlacementArguments::parse_of_wall(KeywordReader &word)
{
  if (word.is("write", "FILE")) {
    write = word.text();
    return true;
  }
  if (!word.is("zone", "REGION TYPE")) return false;
  const std::string of = fmt::format("{} zone {} ", caller, word.text(1));
  Zone zone = {word.text(1), atom_type_argument(lmp, of + "type", word.text(2)), 0.0};
  if (word.value_follows()) {
    word.more("S");
    zone.spacing = positive_argument(lmp, of + "spacing", word.text(3));
  }
  zones.push_back(zone);
  return true;
}

// what the scattered pattern needs: it has no direction, and no closers

void PlacementArguments::check_pattern() const
{
  if (angle != 0.0)
    error->all(FLERR,
               "{} angle must be 0 with pattern scattered, which has no direction, got {:.6g}",
               caller, angle * 180.0 / Slope::PI);
  const double most = Slope::ScatteredSampler::WIDEST * 0.5 * (diameter + smallest);
  const auto check = [&](const std::string &of, double value) {
    if (value > most * (1.0 + 1.0e-9))
      error->all(FLERR,
                 "{}{} spacing must be <= {:.6g} with pattern scattered, {} of the distance at "
                 "which a ball "
                 "of diameter {} touches, or it finds a way through, got {}",
                 caller, of, most, Slope::ScatteredSampler::WIDEST, smallest, value);
  };
  check("", spacing);
  for (const Zone &zone : zones) check(" zone " + zone.region, zone.spacing);
}

void PlacementArguments::check_zones()
{
  for (Zone &zone : zones) {
    if (zone.spacing == 0.0) zone.spacing = spacing;
    if (zone.spacing != spacing && !scattered)
      error->all(FLERR, "{} zone {} spacing needs pattern scattered, got {}", caller, zone.region,
                 region.empty() ? "a file" : "a plan grid");
  }
}

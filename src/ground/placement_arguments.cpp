/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "placement_arguments.h"

#include "atom.h"
#include "constants.h"
#include "error.h"
#include "region_surface.h"
#include "scattered_sampler.h"
#include "style_argument.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

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

void PlacementArguments::need(int n, const char *values, int narg, char **arg) const
{
  if (n >= narg)
    error->all(FLERR, "{} {} must be followed by {}, got {} of {} values", caller, arg[0], values,
               narg - 1, n);
}

double PlacementArguments::number(const char *what, int narg, char **arg) const
{
  need(1, what, narg, arg);
  return number_argument(lmp, fmt::format("{} {}", caller, arg[0]), arg[1]);
}

void PlacementArguments::parse(int narg, char **arg, bool of_wall)
{
  if (narg < 1) error->all(FLERR, "{} needs surface or file, got neither", caller);
  int iarg;
  if (strcmp(arg[0], "surface") == 0) {
    need(2, "REGION upper|lower", narg, arg);
    region = arg[1];
    if (strcmp(arg[2], "upper") == 0)
      side = RegionSurface::UPPER;
    else if (strcmp(arg[2], "lower") == 0)
      side = RegionSurface::LOWER;
    else
      error->all(FLERR, "{} surface side must be upper or lower, got {}", caller, arg[2]);
    iarg = 3;
  } else if (strcmp(arg[0], "file") == 0) {
    need(1, "FILE", narg, arg);
    file = arg[1];
    iarg = 2;
  } else {
    error->all(FLERR, "{} needs {}, got {}", caller,
               of_wall ? "surface or file" : "surface, file or fill", arg[0]);
  }

  while (iarg < narg) {
    int n = region.empty() ? 0 : parse_surface(narg - iarg, &arg[iarg]);
    if (n == 0) n = parse_any(narg - iarg, &arg[iarg], of_wall);
    if (n == 0)
      error->all(FLERR, "{} keyword must be {}inside{}, got {}", caller,
                 region.empty() ? "" : "spacing, origin, pattern, angle, sink, sunk, smallest, ",
                 of_wall ? ", outside, zone or write" : " or outside", arg[iarg]);
    iarg += n;
  }
  if (!region.empty() && spacing == 0.0)
    error->all(FLERR, "{} surface needs a spacing, got none", caller);
  if (outside_sink >= 0.0 && outside.empty())
    error->all(FLERR, "{} sunk needs outside REGION, got none", caller);
}

// keywords of a surface: how many words one takes, 0 if it is none of them

int PlacementArguments::parse_surface(int narg, char **arg)
{
  if (strcmp(arg[0], "spacing") == 0) {
    spacing = number("S", narg, arg);
    if (spacing <= 0.0) error->all(FLERR, "{} spacing must be > 0, got {}", caller, arg[1]);
  } else if (strcmp(arg[0], "sink") == 0) {
    sink = number("H", narg, arg);
    check_sink(sink, arg);
  } else if (strcmp(arg[0], "sunk") == 0) {
    outside_sink = number("H", narg, arg);
    check_sink(outside_sink, arg);
  } else if (strcmp(arg[0], "rim") == 0) {
    error->all(
        FLERR, "{} rim is no keyword any more, got {}: {}", caller, narg > 1 ? arg[1] : "rim",
        "ground and slip surface are one surface now; make the site anew, slope site FOLDER");
  } else if (strcmp(arg[0], "smallest") == 0) {
    smallest = number("D", narg, arg);
    if (smallest <= 0.0) error->all(FLERR, "{} smallest must be > 0, got {}", caller, arg[1]);
  } else if (strcmp(arg[0], "angle") == 0) {
    angle = number("DEG", narg, arg) * Slope::PI / 180.0;
    if (std::fabs(angle) > 2.0 * Slope::PI)
      error->all(FLERR, "{} angle must be within +-360 (degrees), got {}", caller, arg[1]);
  } else if (strcmp(arg[0], "pattern") == 0) {
    return parse_pattern(narg, arg);
  } else if (strcmp(arg[0], "origin") == 0) {
    need(2, "x y", narg, arg);
    for (int d = 0; d < 2; d++) {
      const char *text = arg[1 + d];
      origin[d] = number_argument(lmp, fmt::format("{} origin {}", caller, "xy"[d]), text);
      if (std::fabs(origin[d]) > FARTHEST)
        error->all(FLERR, "{} origin {} must be within +-{:g}, got {}", caller, "xy"[d], FARTHEST,
                   text);
    }
    return 3;
  } else {
    return 0;
  }
  return 2;
}

int PlacementArguments::parse_pattern(int narg, char **arg)
{
  need(1, "grid or scattered", narg, arg);
  scattered = strcmp(arg[1], "scattered") == 0;
  if (!scattered && strcmp(arg[1], "grid") != 0)
    error->all(FLERR, "{} pattern must be grid or scattered, got {}", caller, arg[1]);
  double number;
  if (!scattered || narg < 3 || !Slope::read_number(arg[2], number)) return 2;
  seed = whole_number_argument(lmp, fmt::format("{} pattern scattered SEED", caller), arg[2]);
  if (seed < 1) error->all(FLERR, "{} pattern scattered SEED must be > 0, got {}", caller, arg[2]);
  return 3;
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

void PlacementArguments::check_sink(double value, char **arg) const
{
  const double least = LEAST_SINK * diameter;
  if (value != 0.0 && !(value >= least))
    error->all(FLERR, "{} {} must be 0 or at least {:.6g} ({} diameters), got {}", caller, arg[0],
               least, LEAST_SINK, arg[1]);
}

int PlacementArguments::parse_any(int narg, char **arg, bool of_wall)
{
  const bool within = strcmp(arg[0], "inside") == 0;
  if (within || strcmp(arg[0], "outside") == 0) {
    need(1, "REGION", narg, arg);
    std::string &filter = within ? inside : outside;
    if (!filter.empty())
      error->all(FLERR, "{} can be {} one region, got {} as well: a union", caller, arg[0], arg[1]);
    filter = arg[1];
  } else if (strcmp(arg[0], "write") == 0 && of_wall) {
    need(1, "FILE", narg, arg);
    write = arg[1];
  } else if (strcmp(arg[0], "zone") == 0 && of_wall) {
    return parse_zone(narg, arg);
  } else {
    return 0;
  }
  return 2;
}

/* ----------------------------------------------------------------------
   zone REGION TYPE [S]
------------------------------------------------------------------------- */

int PlacementArguments::parse_zone(int narg, char **arg)
{
  need(2, "REGION TYPE [S]", narg, arg);
  const std::string of = fmt::format("{} zone {}", caller, arg[1]);
  Zone zone = {arg[1], whole_number_argument(lmp, of + " type", arg[2]), 0.0};
  if (zone.type < 1 || zone.type > atom->ntypes)
    error->all(FLERR, "{} type must be 1 to {} (the atom types of the box), got {}", of,
               atom->ntypes, arg[2]);
  const bool has_spacing = narg > 3 && Slope::read_number(arg[3], zone.spacing);
  if (has_spacing) zone.spacing = number_argument(lmp, of + " spacing", arg[3]);
  if (has_spacing && zone.spacing <= 0.0)
    error->all(FLERR, "{} spacing must be > 0, got {}", of, arg[3]);
  zones.push_back(zone);
  return has_spacing ? 4 : 3;
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

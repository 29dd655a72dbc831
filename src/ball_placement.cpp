/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_placement.h"

#include "atom.h"
#include "atomic_file.h"
#include "comm.h"
#include "error.h"
#include "fix_wall_gran_balls.h"
#include "lammps_compat.h"
#include "rank_zero.h"
#include "region_surface.h"
#include "style_argument.h"
#include "sunk_region.h"
#include "surface_sampler.h"
#include "tokenizer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>

using namespace LAMMPS_NS;

static constexpr double MAX_BALLS = 2147483647.0;

// a column is searched in steps of this times the diameter: thinner soil holds no ball
static constexpr double SEARCH_STEP = 0.125;
static constexpr double LEAST_SINK = 0.05;    // in diameters: the closer, the more columns it takes

/* ---------------------------------------------------------------------- */

BallPlacement::BallPlacement(LAMMPS *lmp, const std::string &caller_in, double diameter_in,
                             double smallest_in, int narg, char **arg, bool may_write) :
    Pointers(lmp),
    smallest(smallest_in), caller(caller_in), diameter(diameter_in), side(RegionSurface::UPPER),
    spacing(0.0), origin{0.0, 0.0}, filter_inside(true), sink(0.0), filter_sink(-1.0)
{
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    error->all(FLERR, "{} diameter must be > 0, got {}", caller, diameter);
  parse(narg, arg, may_write);
  if (region.empty())
    smallest = 0.0;
  else if (!(smallest > 0.0 && smallest < diameter))
    smallest = diameter;

  const double step = SEARCH_STEP * diameter;
  if (!filter.empty())
    columns.reset(new RegionSurface(lmp, caller, filter.c_str(), RegionSurface::LOWER, step));
  if (!region.empty()) {
    surface.reset(new RegionSurface(lmp, caller, region.c_str(), side, step));
    if (!surface->has_boundary())
      error->all(FLERR, "{} region {} must have a{} boundary, got INF", caller, region,
                 side == RegionSurface::LOWER ? " lower" : "n upper");
    find_bodies();
  }

  on_rank_zero(lmp, caller, [this]() {
    if (region.empty())
      read_file();
    else
      place_on_surface();
  });
  share();
  if (xyz.empty())
    error->all(FLERR, "{}: {} holds no balls", caller,
               region.empty() ? "file " + file : "the surface of region " + region);
  if (comm->me == 0) utils::logmesg(lmp, "{}\n", summary);
  if (!write.empty())
    on_rank_zero(lmp, caller, [this]() {
      write_file();
    });
}

BallPlacement::~BallPlacement() = default;

double BallPlacement::smallest_ball(LAMMPS *lmp, int groupbit)
{
  const Atom *atom = lmp->atom;
  if (!atom->radius_flag) return 0.0;
  double mine = HUGE_VAL, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) mine = std::min(mine, 2.0 * atom->radius[i]);
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MIN, lmp->world);
  return all < HUGE_VAL ? all : 0.0;
}

/* ----------------------------------------------------------------------
   arguments
------------------------------------------------------------------------- */

void BallPlacement::need(int n, const char *values, int narg, char **arg) const
{
  if (n >= narg)
    error->all(FLERR, "{} {} must be followed by {}, got {} of {} values", caller, arg[0], values,
               narg - 1, n);
}

double BallPlacement::number(const char *what, int narg, char **arg) const
{
  need(1, what, narg, arg);
  return number_argument(lmp, fmt::format("{} {}", caller, arg[0]), arg[1]);
}

void BallPlacement::parse(int narg, char **arg, bool may_write)
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
    error->all(FLERR, "{} needs surface or file, got {}", caller, arg[0]);
  }

  while (iarg < narg) {
    int n = region.empty() ? 0 : parse_surface(narg - iarg, &arg[iarg]);
    if (n == 0) n = parse_any(narg - iarg, &arg[iarg], may_write);
    if (n == 0)
      error->all(FLERR, "{} keyword must be {}inside{}, got {}", caller,
                 region.empty() ? "" : "spacing, origin, sink, sunk, smallest, ",
                 may_write ? ", outside or write" : " or outside", arg[iarg]);
    iarg += n;
  }
  if (!region.empty() && spacing == 0.0)
    error->all(FLERR, "{} surface needs a spacing, got none", caller);
  if (filter_sink >= 0.0 && (filter.empty() || filter_inside))
    error->all(FLERR, "{} sunk needs outside REGION, got none", caller);
}

// keywords of a surface: how many words one takes, 0 if it is none of them

int BallPlacement::parse_surface(int narg, char **arg)
{
  if (strcmp(arg[0], "spacing") == 0) {
    spacing = number("S", narg, arg);
    if (spacing <= 0.0) error->all(FLERR, "{} spacing must be > 0, got {}", caller, arg[1]);
  } else if (strcmp(arg[0], "sink") == 0) {
    sink = number("H", narg, arg);
    check_sink(sink, arg);
  } else if (strcmp(arg[0], "sunk") == 0) {
    filter_sink = number("H", narg, arg);
    check_sink(filter_sink, arg);
  } else if (strcmp(arg[0], "smallest") == 0) {
    smallest = number("D", narg, arg);
    if (smallest <= 0.0) error->all(FLERR, "{} smallest must be > 0, got {}", caller, arg[1]);
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

void BallPlacement::check_sink(double value, char **arg) const
{
  const double least = LEAST_SINK * diameter;
  if (value != 0.0 && !(value >= least))
    error->all(FLERR, "{} {} must be 0 or at least {:.6g} ({} diameters), got {}", caller, arg[0],
               least, LEAST_SINK, arg[1]);
}

int BallPlacement::parse_any(int narg, char **arg, bool may_write)
{
  const bool inside = strcmp(arg[0], "inside") == 0;
  if (inside || strcmp(arg[0], "outside") == 0) {
    need(1, "REGION", narg, arg);
    if (!filter.empty())
      error->all(FLERR, "{} can have one filter (inside or outside), got {} {} as well", caller,
                 arg[0], arg[1]);
    filter_inside = inside;
    filter = arg[1];
  } else if (strcmp(arg[0], "write") == 0 && may_write) {
    need(1, "FILE", narg, arg);
    write = arg[1];
  } else {
    return 0;
  }
  return 2;
}

/* ----------------------------------------------------------------------
   the bodies of sunk balls: the one that lies on these, and those that the filter leaves out
------------------------------------------------------------------------- */

void BallPlacement::find_bodies()
{
  if (sink > 0.0) sunk = std::make_shared<SunkRegion>(lmp, caller, region, side, sink, diameter);

  const auto others = compat::fixes_of_style(lmp, "wall/gran/balls");
  if (sunk && side == RegionSurface::LOWER)
    for (Fix *fix : others) {
      const std::string &left_out = static_cast<FixWallGranBalls *>(fix)->left_out();
      if (left_out.empty() || !compat::find_region(lmp, left_out)) continue;
      const RegionSurface its(lmp, caller, left_out.c_str(), RegionSurface::LOWER,
                              SEARCH_STEP * diameter);
      if (left_out == region || sunk->lies_in(its))
        error->all(
            FLERR,
            "{} sink must come before fix {}, which is outside region {}: define that after this",
            caller, fix->id, left_out);
    }

  if (filter.empty() || filter_inside) return;
  if (filter_sink < 0.0) {
    outside = filter;
    for (Fix *fix : others) {
      const Sunk body = static_cast<FixWallGranBalls *>(fix)->body();
      if (body && (body->region == filter || body->lies_in(*columns))) bodies.push_back(body);
    }
  } else if (filter_sink > 0.0) {
    if (!columns->has_boundary())
      error->all(FLERR, "{} sunk region {} must have a lower boundary, got INF", caller, filter);
    bodies.push_back(std::make_shared<SunkRegion>(lmp, caller, filter, RegionSurface::LOWER,
                                                  filter_sink, diameter));
  }
}

void BallPlacement::share()
{
  bigint size = xyz.size();
  MPI_Bcast(&size, 1, MPI_LMP_BIGINT, 0, world);
  xyz.resize(size);
  const bigint most = 1 << 28;    // MPI counts in int
  for (bigint done = 0; done < size; done += most)
    MPI_Bcast(&xyz[done], static_cast<int>(std::min(most, size - done)), MPI_DOUBLE, 0, world);
}

/* ----------------------------------------------------------------------
   balls on a plan grid, and more where the surface is steep
------------------------------------------------------------------------- */

// Columns of the filter's region, and of the sunk surface below it where the balls would be above it.
// A sunk surface reaches farther than its body.

bool BallPlacement::height(double x, double y, double &z) const
{
  return sunk ? sunk->height(x, y, z) : surface->height(x, y, z);
}

bool BallPlacement::keep(double x, double y) const
{
  double z, bottom;
  for (const Sunk &body : bodies)
    if (body->centre(x, y, bottom) && height(x, y, z) && bottom < z) return false;
  if (!columns || (bodies.size() == 1 && bodies[0]->region == filter)) return true;
  return columns->height(x, y, z) == filter_inside;
}

bool BallPlacement::scar(double x, double y, double &z) const
{
  double top, bottom;
  z = HUGE_VAL;
  if (!height(x, y, top)) return false;
  for (const Sunk &body : bodies)
    if (body->centre(x, y, bottom) && bottom < top) z = std::min(z, bottom);

  // a prism without a bottom leaves no scar, it only selects

  if (columns->has_boundary() && columns->height(x, y, bottom)) z = std::min(z, bottom);
  return z < HUGE_VAL;
}

void BallPlacement::check_floor() const
{
  const double most = sunk->lowest() + sink - sunk->floor();
  if (sink < most) return;
  const bool of_region = side == RegionSurface::UPPER || !sunk->ground.empty();
  throw std::runtime_error(fmt::format(
      "sink must be < {:.6g}, so that the balls lie above the bottom of {}, got {}", most,
      of_region ? "region " + (sunk->ground.empty() ? region : sunk->ground) : "the simulation box",
      sink));
}

void BallPlacement::place_on_surface()
{
  for (const Sunk &body : bodies) body->build();
  Slope::PlanGrid grid = {surface->xlo, surface->xhi, surface->ylo, surface->yhi,
                          spacing,      origin[0],    origin[1]};
  if (!(grid.xlo <= grid.xhi && grid.ylo <= grid.yhi)) return;    // an empty intersection
  if (sunk) {
    sunk->build();
    sunk->plan(grid.xlo, grid.xhi, grid.ylo, grid.yhi);
    check_floor();
  }
  if (!(Slope::plan_nodes(grid) < MAX_BALLS))
    throw std::runtime_error(
        fmt::format("spacing must give fewer than 2^31 balls, got {:.3g} with {}",
                    Slope::plan_nodes(grid), spacing));

  // How far a point of the surface may be from the nearest ball, from the plan grid alone on
  // level ground, with extra balls where it is steep. The smallest ball touches one whose centre is
  // contact away: what is said of equal balls holds with half of that for their radius.

  const double contact = 0.5 * (diameter + smallest), half = 0.5 * contact;
  const bool leaks = spacing / std::sqrt(2.0) >= contact;
  const double steep = Slope::cover_radius(spacing, half) + Slope::sampling_slack(half);
  if (leaks || steep >= contact)
    error->warning(FLERR,
                   "{} spacing {} lets a ball of diameter {} through {}: spacing must be < {:.4g}",
                   caller, spacing, smallest, leaks ? "even on level ground" : "on steep ground",
                   contact * (leaks ? std::sqrt(2.0) : 1.299));

  Slope::Surface ground;
  ground.height = [this](double x, double y, double &z) {
    return height(x, y, z);
  };
  if (columns) {
    ground.keep = [this](double x, double y) {
      return keep(x, y);
    };

    // what lies outside of a region borders on the scar that it leaves

    if (!filter_inside && (columns->has_boundary() || !bodies.empty()))
      ground.scar = [this](double x, double y, double &z) {
        return scar(x, y, z);
      };
  }

  Slope::SurfaceBalls balls = Slope::sample_surface(grid, half, ground);
  xyz.swap(balls.xyz);

  summary =
      fmt::format("{}: {} fixed balls of diameter {} ({} on the plan grid every {}, {} extra "
                  "where the surface is steep or ends",
                  caller, balls.base + balls.extra, diameter, balls.base, spacing, balls.extra);
  if (balls.without_surface)
    summary += fmt::format(", {} plan nodes without surface", balls.without_surface);
  if (columns)
    summary += fmt::format(", {} plan nodes not {} region {}", balls.dropped,
                           filter_inside ? "inside" : "outside", filter);
  for (size_t k = 0; k < bodies.size(); k++)
    summary += fmt::format("{} sunk by {}", k ? "," : "", bodies[k]->sink);
  if (sunk) {
    summary += fmt::format(", sunk by {}", sink);
    if (!sunk->ground.empty()) summary += " and continued up to region " + sunk->ground;
  }
  if (smallest < diameter) summary += fmt::format(", tight for balls of diameter {}", smallest);
  summary += ")";
}

/* ----------------------------------------------------------------------
   file of positions: x y z per line, # starts a comment
------------------------------------------------------------------------- */

void BallPlacement::read_file()
{
  std::ifstream in(file);
  if (!in)
    throw std::runtime_error(fmt::format("cannot open file {}: {}", file, utils::getsyserror()));

  bigint dropped = 0;
  std::string line;
  for (int nline = 1; std::getline(in, line); nline++) {
    const std::string where = fmt::format("file {} line {}: ", file, nline);
    const auto words = Tokenizer(line.substr(0, line.find('#'))).as_vector();
    if (words.empty()) continue;
    if (words.size() != 3)
      throw std::runtime_error(
          fmt::format("{}must hold x y z, got {} values", where, words.size()));

    double x[3];
    for (int d = 0; d < 3; d++) {
      // not LAMMPS' own, which ends all ranks and is called by one here
      x[d] = utils::is_double(words[d]) ? strtod(words[d].c_str(), nullptr) : NAN;
      if (!std::isfinite(x[d]))
        throw std::runtime_error(
            fmt::format("{}{} must be a finite number, got {}", where, "xyz"[d], words[d]));
      if (std::fabs(x[d]) > FARTHEST)
        throw std::runtime_error(
            fmt::format("{}{} must be within +-{:g}, got {}", where, "xyz"[d], FARTHEST, words[d]));
    }
    if (keep(x[0], x[1]))
      xyz.insert(xyz.end(), x, x + 3);
    else
      dropped++;
    if (xyz.size() / 3 > MAX_BALLS)
      throw std::runtime_error(where + "must be fewer than 2^31 balls, got more");
  }
  if (in.bad())
    throw std::runtime_error(fmt::format("cannot read file {}: {}", file, utils::getsyserror()));

  summary = fmt::format("{}: {} fixed balls of diameter {} (from file {}", caller, xyz.size() / 3,
                        diameter, file);
  if (columns)
    summary +=
        fmt::format(", {} not {} region {}", dropped, filter_inside ? "inside" : "outside", filter);
  summary += ")";
}

/* ----------------------------------------------------------------------
   the same kind of file
------------------------------------------------------------------------- */

void BallPlacement::write_file()
{
  Slope::AtomicFile out(write);
  out.write(fmt::format("# {}: {} fixed balls of diameter {}, units {}\n# x y z\n", caller,
                        xyz.size() / 3, diameter, update->unit_style));
  for (size_t k = 0; k < xyz.size(); k += 3)
    out.write(fmt::format("{:.15g} {:.15g} {:.15g}\n", xyz[k], xyz[k + 1], xyz[k + 2]));
  out.commit();
}

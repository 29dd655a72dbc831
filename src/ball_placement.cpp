/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_placement.h"

#include "atomic_file.h"
#include "comm.h"
#include "error.h"
#include "rank_zero.h"
#include "region_surface.h"
#include "style_argument.h"
#include "surface_sampler.h"
#include "tokenizer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>

using namespace LAMMPS_NS;

static constexpr double MAX_BALLS = 2147483647.0;

// a column is searched in steps of this times the diameter: thinner soil holds no ball
static constexpr double SEARCH_STEP = 0.125;

/* ---------------------------------------------------------------------- */

BallPlacement::BallPlacement(LAMMPS *lmp, const std::string &caller_in, double diameter_in,
                             int narg, char **arg, bool may_write) :
    Pointers(lmp),
    caller(caller_in), diameter(diameter_in), side(RegionSurface::UPPER),
    spacing(0.0), origin{0.0, 0.0}, filter_inside(true)
{
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    error->all(FLERR, "{} diameter must be > 0, got {}", caller, diameter);
  parse(narg, arg, may_write);

  const double step = SEARCH_STEP * diameter;
  if (!filter.empty())
    columns.reset(new RegionSurface(lmp, caller, filter.c_str(), RegionSurface::LOWER, step));
  if (!region.empty()) {
    surface.reset(new RegionSurface(lmp, caller, region.c_str(), side, step));
    if (!surface->has_boundary())
      error->all(FLERR, "{} region {} must have a{} boundary, got INF", caller, region,
                 side == RegionSurface::LOWER ? " lower" : "n upper");
  }

  on_rank_zero(lmp, caller, [this]() {
    if (region.empty()) read_file();
    else place_on_surface();
  });
  share();
  if (xyz.empty())
    error->all(FLERR, "{}: {} holds no balls", caller,
               region.empty() ? "file " + file : "the surface of region " + region);
  if (comm->me == 0) utils::logmesg(lmp, "{}\n", summary);
  if (!write.empty()) on_rank_zero(lmp, caller, [this]() { write_file(); });
}

BallPlacement::~BallPlacement() = default;

/* ----------------------------------------------------------------------
   arguments
------------------------------------------------------------------------- */

void BallPlacement::parse(int narg, char **arg, bool may_write)
{
  auto need = [&](int iarg, int n, const char *values) {
    if (iarg + n >= narg)
      error->all(FLERR, "{} {} must be followed by {}, got {} of {} values", caller, arg[iarg],
                 values, narg - iarg - 1, n);
  };

  if (narg < 1) error->all(FLERR, "{} needs surface or file, got neither", caller);
  int iarg;
  if (strcmp(arg[0], "surface") == 0) {
    need(0, 2, "REGION upper|lower");
    region = arg[1];
    if (strcmp(arg[2], "upper") == 0)
      side = RegionSurface::UPPER;
    else if (strcmp(arg[2], "lower") == 0)
      side = RegionSurface::LOWER;
    else
      error->all(FLERR, "{} surface side must be upper or lower, got {}", caller, arg[2]);
    iarg = 3;
  } else if (strcmp(arg[0], "file") == 0) {
    need(0, 1, "FILE");
    file = arg[1];
    iarg = 2;
  } else {
    error->all(FLERR, "{} needs surface or file, got {}", caller, arg[0]);
  }

  while (iarg < narg) {
    if (strcmp(arg[iarg], "spacing") == 0 && !region.empty()) {
      need(iarg, 1, "S");
      spacing = number_argument(lmp, caller + " spacing", arg[iarg + 1]);
      if (spacing <= 0.0)
        error->all(FLERR, "{} spacing must be > 0, got {}", caller, arg[iarg + 1]);
      iarg += 2;
    } else if (strcmp(arg[iarg], "origin") == 0 && !region.empty()) {
      need(iarg, 2, "x y");
      for (int d = 0; d < 2; d++) {
        const char *text = arg[iarg + 1 + d];
        origin[d] = number_argument(lmp, fmt::format("{} origin {}", caller, "xy"[d]), text);
        if (std::fabs(origin[d]) > FARTHEST)
          error->all(FLERR, "{} origin {} must be within +-{:g}, got {}", caller, "xy"[d], FARTHEST,
                     text);
      }
      iarg += 3;
    } else if (strcmp(arg[iarg], "inside") == 0 || strcmp(arg[iarg], "outside") == 0) {
      need(iarg, 1, "REGION");
      if (!filter.empty())
        error->all(FLERR, "{} can have one filter (inside or outside), got {} {} as well", caller,
                   arg[iarg], arg[iarg + 1]);
      filter_inside = strcmp(arg[iarg], "inside") == 0;
      filter = arg[iarg + 1];
      iarg += 2;
    } else if (strcmp(arg[iarg], "write") == 0 && may_write) {
      need(iarg, 1, "FILE");
      write = arg[iarg + 1];
      iarg += 2;
    } else {
      error->all(FLERR, "{} keyword must be {}inside{}, got {}", caller,
                 region.empty() ? "" : "spacing, origin, ",
                 may_write ? ", outside or write" : " or outside", arg[iarg]);
    }
  }
  if (!region.empty() && spacing == 0.0)
    error->all(FLERR, "{} surface needs a spacing, got none", caller);
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

bool BallPlacement::keep(double x, double y) const
{
  double z;
  return !columns || columns->height(x, y, z) == filter_inside;
}

void BallPlacement::place_on_surface()
{
  const double radius = 0.5 * diameter;
  const Slope::PlanGrid grid = {surface->xlo, surface->xhi, surface->ylo, surface->yhi,
                                spacing,      origin[0],    origin[1]};
  if (!(grid.xlo <= grid.xhi && grid.ylo <= grid.yhi)) return;    // an empty intersection
  if (!(Slope::plan_nodes(grid) < MAX_BALLS))
    throw std::runtime_error(
        fmt::format("spacing must give fewer than 2^31 balls, got {:.3g} with {}",
                    Slope::plan_nodes(grid), spacing));

  // how far a point of the surface may be from the nearest ball, from the plan grid alone on
  // level ground, with extra balls where it is steep

  const bool leaks = spacing / std::sqrt(2.0) >= diameter;
  const double steep = Slope::cover_radius(spacing, radius) + Slope::sampling_slack(radius);
  if (leaks || steep >= diameter)
    error->warning(FLERR,
                   "{} spacing {} lets a ball of diameter {} through {}: spacing must be < {:.4g}",
                   caller, spacing, diameter, leaks ? "even on level ground" : "on steep ground",
                   diameter * (leaks ? std::sqrt(2.0) : 1.299));

  Slope::Surface ground;
  ground.height = [this](double x, double y, double &z) {
    return surface->height(x, y, z);
  };
  if (columns) {
    ground.keep = [this](double x, double y) {
      return keep(x, y);
    };

    // what lies outside of a region borders on the scar that it leaves; a prism without a
    // bottom leaves none, it only selects

    if (!filter_inside && columns->has_boundary())
      ground.scar = [this](double x, double y, double &z) {
        return columns->height(x, y, z);
      };
  }

  Slope::SurfaceBalls balls = Slope::sample_surface(grid, radius, ground);
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
      const bool good = utils::is_double(words[d]);
      x[d] = good ? utils::numeric(FLERR, words[d].c_str(), false, lmp) : NAN;
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

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_release.h"

#include "body_volume.h"
#include "constants.h"
#include "deposit_balls.h"
#include "deposit_exchange.h"
#include "deposit_ground.h"
#include "deposit_options.h"
#include "lammps_compat.h"
#include "region_columns.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

using namespace LAMMPS_NS;
using Slope::BodyVolume;

static constexpr double UNBOUNDED = 1.0e19;          // LAMMPS writes INF as 1e20
static constexpr double ASTRAY = 0.05;               // of the balls may lie far from the body
static constexpr double LEAST = 1.0, MOST = 10.0;    // bulk factor: volume of a body / of its balls

static constexpr int COARSE = 1000, FINE = 1400;    // columns along the longer side
static constexpr double SAME = 1.0e-3;              // two sums of such columns

enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

DepositRelease::DepositRelease(LAMMPS *lmp, DepositBalls &balls_in,
                               const DepositOptions &options_in) :
    Pointers(lmp),
    balls(balls_in), options(options_in)
{
}

/* ---------------------------------------------------------------------- */

DepositRelease::Released DepositRelease::find()
{
  Released found = {find_mass(), 0.0, 0.0, 0.0};
  DepositGround(lmp, options.terrain).check(balls);
  if (!options.body.empty()) {
    found.body = body_volume(found.mass);
    balls.set_bulk(found.body / found.mass.solid);
  }
  double z;
  found.volume = balls.volume();
  balls.farthest(found.mass.top, found.front, z);
  return found;
}

/* ---------------------------------------------------------------------- */

void DepositRelease::log(const std::string &fix_id, const Released &released) const
{
  if (comm->me != 0) return;
  const Slope::PlanGrid &grid = options.grid;
  std::string factor = fmt::format("{:.6g}", balls.bulk());
  if (!options.body.empty())
    factor += fmt::format(" = region {} {:.10g} / balls {:.10g}, {:+.1f} % from 6/pi", options.body,
                          released.body, released.mass.solid,
                          100.0 * (balls.bulk() / Slope::SIMPLE_CUBIC - 1.0));
  utils::logmesg(lmp,
                 "Fix deposit/grid {}: {:.0f} balls released, bulk volume {:.10g}; {} x {} cells "
                 "of {:g}\n"
                 "Fix deposit/grid {}: bulk factor {}\n",
                 fix_id, released.mass.number, released.volume, grid.n[X], grid.n[Y], grid.cell,
                 fix_id, factor);
}

/* ---------------------------------------------------------------------- */

DepositRelease::Mass DepositRelease::find_mass() const
{
  struct Top {
    double x[3], tag;
    bool below(const Top &other) const
    {
      return x[Z] < other.x[Z] || (x[Z] == other.x[Z] && tag > other.tag);
    }
  } top = {{0.0, 0.0, -HUGE_VAL}, 0.0};

  double mine[5] = {0.0, 0.0, 0.0, 0.0, 0.0}, all[5];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!balls.selected(i)) continue;
    Top ball;
    balls.unwrap(i, ball.x);
    ball.tag = atom->tag[i];
    if (top.below(ball)) top = ball;
    const double m = atom->rmass[i], d = 2.0 * atom->radius[i];
    const double add[5] = {1.0, Slope::PI / 6.0 * d * d * d, m, m * ball.x[X], m * ball.x[Y]};
    for (int k = 0; k < 5; k++) mine[k] += add[k];
  }
  MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_SUM, world);
  if (all[0] == 0.0)
    error->all(FLERR,
               "Fix deposit/grid group must hold balls when the run starts, got none: its region "
               "or lattice made no ball");

  DepositExchange exchange(lmp);
  const double zmax = -exchange.smallest(-top.x[Z]);
  const int rank = exchange.rank_of_smallest(top.x[Z] == zmax ? top.tag : HUGE_VAL);
  MPI_Bcast(&top, 4, MPI_DOUBLE, std::max(0, rank), world);
  return {all[0], all[1], all[3] / all[2], all[4] / all[2], {top.x[X], top.x[Y], top.x[Z]}};
}

/* ---------------------------------------------------------------------- */

double DepositRelease::body_volume(const Mass &mass) const
{
  Region *region = body();
  const std::string &id = options.body;
  double volume = 0.0;
  std::string problem;
  try {
    volume = integrate(region);
  } catch (std::runtime_error &e) {    // the same on all ranks
    problem = e.what();
  }
  if (!problem.empty()) error->all(FLERR, "Fix deposit/grid bulk region {}: {}", id, problem);
  if (volume == 0.0)
    error->all(FLERR, "Fix deposit/grid bulk region {} must have a volume > 0, got 0: it is empty",
               id);
  check_balls(region, mass);
  if (!(volume >= LEAST * mass.solid && volume <= MOST * mass.solid))
    error->all(
        FLERR,
        "Fix deposit/grid bulk region {} must be the body that the balls fill, of {:g} to {:g} "
        "times their volume {:.6g}, got {:.6g}",
        id, LEAST, MOST, mass.solid, volume);
  return volume;
}

/* ---------------------------------------------------------------------- */

Region *DepositRelease::body() const
{
  const std::string &id = options.body;
  Region *region = compat::find_region(lmp, id);
  if (!region) error->all(FLERR, "Fix deposit/grid bulk region {} does not exist", id);
  region->init();
  if (region->dynamic_check())
    error->all(FLERR, "Fix deposit/grid bulk region {} must not move, got one that moves or varies",
               id);
  if (region->openflag)
    error->all(FLERR, "Fix deposit/grid bulk region {} must have no open faces, got some", id);

  const double ends[6] = {region->extent_xlo, region->extent_xhi, region->extent_ylo,
                          region->extent_yhi, region->extent_zlo, region->extent_zhi};
  bool bounded = region->bboxflag;
  for (const double end : ends) bounded = bounded && std::fabs(end) < UNBOUNDED;
  if (!bounded)
    error->all(
        FLERR,
        "Fix deposit/grid bulk region {} must be bounded on all sides, got one without an end "
        "(the body is the intersection of ground and slip surface)",
        id);
  return region;
}

/* ---------------------------------------------------------------------- */

double DepositRelease::integrate(Region *region) const
{
  const BodyVolume::Box box = {{region->extent_xlo, region->extent_ylo, region->extent_zlo},
                               {region->extent_xhi, region->extent_yhi, region->extent_zhi}};
  auto inside = [region](double x, double y, double z) {
    return region->match(x, y, z) != 0;
  };
  auto sum = [this](std::vector<double> &values) {
    std::vector<double> mine = values;
    MPI_Allreduce(mine.data(), values.data(), (int) values.size(), MPI_DOUBLE, MPI_SUM, world);
  };
  BodyVolume body(box, inside, {comm->me, comm->nprocs, sum});
  for (int i = 0; i < atom->nlocal; i++)
    if (balls.selected(i)) body.mark(atom->x[i][X], atom->x[i][Y]);
  try {
    return body.volume();
  } catch (std::runtime_error &) {
    // thin bodies in many parts, whose pieces a search misses: exactly, if the shapes are known
    const std::unique_ptr<RegionColumns> columns = RegionColumns::of(lmp, region);
    if (!columns) throw;
    const double coarse = by_columns(*columns, region, COARSE);
    const double fine = by_columns(*columns, region, FINE);
    if (!(std::fabs(fine - coarse) <= SAME * fine)) throw;
    return fine;
  }
}

/* ----------------------------------------------------------------------
   volume by a column in each of square cells, so many along the longer side, at places that repeat no
   grid; the same on any number of ranks
------------------------------------------------------------------------- */

double DepositRelease::by_columns(const RegionColumns &columns, const Region *region,
                                  int most) const
{
  const double length_x = region->extent_xhi - region->extent_xlo;
  const double length_y = region->extent_yhi - region->extent_ylo;
  const double cell = std::max(length_x, length_y) / most;
  const int nx = static_cast<int>(std::ceil(length_x / cell));
  const int ny = static_cast<int>(std::ceil(length_y / cell));
  std::vector<double> mine(ny, 0.0), rows(ny);
  Slope::Intervals found;
  for (int j = comm->me; j < ny; j += comm->nprocs)
    for (int i = 0; i < nx; i++) {
      const double k = static_cast<double>(j) * nx + i + 1.0;
      const double u = std::fmod(k * 0.7548776662466927, 1.0);
      const double v = std::fmod(k * 0.5698402909980532, 1.0);
      columns.column(region->extent_xlo + (i + u) * cell, region->extent_ylo + (j + v) * cell,
                     found);
      found.intersect(Slope::Interval{region->extent_zlo, region->extent_zhi});
      for (size_t n = 0; n < found.size(); n++) mine[j] += found[n].hi - found[n].lo;
    }
  MPI_Allreduce(mine.data(), rows.data(), ny, MPI_DOUBLE, MPI_SUM, world);
  return std::accumulate(rows.begin(), rows.end(), 0.0) * cell * cell;
}

/* ----------------------------------------------------------------------
   the balls lie in the region, or not farther from it than a diameter
------------------------------------------------------------------------- */

void DepositRelease::check_balls(Region *region, const Mass &mass) const
{
  auto near = [&](const double *x, double reach) {
    if (region->match(x[X], x[Y], x[Z])) return true;
    for (int k = 0; k < 27; k++) {
      double way[3] = {k % 3 - 1.0, k / 3 % 3 - 1.0, k / 9 - 1.0};
      const double length = sqrt(way[X] * way[X] + way[Y] * way[Y] + way[Z] * way[Z]);
      if (length == 0.0) continue;
      for (const double part : {0.5, 1.0}) {
        const double far = part * reach / length;
        if (region->match(x[X] + far * way[X], x[Y] + far * way[Y], x[Z] + far * way[Z]))
          return true;
      }
    }
    return false;
  };

  double mine = 0.0, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (balls.selected(i) && !near(atom->x[i], 2.0 * atom->radius[i])) mine += 1.0;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  if (all > ASTRAY * mass.number)
    error->all(
        FLERR,
        "Fix deposit/grid bulk region {} must be the body that the balls fill: at most {:g} % "
        "of them may lie farther than a diameter from it, got {:.0f} of {:.0f}",
        region->id, 100.0 * ASTRAY, all, mass.number);
}

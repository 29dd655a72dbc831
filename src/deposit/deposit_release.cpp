/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_release.h"

#include "body_volume.h"
#include "constants.h"
#include "deposit_balls.h"
#include "deposit_options.h"
#include "gravity_work.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "pair_gran_restitution.h"
#include "region_columns.h"
#include "region_surface.h"
#include "region_terrain.h"
#include "style_argument.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

using namespace LAMMPS_NS;

static const char *const CALLER = "Fix deposit/grid terrain";
static constexpr double ASTRAY = 0.05;               // of the balls may lie far from the body
static constexpr double LEAST = 1.0, MOST = 10.0;    // bulk factor: volume of a body / of its balls

enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

DepositRelease::DepositRelease(LAMMPS *lmp, const DepositBalls &balls_in,
                               const DepositOptions &options_in) :
    Pointers(lmp),
    balls(balls_in), options(options_in)
{
}

/* ---------------------------------------------------------------------- */

DepositRelease::Released DepositRelease::find() const
{
  Released found = Released();
  found.mass = find_mass();
  check_ground();
  if (!options.body.empty()) {
    const Body body = find_body(found.mass);
    found.body = body.volume;
    found.thick = body.thick;
  }
  double z;
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

std::vector<double> DepositRelease::ground() const
{
  const Slope::PlanGrid &grid = options.grid;
  const RegionSurface ground(lmp, CALLER, options.terrain.c_str(), RegionSurface::UPPER);
  auto first_row = [&](int rank) {    // each rank finds some of them
    return static_cast<int>(static_cast<bigint>(grid.n[Y]) * rank / comm->nprocs);
  };
  std::vector<double> mine;
  mine.reserve(static_cast<size_t>(grid.n[X]) * (first_row(comm->me + 1) - first_row(comm->me)));
  for (int j = first_row(comm->me); j < first_row(comm->me + 1); j++)
    for (int i = 0; i < grid.n[X]; i++) {
      double z;
      const bool any = ground.height(grid.centre(X, i), grid.centre(Y, j), z);
      mine.push_back(any ? z : std::numeric_limits<double>::quiet_NaN());
    }
  return gather_records(world, mine);
}

/* ---------------------------------------------------------------------- */

void DepositRelease::check_ground() const
{
  const RegionSurface ground(lmp, CALLER, options.terrain.c_str(), RegionSurface::UPPER);
  Region *solid = compat::find_region(lmp, options.terrain);
  const auto *terrain = dynamic_cast<const RegTerrain *>(solid);
  if (terrain && (!solid->interior || terrain->grid().count_nodata() == 0)) terrain = nullptr;

  // what was solid below the last place that was searched mostly is so below the next one

  double guess = ground.zlo;
  auto found = [&](double x, double y) {
    if (solid->match(x, y, guess)) return true;
    double z;
    if (!ground.height(x, y, z)) return false;
    guess = 0.5 * (z + ground.zlo);
    return true;
  };
  auto hole = [&](const double *x, double diameter) {
    if (!found(x[0], x[1])) return true;
    if (terrain) return terrain->grid().nodata_within(x[0], x[1], diameter);
    for (int k = 0; k < 8; k++) {
      const double px = x[0] + diameter * cos(0.25 * Slope::PI * k);
      const double py = x[1] + diameter * sin(0.25 * Slope::PI * k);
      if (px < ground.xlo || px > ground.xhi || py < ground.ylo || py > ground.yhi) continue;
      if (!found(px, py)) return true;
    }
    return false;
  };

  // the ball with the lowest ID is named, so that the message does not depend on the ranks

  double worst[5] = {HUGE_VAL, 0.0, 0.0, 0.0, 0.0};    // tag, place, diameter
  for (int i = 0; i < atom->nlocal; i++) {
    if (!balls.selected(i) || atom->tag[i] >= worst[0]) continue;
    const double *x = atom->x[i];
    const double diameter = 2.0 * atom->radius[i];
    if (!hole(x, diameter)) continue;
    worst[0] = atom->tag[i];
    std::copy(x, x + 3, worst + 1);
    worst[4] = diameter;
  }
  with_largest(world, -worst[0], worst);
  if (worst[0] == HUGE_VAL) return;
  error->all(FLERR,
             "Fix deposit/grid terrain region {} must have a height within one diameter {:g} of "
             "every released ball, got none at ball {:.0f}, {:.8g} {:.8g} {:.8g}: there the slip "
             "surface reaches below the bottom of the ground (check its toe and depth, or give "
             "region terrain a larger depth), or the survey has a hole (tools/slope terrain "
             "--fill)",
             options.terrain, worst[4], worst[0], worst[1], worst[2], worst[3]);
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

  double zmax;
  MPI_Allreduce(&top.x[Z], &zmax, 1, MPI_DOUBLE, MPI_MAX, world);
  with_largest(world, top.x[Z] == zmax ? -top.tag : -HUGE_VAL, top);
  return {all[0], all[1], all[3] / all[2], all[4] / all[2], {top.x[X], top.x[Y], top.x[Z]}};
}

/* ---------------------------------------------------------------------- */

DepositRelease::Body DepositRelease::find_body(const Mass &mass) const
{
  Region *region = body();
  const std::string &id = options.body;
  Body found = {0.0, 0.0};
  std::string problem;
  try {
    found = integrate(region);
  } catch (std::runtime_error &e) {    // the same on all ranks
    problem = e.what();
  }
  if (!problem.empty()) error->all(FLERR, "Fix deposit/grid bulk region {}: {}", id, problem);
  if (found.volume == 0.0)
    error->all(FLERR, "Fix deposit/grid bulk region {} must have a volume > 0, got 0: it is empty",
               id);
  check_balls(region, mass);
  if (!(found.volume >= LEAST * mass.solid && found.volume <= MOST * mass.solid))
    error->all(
        FLERR,
        "Fix deposit/grid bulk region {} must be the body that the balls fill, of {:g} to {:g} "
        "times their volume {:.6g}, got {:.6g}",
        id, LEAST, MOST, mass.solid, found.volume);
  return found;
}

/* ---------------------------------------------------------------------- */

Region *DepositRelease::body() const
{
  const std::string &id = options.body;
  Region *region = region_argument(lmp, "Fix deposit/grid bulk", id);
  if (region->openflag)
    error->all(FLERR, "Fix deposit/grid bulk region {} must have no open faces, got some", id);

  const double ends[6] = {region->extent_xlo, region->extent_xhi, region->extent_ylo,
                          region->extent_yhi, region->extent_zlo, region->extent_zhi};
  bool bounded = region->bboxflag;
  for (const double end : ends) bounded = bounded && std::fabs(end) < RegionSurface::UNBOUNDED;
  if (!bounded)
    error->all(
        FLERR,
        "Fix deposit/grid bulk region {} must be bounded on all sides, got one without an end "
        "(the body is the intersection of ground and slip surface)",
        id);
  return region;
}

/* ---------------------------------------------------------------------- */

DepositRelease::Body DepositRelease::integrate(Region *region) const
{
  const double zlo = region->extent_zlo, zhi = region->extent_zhi;
  const auto columns =
      RegionColumns::of(lmp, region, {zlo, zhi, (zhi - zlo) / RegionSurface::STEPS});
  Slope::Intervals found;
  double longest = 0.0;    // of the columns of this rank
  auto length = [&](double x, double y) {
    columns->column(x, y, found);
    found.intersect(Slope::Interval{zlo, zhi});
    longest = std::max(longest, found.length());
    return found.length();
  };
  auto sum = [this](std::vector<double> &values) {
    add_up(world, values);
  };

  double mine[4] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}, ends[4];    // of the balls; lo, -hi
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = X; d <= Y && balls.selected(i); d++) {
      mine[d] = std::min(mine[d], atom->x[i][d]);
      mine[2 + d] = std::min(mine[2 + d], -atom->x[i][d]);
    }
  MPI_Allreduce(mine, ends, 4, MPI_DOUBLE, MPI_MIN, world);
  Body body;
  body.volume = Slope::body_volume(
      {{region->extent_xlo, region->extent_ylo}, {region->extent_xhi, region->extent_yhi}},
      {{ends[0], ends[1]}, {-ends[2], -ends[3]}}, length, {comm->me, comm->nprocs, sum});
  MPI_Allreduce(&longest, &body.thick, 1, MPI_DOUBLE, MPI_MAX, world);
  return body;
}

/* ---------------------------------------------------------------------- */

double DepositRelease::stiffness_number(const Released &released) const
{
  const PairGranRestitution *pair = PairGranRestitution::of(lmp);
  if (!pair || released.thick <= 0.0) return 0.0;

  std::vector<double> mine(atom->ntypes + 1, 0.0), largest(mine);    // diameters, by type
  double mass = 0.0, all;
  int groups = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!balls.selected(i)) continue;
    double &d = mine[atom->type[i]];
    d = std::max(d, 2.0 * atom->radius[i]);
    mass += atom->rmass[i];
    groups |= atom->mask[i];
  }
  MPI_Allreduce(mine.data(), largest.data(), atom->ntypes + 1, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(&mass, &all, 1, MPI_DOUBLE, MPI_SUM, world);

  double softest = HUGE_VAL;    // over the diameter
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      const Slope::ContactLaw *law = pair->law(i, j);
      if (!law || largest[i] == 0.0 || largest[j] == 0.0) continue;
      const double d = std::max(largest[i], largest[j]);
      softest = std::min(softest, law->kn / d);
    }
  const double weight = all / released.body * gravity(groups) * released.thick;
  return softest < HUGE_VAL && weight > 0.0 ? softest / weight : 0.0;
}

/* ----------------------------------------------------------------------
   of all fixes that pull balls of these groups
------------------------------------------------------------------------- */

double DepositRelease::gravity(int mine) const
{
  double sum[3] = {0.0, 0.0, 0.0};
  for (Fix *fix : compat::fixes_of_style(lmp, "gravity")) {
    int pulls_mine = (mine & fix->groupbit) != 0, pulls;
    MPI_Allreduce(&pulls_mine, &pulls, 1, MPI_INT, MPI_MAX, world);
    if (!pulls) continue;
    const double *g = acceleration_of(fix);
    for (int d = 0; d < 3; d++) sum[d] += g[d];
  }
  return sqrt(sum[X] * sum[X] + sum[Y] * sum[Y] + sum[Z] * sum[Z]);
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

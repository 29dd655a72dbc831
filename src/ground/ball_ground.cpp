/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_ground.h"

#include "domain.h"
#include "error.h"
#include "lammps_compat.h"
#include "region.h"
#include "scattered_sampler.h"
#include "sunk_surface.h"
#include "surface_sampler.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace LAMMPS_NS;

// between columns, and where one is searched, in diameters (of the columns that are sunk, or sinks): thinner soil holds
// no ball
static constexpr double PITCH = 0.125;
static constexpr int LOOKS = 32;    // columns along each side of the body that tell its ground
static constexpr int ROUNDS = 3;
static constexpr double MOST = 0.9;       // of these must end at it
static constexpr double SAME = 1.0e-6;    // heights, in diameters

/* ---------------------------------------------------------------------- */

BallGround::BallGround(LAMMPS *lmp, const PlacementArguments &a) :
    Pointers(lmp), arguments(a), cosine(std::cos(a.angle)),
    sine(std::sin(a.angle)), plan{0.0, 0.0, 0.0, 0.0, a.spacing, a.origin[0], a.origin[1]}
{
  const double step = PITCH * a.diameter;
  const auto columns_of = [&](const std::string &id) {
    return new RegionSurface(lmp, a.caller, id.c_str(), RegionSurface::LOWER, step);
  };
  if (!a.inside.empty()) within.reset(columns_of(a.inside));
  if (!a.outside.empty()) columns.reset(columns_of(a.outside));
  for (const PlacementArguments::Zone &zone : a.zones) {
    std::unique_ptr<RegionSurface> its(columns_of(zone.region));
    const Region *box = compat::find_region(lmp, zone.region);
    zones.push_back(
        {std::move(its), box->extent_xlo, box->extent_xhi, box->extent_ylo, box->extent_yhi});
  }
  if (a.region.empty()) return;
  boundary.reset(new RegionSurface(lmp, a.caller, a.region.c_str(), a.side, step));
  if (!boundary->has_boundary())
    error->all(FLERR, "{} region {} must have a{} boundary, got INF", a.caller, a.region,
               a.side == RegionSurface::LOWER ? " lower" : "n upper");
  find_bodies();
}

BallGround::~BallGround() = default;

/* ----------------------------------------------------------------------
   the bodies of sunk balls: the one that lies on these, and those outside of which they are
------------------------------------------------------------------------- */

void BallGround::find_bodies()
{
  const PlacementArguments &a = arguments;
  const auto others = compat::fixes_of_style(lmp, "wall/gran/balls");
  if (a.sink > 0.0)
    sunk = std::make_shared<SunkRegion>(lmp, a.caller, a.region, a.side, a.sink, a.diameter);
  if (sunk && a.side == RegionSurface::LOWER)
    for (Fix *fix : others) {
      const std::string &left_out = dynamic_cast<OnBallGround &>(*fix).ground().outside;
      if (left_out.empty() || !compat::find_region(lmp, left_out)) continue;
      const RegionSurface its(lmp, a.caller, left_out.c_str(), RegionSurface::LOWER,
                              PITCH * a.diameter);
      if (left_out == a.region || sunk->lies_in(its))
        error->all(
            FLERR,
            "{} sink must come before fix {}, which is outside region {}: define that after this",
            a.caller, fix->id, left_out);
    }

  if (a.outside.empty()) return;
  if (a.outside_sink < 0.0) {
    outside = a.outside;
    for (Fix *fix : others) {
      const Sunk &body = dynamic_cast<OnBallGround &>(*fix).ground().sunk;
      if (body && body->side == RegionSurface::LOWER &&
          (body->region == a.outside || body->lies_in(*columns)))
        bodies.push_back(body);
    }
  } else if (a.outside_sink > 0.0) {
    if (!columns->has_boundary())
      error->all(FLERR, "{} sunk region {} must have a lower boundary, got INF", a.caller,
                 a.outside);
    bodies.push_back(std::make_shared<SunkRegion>(lmp, a.caller, a.outside, RegionSurface::LOWER,
                                                  a.outside_sink, a.diameter));
  }
}

bool BallGround::stands(std::string &changed) const
{
  for (const RegionSurface *s : {boundary.get(), within.get(), columns.get()})
    if (s && !s->stands(changed)) return false;
  for (const Zone &zone : zones)
    if (!zone.columns->stands(changed)) return false;
  if (sunk && !sunk->stands(changed)) return false;
  for (const Sunk &body : bodies)
    if (!body->stands(changed)) return false;
  return true;
}

/* ---------------------------------------------------------------------- */

bool BallGround::build()
{
  for (const Sunk &body : bodies) body->build();
  plan.xlo = boundary->xlo;
  plan.xhi = boundary->xhi;
  plan.ylo = boundary->ylo;
  plan.yhi = boundary->yhi;
  if (!(plan.xlo <= plan.xhi && plan.ylo <= plan.yhi)) return false;    // an empty intersection
  if (sunk) {
    sunk->build();
    sunk->plan(plan.xlo, plan.xhi, plan.ylo, plan.yhi);
    check_floor();
  }
  return plan.xlo <= plan.xhi && plan.ylo <= plan.yhi;
}

void BallGround::check_floor() const
{
  const PlacementArguments &a = arguments;
  const double most = sunk->lowest() + a.sink - sunk->floor();
  if (a.sink < most) return;
  const bool of_region = a.side == RegionSurface::UPPER || !sunk->ground.empty();
  throw std::runtime_error(fmt::format(
      "sink must be < {:.6g}, so that the balls lie above the bottom of {}, got {}", most,
      of_region ? "region " + (sunk->ground.empty() ? a.region : sunk->ground)
                : "the simulation box",
      a.sink));
}

/* ---------------------------------------------------------------------- */

std::unique_ptr<Slope::BallSampler> BallGround::new_sampler() const
{
  std::unique_ptr<Slope::BallSampler> made;
  const double half = 0.25 * (arguments.diameter + arguments.smallest);
  if (!arguments.scattered) {
    made.reset(new Slope::SurfaceSampler(grid(), half, surface()));
    return made;
  }
  const std::vector<double> all = spacings();
  const bool several = all.size() > 1;
  auto scattered =
      new Slope::ScatteredSampler(grid(), several ? surface_of(all[0]) : surface(), arguments.seed);
  made.reset(scattered);
  for (size_t k = 1; k < all.size(); k++) scattered->add(all[k], surface_of(all[k]));
  return made;
}

void BallGround::sample(Slope::BallSampler &from, int tile, std::vector<Slope::PlacedBall> &balls,
                        Slope::SurfaceCounts &counts) const
{
  const size_t before = balls.size();
  from.sample(tile, balls, counts);
  for (size_t k = before; k < balls.size(); k++) {
    turn(balls[k].x, balls[k].y);
    balls[k].zone = zone(balls[k].x, balls[k].y);
  }
}

/* ---------------------------------------------------------------------- */

bool BallGround::height(double x, double y, double &z) const
{
  return sunk ? sunk->height(x, y, z) : boundary->height(x, y, z);
}

/* ----------------------------------------------------------------------
   Columns of the region outside of which they are, and of the sunk surface below it where the balls would be
   above it.
   A sunk surface reaches farther than its body.
------------------------------------------------------------------------- */

bool BallGround::keep(double x, double y) const
{
  double z, bottom;
  if (within && !within->height(x, y, z)) return false;
  for (const Sunk &body : bodies)
    if (body->centre(x, y, bottom) && height(x, y, z) && bottom < z) return false;
  if (!columns || (bodies.size() == 1 && bodies[0]->region == arguments.outside)) return true;
  return !columns->height(x, y, z);
}

bool BallGround::scar(double x, double y, double &z) const
{
  double top, bottom;
  z = HUGE_VAL;
  if (!height(x, y, top)) return false;
  for (const Sunk &body : bodies)
    if (body->centre(x, y, bottom) && bottom < top) z = std::min(z, bottom);

  // a prism without a bottom leaves no scar, it only selects

  const bool upper = sunk && arguments.side == RegionSurface::UPPER;
  if (columns->has_boundary() && columns->height(x, y, bottom))
    z = std::min(z, upper ? bottom - arguments.sink : bottom);
  return z < HUGE_VAL && !(upper && z > top);    // a ball above its own surface would be a lip
}

/* ----------------------------------------------------------------------
   a plan grid that is turned about its origin
------------------------------------------------------------------------- */

void BallGround::turn(double &x, double &y, double direction) const
{
  if (sine == 0.0 && cosine == 1.0) return;
  const double dx = x - plan.xorigin, dy = y - plan.yorigin, s = direction * sine;
  x = plan.xorigin + cosine * dx - s * dy;
  y = plan.yorigin + s * dx + cosine * dy;
}

// the rectangle around the plan

Slope::NodeGrid BallGround::grid() const
{
  if (arguments.angle == 0.0) return plan;
  Slope::NodeGrid around = plan;
  around.xlo = around.ylo = HUGE_VAL;
  around.xhi = around.yhi = -HUGE_VAL;
  for (double x : {plan.xlo, plan.xhi})
    for (double y : {plan.ylo, plan.yhi}) {
      double u = x, v = y;
      turn(u, v, -1.0);
      around.xlo = std::min(around.xlo, u);
      around.xhi = std::max(around.xhi, u);
      around.ylo = std::min(around.ylo, v);
      around.yhi = std::max(around.yhi, v);
    }
  return around;
}

Slope::GroundHeights BallGround::surface() const
{
  // beyond the rectangle of the plan, which a turned grid overlaps, nothing is known

  auto in_plan = [this](double &x, double &y) {
    if (arguments.angle == 0.0) return true;
    turn(x, y);
    return x >= plan.xlo && x <= plan.xhi && y >= plan.ylo && y <= plan.yhi;
  };
  Slope::GroundHeights s;
  s.height = [=](double x, double y, double &z) {
    return in_plan(x, y) && height(x, y, z);
  };
  if (!columns && !within) return s;
  s.keep = [=](double x, double y) {
    return in_plan(x, y) && keep(x, y);
  };

  // what lies outside of a region borders on the scar that it leaves

  if (columns && (columns->has_boundary() || !bodies.empty()))
    s.scar = [=](double x, double y, double &z) {
      return in_plan(x, y) && scar(x, y, z);
    };
  return s;
}

Slope::GroundHeights BallGround::looked_at() const
{
  Slope::GroundHeights s = surface();
  if (sunk && arguments.side == RegionSurface::UPPER)
    s.height = [this](double x, double y, double &z) {
      turn(x, y);
      return boundary->height(x, y, z);
    };
  return s;
}

/* ----------------------------------------------------------------------
   zones: the last one counts
------------------------------------------------------------------------- */

int BallGround::zone(double x, double y) const
{
  double z;
  for (size_t k = zones.size(); k > 0; k--) {
    const Zone &its = zones[k - 1];
    if (x < its.xlo || x > its.xhi || y < its.ylo || y > its.yhi) continue;
    if (its.columns->height(x, y, z)) return static_cast<int>(k);
  }
  return 0;
}

double BallGround::spacing(double x, double y) const
{
  const int its = zone(x, y);
  return its ? arguments.zones[its - 1].spacing : arguments.spacing;
}

std::vector<double> BallGround::spacings() const
{
  std::vector<double> all = {arguments.spacing};
  for (const PlacementArguments::Zone &zone : arguments.zones)
    if (std::find(all.begin(), all.end(), zone.spacing) == all.end()) all.push_back(zone.spacing);
  return all;
}

Slope::GroundHeights BallGround::surface_of(double wanted) const
{
  Slope::GroundHeights s = surface();
  const auto whole = s.keep;
  s.keep = [=](double x, double y) {
    return spacing(x, y) == wanted && (!whole || whole(x, y));
  };
  return s;
}

/* ---------------------------------------------------------------------- */

SunkRegion::SunkRegion(LAMMPS *lmp, const std::string &caller, const std::string &region_in,
                       int side_in, double sink_in, double diameter_in) :
    Pointers(lmp),
    region(region_in), side(side_in), sink(sink_in), diameter(diameter_in), flush(false)
{
  boundary.reset(new RegionSurface(lmp, caller, region.c_str(), side, PITCH * diameter));
  if (side == RegionSurface::UPPER || !boundary->has_boundary()) return;
  find_columns();
  find_ground(caller);
  if (!ground.empty())
    top.reset(
        new RegionSurface(lmp, caller, ground.c_str(), RegionSurface::UPPER, PITCH * diameter));
}

SunkRegion::~SunkRegion() = default;

/* ----------------------------------------------------------------------
   some of the columns of the body, spread over its plan; where few are found they are looked for
   again, around those
------------------------------------------------------------------------- */

void SunkRegion::find_columns()
{
  double lo[2] = {boundary->xlo, boundary->ylo}, hi[2] = {boundary->xhi, boundary->yhi};
  for (int round = 0; round < ROUNDS; round++) {
    const double dx = (hi[0] - lo[0]) / LOOKS, dy = (hi[1] - lo[1]) / LOOKS;
    columns.clear();
    double found[4] = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL}, z;
    for (int j = 0; j < LOOKS; j++)
      for (int i = 0; i < LOOKS; i++) {
        const double x = lo[0] + (i + 0.5) * dx, y = lo[1] + (j + 0.5) * dy;
        if (!boundary->height(x, y, z)) continue;
        columns.insert(columns.end(), {x, y});
        found[0] = std::min(found[0], x);
        found[1] = std::max(found[1], x);
        found[2] = std::min(found[2], y);
        found[3] = std::max(found[3], y);
      }
    if (columns.empty() || columns.size() > 4 * LOOKS) return;
    lo[0] = std::max(lo[0], found[0] - dx);
    hi[0] = std::min(hi[0], found[1] + dx);
    lo[1] = std::max(lo[1], found[2] - dy);
    hi[1] = std::min(hi[1], found[3] + dy);
  }
}

/* ----------------------------------------------------------------------
   the ground that the body is part of: it ends above where the body does
------------------------------------------------------------------------- */

void SunkRegion::find_ground(const std::string &caller)
{
  const double step = PITCH * diameter;
  const RegionSurface upper(lmp, caller, region.c_str(), RegionSurface::UPPER, step);
  if (!upper.has_boundary()) return;

  double widest = 0.0;
  for (Region *candidate : compat::regions(lmp)) {
    if (region == candidate->id ||
        !RegionSurface::is_fit(candidate, RegionSurface::UPPER, boundary->xlo, boundary->xhi,
                               boundary->ylo, boundary->yhi))
      continue;
    const RegionSurface other(lmp, caller, candidate->id, RegionSurface::UPPER, step);
    const double area = (other.xhi - other.xlo) * (other.yhi - other.ylo);
    if (area < widest || (area == widest && candidate->id >= ground)) continue;

    int known = 0, same = 0;
    for (size_t k = 0; k < columns.size(); k += 2) {
      double mine, its;
      if (!upper.height(columns[k], columns[k + 1], mine)) continue;
      known++;
      if (other.height(columns[k], columns[k + 1], its) && std::fabs(mine - its) <= SAME * diameter)
        same++;
    }
    if (known == 0 || same < MOST * known) continue;
    widest = area;
    ground = candidate->id;
    flush = same == known && known >= LOOKS;
  }
}

bool SunkRegion::lies_in(const RegionSurface &others) const
{
  size_t common = 0;
  double z;
  for (size_t k = 0; k < columns.size(); k += 2)
    if (others.height(columns[k], columns[k + 1], z)) common += 2;
  return common > 0 && common >= MOST * columns.size();
}

/* ---------------------------------------------------------------------- */

// an upper boundary is not looked at everywhere

double SunkRegion::lowest() const
{
  if (side == RegionSurface::LOWER) return surface->lowest();
  const double dx = (boundary->xhi - boundary->xlo) / LOOKS;
  const double dy = (boundary->yhi - boundary->ylo) / LOOKS;
  double found = HUGE_VAL, z;
  for (int j = 0; j < LOOKS; j++)
    for (int i = 0; i < LOOKS; i++)
      if (boundary->height(boundary->xlo + (i + 0.5) * dx, boundary->ylo + (j + 0.5) * dy, z))
        found = std::min(found, z);
  return found - sink;
}

double SunkRegion::floor() const
{
  if (top) return top->zlo;
  if (side == RegionSurface::UPPER) return boundary->zlo;
  return domain->box_exist && domain->boundary[2][0] < 2 ? domain->boxlo[2] : -HUGE_VAL;
}

/* ---------------------------------------------------------------------- */

void SunkRegion::build()
{
  if (surface) return;
  Slope::Bed bed = {boundary->xlo,
                    boundary->xhi,
                    boundary->ylo,
                    boundary->yhi,
                    nullptr,
                    nullptr,
                    side == RegionSurface::LOWER};
  bed.height = [this](double x, double y, double near, double &z) {
    double end;    // a search of the column from its bottom takes long
    if (flush && std::isnan(near) && top->height(x, y, end))
      return boundary->height_below(x, y, end, z);
    return boundary->height_near(x, y, near, z);
  };
  if (top)
    bed.ground = [this](double x, double y, double near, double &z) {
      return top->height_near(x, y, near, z);
    };
  const double size = side == RegionSurface::LOWER ? diameter : 0.5 * diameter;
  const double pitch = std::min(PITCH * std::max(sink, size), 0.5 * sink);
  surface.reset(new Slope::SunkSurface(bed, sink, pitch));
}

bool SunkRegion::stands(std::string &changed) const
{
  return boundary->stands(changed) && (!top || top->stands(changed));
}

void SunkRegion::plan(double &xlo, double &xhi, double &ylo, double &yhi) const
{
  xlo = surface->xlo;
  xhi = surface->xhi;
  ylo = surface->ylo;
  yhi = surface->yhi;
  if (!top) return;
  xlo = std::max(xlo, top->xlo);
  xhi = std::min(xhi, top->xhi);
  ylo = std::max(ylo, top->ylo);
  yhi = std::min(yhi, top->yhi);
}

bool SunkRegion::centre(double x, double y, double &z) const
{
  return surface->height(x, y, z);
}

bool SunkRegion::height(double x, double y, double &z) const
{
  double end;
  if (side == RegionSurface::UPPER && !boundary->height(x, y, end)) return false;
  if (!surface->height(x, y, z)) return false;
  return !top || (top->height(x, y, end) && z < end);
}

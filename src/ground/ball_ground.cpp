/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_ground.h"

#include "ball_body.h"
#include "error.h"
#include "lammps_compat.h"
#include "region.h"
#include "region_surface.h"
#include "sunk_region.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace LAMMPS_NS;

// a column is searched in steps of this times the diameter: thinner soil holds no ball
static constexpr double SEARCH_STEP = 0.125;

/* ---------------------------------------------------------------------- */

BallGround::BallGround(LAMMPS *lmp, const PlacementArguments &a) :
    Pointers(lmp), arguments(a), cosine(std::cos(a.angle)),
    sine(std::sin(a.angle)), plan{0.0, 0.0, 0.0, 0.0, a.spacing, a.origin[0], a.origin[1]}
{
  const double step = SEARCH_STEP * a.diameter;
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
      const std::string &left_out = dynamic_cast<BallBody &>(*fix).left_out();
      if (left_out.empty() || !compat::find_region(lmp, left_out)) continue;
      const RegionSurface its(lmp, a.caller, left_out.c_str(), RegionSurface::LOWER,
                              SEARCH_STEP * a.diameter);
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
      const Sunk body = dynamic_cast<BallBody &>(*fix).body();
      if (body && (body->region == a.outside || body->lies_in(*columns))) bodies.push_back(body);
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

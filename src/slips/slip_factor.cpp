// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace Slope;

static constexpr double INFINITE = std::numeric_limits<double>::infinity();
static constexpr double NONE = std::numeric_limits<double>::quiet_NaN();
static constexpr double STEEPEST = 2.0;    // inclination of forces between columns, tangent
static constexpr int MOST = 200;           // steps of an iteration, of which few are needed

/* ---------------------------------------------------------------------- */

double SlipFactor::steepest(const SlipColumns &c)
{
  double mx = 0.0, my = 0.0;
  for (size_t i = 0; i < c.size(); i++) {
    mx += c.weight[i] * c.dx[i];
    my += c.weight[i] * c.dy[i];
  }
  return std::atan2(-my, -mx);
}

/* ---------------------------------------------------------------------- */

void SlipFactor::take(const SlipColumns &c, const SlipSurface &s)
{
  columns = &c;
  bases.resize(c.size());
  weight = weight_u = weight_arm = 0.0;
  const double cd = std::cos(s.direction), sd = std::sin(s.direction);
  const double a2 = s.along * s.along, b2 = s.across * s.across;
  for (size_t i = 0; i < c.size(); i++) {
    const double u = -(c.dx[i] * cd + c.dy[i] * sd);
    const double v = s.beyond(c.dx[i] * sd - c.dy[i] * cd), e = c.depth[i];
    double rise = u / (a2 * e), rise_across = v / (b2 * e);
    if (c.rocky && !std::isnan(c.slope_x[i])) {
      rise = -(c.slope_x[i] * cd + c.slope_y[i] * sd);
      rise_across = c.slope_x[i] * sd - c.slope_y[i] * cd;
    }
    Base &b = bases[i];
    b.cosine = 1.0 / std::sqrt(1.0 + rise * rise);
    b.sine = rise * b.cosine;
    b.up = 1.0 / std::sqrt(1.0 + rise * rise + rise_across * rise_across);
    b.lever = u * b.sine + e * b.cosine;
    b.normal = b.up * (e * rise - u);
    const double area = c.area[i] / b.up;
    b.cohesive = c.cohesion[i] * area;
    b.lift = c.pore[i] * area;
    weight += c.weight[i];
    weight_u += c.weight[i] * u;
    weight_arm += c.weight[i] * c.arm[i];
  }
}

/* ---------------------------------------------------------------------- */

SlipFactor::Balance SlipFactor::balance(double factor, const Seismic &k, double inclination) const
{
  const SlipColumns &c = *columns;
  const double down = 1.0 - k.vertical, across = k.horizontal * inclination;
  double shear = 0.0, normal = 0.0, holding = 0.0, pushing = 0.0, at_bound = 0.0, pulling = 0.0;
  for (size_t i = 0; i < bases.size(); i++) {
    const Base &b = bases[i];
    const double w = c.weight[i] * down, tangent = c.friction[i];
    double effective, push = 0.0;    // of the unit normal, in the direction of sliding
    if (method == ORDINARY) {
      const double inertia = k.horizontal * c.weight[i] * b.sine / b.cosine;
      effective = std::max((w - inertia) * b.cosine * b.cosine / b.up - b.lift, 0.0);
    } else {
      double turned = b.sine / factor, m = b.up;
      if (method == SPENCER) {
        push = b.up * b.sine / b.cosine;
        turned -= inclination * b.cosine / factor;
        m += inclination * push;
      }
      m += turned * tangent;
      if (m < LEAST_M) {
        m = LEAST_M;
        at_bound += c.weight[i];
      }
      const double load = w - across * c.weight[i];
      effective = (load - (b.cohesive - b.lift * tangent) * turned) / m - b.lift;
      if (effective < 0.0) pulling += c.weight[i];
    }
    const double strength = b.cohesive + effective * tangent, force = effective + b.lift;
    shear += b.lever * strength;
    normal += force * b.normal;
    if (method != SPENCER) continue;
    holding += b.cosine * strength;
    pushing += force * push;
  }
  bounded = weight > 0.0 ? at_bound / weight : 0.0;
  pulled = weight > 0.0 ? pulling / weight : 0.0;
  inclined = inclination;
  return {shear, down * weight_u + k.horizontal * weight_arm + normal, holding,
          pushing + k.horizontal * weight};
}

/* ----------------------------------------------------------------------
   balance of moments: by steps F -> resisting / driving, which Aitken's rule shortens
------------------------------------------------------------------------- */

double SlipFactor::factor_at(double inclination, const Seismic &k, double precision,
                             double start) const
{
  double f = start;
  const auto next = [&](double from) {
    const Balance b = balance(from, k, inclination);
    return b.driving > 0.0 ? std::max(b.resisting / b.driving, 0.0) : INFINITE;
  };
  for (int step = 0; step < MOST; step++) {
    const double first = next(f);
    if (!std::isfinite(first) || first == 0.0) return first;
    if (method == ORDINARY || std::fabs(first - f) <= precision * first) return first;
    const double second = next(first);
    if (!std::isfinite(second) || second == 0.0) return second;
    if (std::fabs(second - first) <= precision * second) return second;
    const double bend = second - 2.0 * first + f;
    const double guess = bend != 0.0 ? f - (first - f) * (first - f) / bend : second;
    f = guess > 0.5 * second && guess < 2.0 * second ? guess : second;
  }
  return f;
}

/* ----------------------------------------------------------------------
   with F = 1 the normal forces of Bishop and Spencer are linear in k, and so is the driving moment: the
   second step has it; the ordinary method's are linear, too, but where columns lose their normal force
------------------------------------------------------------------------- */

double SlipFactor::yield_at(double inclination, double vertical) const
{
  const auto excess = [&](double k) {
    const Balance b = balance(1.0, {k, vertical}, inclination);
    return b.resisting - b.driving;
  };
  double k0 = 0.0, e0 = excess(k0), k1 = 0.1, e1 = excess(k1);
  for (int step = 0; step < MOST && e1 != e0; step++) {
    const double k = k1 - e1 * (k1 - k0) / (e1 - e0);
    k0 = k1;
    e0 = e1;
    k1 = k;
    e1 = excess(k1);
    if (std::fabs(k1 - k0) < 1.0e-12 * std::max(1.0, std::fabs(k1))) return k1;
  }
  return e1 == 0.0 || std::fabs(k1 - k0) < 1.0e-9 ? k1 : NONE;
}

/* ----------------------------------------------------------------------
   The inclination, by secants, at which what balances the moments, solve(inclination), leaves no
   excess(inclination, solution) of horizontal forces, as a share of them.
------------------------------------------------------------------------- */

template <typename Solve, typename Excess>
double SlipFactor::inclined_to(Solve solve, Excess excess, double precision) const
{
  double i0 = 0.0, found = solve(i0);
  if (method != SPENCER || !std::isfinite(found) || found == 0.0) return found;
  double e0 = excess(i0, found), i1 = 0.1;
  for (int step = 0; step < MOST; step++) {
    found = solve(i1);
    if (!std::isfinite(found)) return NONE;
    const double e1 = excess(i1, found);
    if (std::fabs(e1) <= precision) return found;
    const double next = i1 - e1 * (i1 - i0) / (e1 - e0);
    if (!(std::fabs(next) <= STEEPEST)) return NONE;
    i0 = i1;
    e0 = e1;
    i1 = next;
  }
  return NONE;
}

/* ---------------------------------------------------------------------- */

double SlipFactor::factor(const Seismic &k, double precision) const
{
  double f = 1.0;
  const auto solve = [&](double inclination) {
    return f = factor_at(inclination, k, precision, f);
  };
  const auto excess = [&](double inclination, double at) {
    const Balance b = balance(at, k, inclination);
    return 1.0 - b.holding / (at * b.pushing);
  };
  return inclined_to(solve, excess, precision);
}

double SlipFactor::of_moments(const Seismic &k, double precision) const
{
  return factor_at(0.0, k, precision, 1.0);
}

double SlipFactor::yield(double vertical) const
{
  const auto solve = [&](double inclination) {
    return yield_at(inclination, vertical);
  };
  const auto excess = [&](double inclination, double at) {
    const Balance b = balance(1.0, {at, vertical}, inclination);
    return 1.0 - b.holding / b.pushing;
  };
  return inclined_to(solve, excess, PRECISION);
}

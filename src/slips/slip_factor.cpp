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
static constexpr int MOST = 200;    // steps of an iteration, of which few are needed

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

void SlipFactor::moments(double factor, const Seismic &k, double &resisting, double &driving) const
{
  const SlipColumns &c = *columns;
  const double down = 1.0 - k.vertical;
  double shear = 0.0, normal = 0.0, at_bound = 0.0, pulling = 0.0;
  for (size_t i = 0; i < bases.size(); i++) {
    const Base &b = bases[i];
    const double w = c.weight[i] * down, tangent = c.friction[i];
    double effective;
    if (method == BISHOP) {
      double m = b.up + b.sine * tangent / factor;
      if (m < LEAST_M) {
        m = LEAST_M;
        at_bound += c.weight[i];
      }
      effective = (w - (b.cohesive - b.lift * tangent) * b.sine / factor) / m - b.lift;
      if (effective < 0.0) pulling += c.weight[i];
    } else {
      const double inertia = k.horizontal * c.weight[i] * b.sine / b.cosine;
      effective = std::max((w - inertia) * b.cosine * b.cosine / b.up - b.lift, 0.0);
    }
    shear += b.lever * (b.cohesive + effective * tangent);
    normal += (effective + b.lift) * b.normal;
  }
  resisting = shear;
  driving = down * weight_u + k.horizontal * weight_arm + normal;
  bounded = weight > 0.0 ? at_bound / weight : 0.0;
  pulled = weight > 0.0 ? pulling / weight : 0.0;
}

/* ----------------------------------------------------------------------
   by steps F -> resisting / driving, which Aitken's rule shortens
------------------------------------------------------------------------- */

double SlipFactor::factor(const Seismic &k, double precision) const
{
  double resisting, driving, f = 1.0;
  const auto next = [&](double from) {
    moments(from, k, resisting, driving);
    return driving > 0.0 ? std::max(resisting / driving, 0.0) : INFINITE;
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
   with F = 1 Bishop's normal forces do not depend on k, and the driving moment is linear in it: the
   second step has it; the ordinary method's are linear, too, but where columns lose their normal force
------------------------------------------------------------------------- */

double SlipFactor::yield(double vertical) const
{
  const auto excess = [&](double k) {
    double resisting, driving;
    moments(1.0, {k, vertical}, resisting, driving);
    return resisting - driving;
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

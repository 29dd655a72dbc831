/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The damped oscillator x'' = -2 h x' - a x in closed form: what a spring-dashpot contact of two
   bodies does as long as nothing else acts on them. Time is counted in time steps. No LAMMPS.
   Derivation: doc/src/theory.rst, Time step. */

#ifndef SLOPE_OSCILLATOR_H
#define SLOPE_OSCILLATOR_H

#include "instruction_set.h"

#include <cmath>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

// displacement x and rate r some time later: x' = xx x + xr r, r' = rx x + rr r
struct Motion {
  double xx, xr, rx, rr;

  double x(double x0, double r0) const { return xx * x0 + xr * r0; }
  double rate(double x0, double r0) const { return rx * x0 + rr * r0; }
};

struct Oscillator {
  double h, a;    // c dt / (2 m) >= 0, k dt^2 / m >= 0

  // t >= 0; any damping
  Motion after(double t) const
  {
    const double q2 = a - h * h, y = q2 * t * t;
    double c, s;    // exp(-h t) times cosine and sine/frequency, or their hyperbolic partners
    if (std::fabs(y) < 1.0e-4) {
      const double e = std::exp(-h * t);
      c = e * (1.0 - y / 2.0 * (1.0 - y / 12.0));
      s = e * t * (1.0 - y / 6.0 * (1.0 - y / 20.0));
    } else if (q2 > 0.0) {
      const double q = std::sqrt(q2), e = std::exp(-h * t);
      c = e * std::cos(q * t);
      s = e * std::sin(q * t) / q;
    } else {    // slow and fast part; the slow exponent without cancellation
      const double q = std::sqrt(-q2);
      const double slow = std::exp(-a / (h + q) * t), fast = std::exp(-(h + q) * t);
      c = 0.5 * (slow + fast);
      s = 0.5 * (slow - fast) / q;
    }
    return {c + h * s, s, -a * s, c - h * s};
  }

  // Factor of x in the force that velocity Verlet needs to stay on this motion, in m / dt^2:
  // what a constant load is carried with when the ball is at rest
  double stiffness() const
  {
    const Motion one = after(1.0);
    return 1.0 + std::exp(-2.0 * h) - (one.xx + one.rr);
  }

  // time from x > 0 with rate r until x = 0; infinite where it never gets there
  double until_zero(double x, double r) const
  {
    const double q2 = a - h * h, b = r + h * x;
    if (q2 > 0.0) {
      const double q = std::sqrt(q2);
      return std::atan2(q * x, -b) / q;
    }
    const double q = std::sqrt(-q2);
    if (!(b < -q * x)) return HUGE_VAL;
    return q > 1.0e-8 * h ? std::atanh(-q * x / b) / q : -x / b;
  }

  // time since x = 0 with rate v > 0, if x is reached within about a step; x / v where it is not
  double since_zero(double x, double v) const
  {
    double t = x / v;
    for (int k = 0; k < 6; k++) {
      const Motion m = after(t);
      const double next = t - (m.xr - x / v) / m.rr;
      if (!(next > 0.0 && next < 2.0)) return x / v;
      t = next;
    }
    return t;
  }
};

// The oscillator of the same damping ratio, and so of the same restitution, that carries a constant
// load at the overlap load / k although velocity Verlet applies the load once a step:
// stiffness() = a. Its frequency is a little higher than that of (h, a): by a zeta w dt / 2.
inline Oscillator true_at_rest(const Oscillator &law)
{
  const double w = std::sqrt(law.a);
  if (!(w > 0.0)) return law;
  const double zeta = law.h / w;
  auto error = [&](double x) {
    return std::log(Oscillator{zeta * x, x * x}.stiffness() / law.a);
  };
  double x = zeta > 1.0 ? std::fmax(w, std::fmin(2.0 * zeta * law.a, 2.0 * zeta)) : w;
  for (int k = 0; k < 40; k++) {
    const double e = error(x), slope = (error(x * 1.0001) - e) / 1.0e-4;    // per log x
    const double step = -e / slope;
    if (!std::isfinite(step)) return law;
    x *= std::exp(std::fmax(-0.5, std::fmin(0.5, step)));
    if (std::fabs(step) < 1.0e-12) return {zeta * x, x * x};
  }
  return std::fabs(error(x)) < 1.0e-6 ? Oscillator{zeta * x, x * x}
                                      : law;    // a step far too large
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact law: linear spring-dashpot, Coulomb friction with a tangential
   spring, rolling resistance with a rolling spring. One contact, pure functions,
   no LAMMPS. Pair gran/restitution and fix wall/gran/balls both call it; nothing
   else computes a contact force. Derivations: doc/src/theory.rst.

   T is double, for one contact, or Four, for four at a time (SIMD): what differs
   between contacts is chosen, never branched on. N is the same, or double if all
   contacts share it.

   Units are SI: m, kg, s, N, rad. The normal n points from the partner to the ball.
*/

#ifndef SLOPE_CONTACT_LAW_H
#define SLOPE_CONTACT_LAW_H

#include "simd4.h"

#include <algorithm>
#include <cmath>

namespace Slope {

static constexpr double PI = 3.14159265358979323846;

// ----------------------------------------------------------------------
// coefficients
// ----------------------------------------------------------------------

// damping ratio (0 = undamped, 1 = critical) of a linear spring-dashpot impact whose
// rebound speed is e times the impact speed, 0 < e <= 1, the contact ending at zero
// overlap: zeta = -ln e / sqrt(pi^2 + ln^2 e)
inline double damping_ratio(double e)
{
  const double l = std::log(e);
  return -l / std::sqrt(PI * PI + l * l);
}

// its inverse; 0 for an overdamped contact (zeta >= 1), which does not rebound
inline double restitution(double zeta)
{
  if (zeta >= 1.0) return 0.0;
  return std::exp(-PI * zeta / std::sqrt(1.0 - zeta * zeta));
}

// duration (s) of a contact of stiffness k (N/m) and mass m (kg); infinite if overdamped
inline double contact_time(double k, double m, double zeta)
{
  if (zeta >= 1.0) return HUGE_VAL;
  return PI / (std::sqrt(k / m) * std::sqrt(1.0 - zeta * zeta));
}

// What one pair of types needs per contact. A dashpot is either a number given by the user
// (N s/m) or follows from a restitution and then grows with the root of the contact's mass:
// c = c_given + c_root * sqrt(m). One of the two is zero.
struct ContactLaw {
  double kn, kt, kr;                    // normal, tangential, rolling stiffness, N/m
  double cn_given, ct_given, cr_given;  // dashpots, N s/m
  double cn_root, ct_root, cr_root;     // dashpots per root of mass, N s/(m sqrt(kg))
  double friction;                      // tan of the friction angle
  double rolling;                       // rolling resistance coefficient mu_r
  double mass_factor;                   // 1: reduced mass, 2: mass of one of two equal balls
  double rolling_factor;                // 2: harmonic mean radius, 1: reduced radius
  double fn_least;                      // smallest normal force: -HUGE_VAL, or 0 when it must not pull
  double exact;                         // 1: scheme exact, 0: plain (see ContactStep)

  // mass (kg) in c = 2 zeta sqrt(k m): two moving balls, or a ball on a fixed one
  double mass(double mi, double mj) const { return mass_factor * mi * mj / (mi + mj); }
  double mass_fixed(double mi) const { return mi; }

  double cn(double m) const { return cn_given + cn_root * std::sqrt(m); }
};

// ----------------------------------------------------------------------
// what a contact remembers
// ----------------------------------------------------------------------

// Values carried from step to step: tangential spring (m), rolling spring (m).
// Seen from the partner both change sign, as LAMMPS' neighbor history assumes.
//
// The tangential spring lies in the tangent plane. Its normal component, the same from both
// sides, is therefore free to say where in its life the contact is, in units of the rolling
// radius: it survives what the history survives.
static constexpr int HISTORY = 6;
enum Phase {
  NEW = -2,      // touches for the first time: set by who finds it
  FIRST = -1,    // had its first step
  INSIDE = 0,
  LAST = 1,      // has got the speed with which it parts
  GONE = 2       // is still parting
};

// value of a new contact's tangential spring along the normal n
inline double new_contact(double rolling_radius) { return NEW * rolling_radius; }

// ----------------------------------------------------------------------
// the law for balls of one mass and one time step
// ----------------------------------------------------------------------

// Velocity Verlet hands over the overlap d at the end of a step and the path V by which it grew
// in it (V = -vn dt), and the force F acts for a whole step: V becomes V - F dt^2/m. With the
// law's own F = kn d - cn vn (scheme plain) the restitution comes out too low, and scatters with
// where in the step the contact begins. Scheme exact takes the force that puts the next overlap
// where the law's own motion, a damped oscillation with w = sqrt(kn/m) and h = cn dt/(2 m), has
// it, whatever the step:
//
//   inside a contact   d_next = C d - D (d - V),  D = exp(-2 h),  C = 2 exp(-h) cos(sqrt(w^2 dt^2 - h^2))
//   first step         V as it would be, had the oscillation that has now d begun earlier,
//                      with the speed of the impact
//   last step          the speed with which the oscillation comes through d = 0
//
// Both agree as dt goes to 0. Derivation: doc/src/theory.rst.
template <class N> struct ContactStepOf {
  double dt, grow;              // s; grow: what the springs grow by, 0 at set-up
  N force;                      // m / dt^2: N per m
  N stiffness, decay;           // 1 + D - C, D
  N back_d, back_v;             // overlap a step ago = back_d d - back_v (rate of d) dt
  N a, h;                       // w^2 dt^2, cn dt / (2 m)
  double kt, kr;
  N ct, cr, relax_t, relax_r;   // relax: dashpot over spring, s
  double friction, rolling, fn_least;
  double first_below, gone_above;    // phases before this step with which it is the first, or none
  double last_below;                 // V with which it may be the last
};
using ContactStep = ContactStepOf<double>;

// Dashpots of the tangent plane act on the spin too, and those of all contacts of a ball at once:
// with a step near the rule their sum would overshoot, and a heap tremble for ever. Each is
// reduced to c / (1 + CROWD c dt / (2 m)), which is c for small steps.
static constexpr double CROWD = 12.0;

// exp(-x) to 1e-12 for 0 <= x <= 1; no call, so that it takes four at a time
template <class N> SLOPE_INLINE N decay_factor(N x)
{
  const N y = 0.125 * x;    // Pade approximant, to the eighth power
  const N even = 1.0 + 0.1 * y * y, odd = y * (0.5 + y * y / 120.0);
  N e = (even - odd) / (even + odd);
  e *= e;
  e *= e;
  return e * e;
}

// What depends on the mass: inverse_mass (1/kg) = 1/m_i + 1/m_j, where a fixed ball has none;
// mass_dashpot (kg): that of the conversion restitution -> dashpot.
template <class N>
SLOPE_INLINE void set_mass(ContactStepOf<N> &s, const ContactLaw &law, N inverse_mass, N mass_dashpot)
{
  const N root_mass = root(mass_dashpot);
  const N half = 0.5 * inverse_mass * s.dt;
  s.force = 0.5 / (half * s.dt);
  s.a = law.kn / s.force;
  s.h = (law.cn_given + law.cn_root * root_mass) * half;

  // cos and sin(x)/x of the root of q, which is negative for an overdamped contact

  const N q = s.a - s.h * s.h;
  const N cosine =
      1.0 - q / 2.0 * (1.0 - q / 12.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0))));
  const N sinc =
      1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0 * (1.0 - q / 110.0))));
  const N e = decay_factor(s.h);
  const double plain = 1.0 - law.exact;
  s.decay = law.exact * e * e + plain * (1.0 - 2.0 * s.h);
  s.stiffness = law.exact * (1.0 + e * e - 2.0 * e * cosine) + plain * s.a;
  s.back_d = (cosine - s.h * sinc) / e;
  s.back_v = sinc / e;

  const N ct = law.ct_given + law.ct_root * root_mass;
  const N cr = law.cr_given + law.cr_root * root_mass;
  s.ct = ct / (1.0 + law.exact * CROWD * half * ct);
  s.cr = cr / (1.0 + law.exact * CROWD * half * cr);
  s.relax_t = s.ct * (law.kt > 0.0 ? 1.0 / law.kt : 0.0);
  s.relax_r = s.cr * (law.kr > 0.0 ? 1.0 / law.kr : 0.0);
}

// dt (s) > 0; again: for the forces of the step that has just ended once more (set-up of a run)
template <class N>
SLOPE_INLINE ContactStepOf<N> contact_step(const ContactLaw &law, N inverse_mass, N mass_dashpot,
                                           double dt, bool again)
{
  const bool exact = law.exact > 0.0;
  ContactStepOf<N> s;
  s.dt = dt;
  s.grow = again ? 0.0 : dt;
  s.kt = law.kt;
  s.kr = law.kr;
  s.friction = law.friction;
  s.rolling = law.rolling;
  s.fn_least = law.fn_least;
  s.first_below = !exact ? -HUGE_VAL : again ? 0.5 * (FIRST + INSIDE) : 0.5 * (NEW + FIRST);
  s.gone_above = !exact ? HUGE_VAL : again ? 0.5 * (LAST + GONE) : 0.5 * (INSIDE + LAST);
  s.last_below = exact ? 0.0 : -HUGE_VAL;
  set_mass(s, law, inverse_mass, mass_dashpot);
  return s;
}

// ----------------------------------------------------------------------
// one contact
// ----------------------------------------------------------------------

template <class T, class N = T> struct ContactOf {
  T n[3];              // unit normal, partner to ball
  T overlap;           // m, > 0
  T v[3];              // velocity of the ball minus that of the partner, m/s
  T rw[3];             // R_i w_i + R_j w_j, m/s
  T w[3];              // w_i - w_j, rad/s
  N rolling_radius;    // m
};
using Contact = ContactOf<double>;

template <class T> struct ContactForceOf {
  T f[3];    // on the ball, N; the partner gets the opposite
  T t[3];    // n x Ft, N: torque on the ball is -R_i t + m, on the partner -R_j t - m
  T m[3];    // rolling torque on the ball, N m
};
using ContactForce = ContactForceOf<double>;

// Normal force in m (times ContactStep::force: N) at overlap d that grew by V in the step that
// ends. phase: a Phase, that of the step before (at set-up, of this step); becomes that of this
// step.
template <class T, class N>
SLOPE_INLINE T normal_force(const ContactStepOf<N> &s, T d, T V, T &phase)
{
  const T inside = s.stiffness * d + (1.0 - s.decay) * V;
  const auto begins = (phase < s.first_below) & (V > 0.0);
  const auto parts = (phase > s.gone_above) & (V <= 0.0);
  const auto may_end = (d + V <= inside) & (V <= s.last_below);
  const T before = phase;
  phase = choose(begins | parts | may_end, before, all<T>(INSIDE));
  if (!bits(begins | parts | may_end)) return inside;    // as most are

  // rate of an oscillation that has the path U per step at d = 0: series in r = d / U

  const N r2 = 0.5 * s.a, r3 = 2.0 / 3.0 * s.h * s.a;
  const N r4 = s.h * s.h * s.a + 0.125 * s.a * s.a;

  // first step: U = V, coming in

  const T r_in = smaller(d / V, all<T>(1.0));
  const T rate_in = V - d * (2.0 * s.h + r_in * (r2 + r_in * (r3 + r_in * r4)));
  const T V_inside = d - (s.back_d * d - s.back_v * rate_in);
  const T first = s.stiffness * d + V - s.decay * V_inside;

  // last step: U from the rate, going out

  const T rate_out = (d - V - s.back_d * d) / s.back_v;
  const T guess = rate_out - 2.0 * s.h * d;
  const T r_out = d / (guess + r2 * d * d / guess);
  const T last = V + guess + d * r_out * (r2 - r_out * (r3 - r_out * r4));
  const auto ends = may_end & (guess > 0.0);

  phase = choose(ends, all<T>(LAST), all<T>(INSIDE));
  phase = choose(parts, all<T>(GONE), phase);
  phase = choose(begins, all<T>(FIRST), phase);
  return choose(begins, first, choose(parts, T(), choose(ends, last, inside)));
}

// Spring and dashpot in the tangent plane with a limit, for sliding and for rolling alike:
// s += u dt, kept in the plane of n; F = -k s - c u; if |F| exceeds the limit, F is cut to it and
// s is cut back to what gives the cut force: with F' = a F, s' = a s - (1 - a) c/k u. u must lie in
// the plane of n. relax: c / k, 0 without a spring.
template <class T, class N>
SLOPE_INLINE void limited_spring(double k, N c, N relax, T limit, const T *n, const T *u, double dt,
                                 T *s, T *f)
{
  T sx = s[0] + u[0] * dt;
  T sy = s[1] + u[1] * dt;
  T sz = s[2] + u[2] * dt;
  const T sn = sx * n[0] + sy * n[1] + sz * n[2];
  sx -= sn * n[0];
  sy -= sn * n[1];
  sz -= sn * n[2];

  const T fx = k * sx + c * u[0];
  const T fy = k * sy + c * u[1];
  const T fz = k * sz + c * u[2];
  const T f2 = fx * fx + fy * fy + fz * fz;
  const T a = smaller(T(limit / f2 * root(f2)), all<T>(1.0));    // 1, too, if f2 = 0
  const T back = (1.0 - a) * relax;
  f[0] = -a * fx;
  f[1] = -a * fy;
  f[2] = -a * fz;
  s[0] = a * sx - back * u[0];
  s[1] = a * sy - back * u[1];
  s[2] = a * sz - back * u[2];
}

// Force of one touching contact. history: HISTORY values, updated. ROLLING = false leaves out the
// rolling resistance, for laws that have none.
template <bool ROLLING = true, class T, class N>
SLOPE_INLINE void contact_force(const ContactStepOf<N> &step, const ContactOf<T, N> &c, T *history,
                                ContactForceOf<T> &out)
{
  const T *n = c.n;
  const N rr = c.rolling_radius;
  const T vn = c.v[0] * n[0] + c.v[1] * n[1] + c.v[2] * n[2];
  const N per_rr = 1.0 / rr;
  T phase = (history[0] * n[0] + history[1] * n[1] + history[2] * n[2]) * per_rr;
  const T F = normal_force(step, c.overlap, T(-vn * step.dt), phase);
  const T fn = larger(T(F * step.force), all<T>(step.fn_least));
  const T pressing = larger(fn, T());

  // tangential: vt = v - vn n - (Ri wi + Rj wj) x n

  const T vt[3] = {c.v[0] - vn * n[0] - (c.rw[1] * n[2] - c.rw[2] * n[1]),
                   c.v[1] - vn * n[1] - (c.rw[2] * n[0] - c.rw[0] * n[2]),
                   c.v[2] - vn * n[2] - (c.rw[0] * n[1] - c.rw[1] * n[0])};
  T ft[3];
  limited_spring(step.kt, step.ct, step.relax_t, T(step.friction * pressing), n, vt, step.grow, history,
                 ft);
  const T mark = phase * rr;
  for (int d = 0; d < 3; d++) history[d] += mark * n[d];

  out.f[0] = fn * n[0] + ft[0];
  out.f[1] = fn * n[1] + ft[1];
  out.f[2] = fn * n[2] + ft[2];
  out.t[0] = n[1] * ft[2] - n[2] * ft[1];
  out.t[1] = n[2] * ft[0] - n[0] * ft[2];
  out.t[2] = n[0] * ft[1] - n[1] * ft[0];
  out.m[0] = out.m[1] = out.m[2] = T();
  if (!ROLLING) return;

  // rolling: the same construction on Rr (wi - wj) in the tangent plane, with torque arm Rr

  const T wn = c.w[0] * n[0] + c.w[1] * n[1] + c.w[2] * n[2];
  const T vr[3] = {rr * (c.w[0] - wn * n[0]), rr * (c.w[1] - wn * n[1]), rr * (c.w[2] - wn * n[2])};
  T fr[3];
  limited_spring(step.kr, step.cr, step.relax_r, T(step.rolling * pressing), n, vr, step.grow,
                 history + 3, fr);
  out.m[0] = rr * fr[0];
  out.m[1] = rr * fr[1];
  out.m[2] = rr * fr[2];
}

}    // namespace Slope

#endif

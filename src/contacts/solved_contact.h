/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact law of scheme solved: the same springs, dashpots and limits as in contact_force.h, with
   dashpots that act on the mean velocity over the time of a force. Pure functions, no LAMMPS. Units, T and N as in contact_force.h.
   Derivation: doc/src/theory.rst, Scheme solved. */

#ifndef SLOPE_SOLVED_CONTACT_H
#define SLOPE_SOLVED_CONTACT_H

#include "contact_force.h"

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

// Velocity Verlet hands over the overlap at the end of a step and asks for the force of a whole step, from
// the middle of this step to the middle of the next. The springs pull with the overlap, the dashpots with
// the mean velocity of these two middles, which the force itself decides (ball_solve.h). c here is the
// law's, corrected such that a lone contact has the restitution of the law at this step.
template <class N> struct SolvedStepOf {
  double dt;                   // s
  N kn, cn, kt, ct, kr, cr;    // N/m, N s/m
  N per_kt, per_kr;            // 1 / kt, 1 / kr; 0 without a spring
  double friction, rolling, fn_least;
};

// tanh(x), x >= 0, to 1e-7; no call, so that it takes four at a time
template <class N> SLOPE_INLINE N tangent_h(N x)
{
  const N y = 0.25 * smaller(x, all<N>(20.0)), y2 = y * y;    // of a quarter, doubled twice
  N t = y * (945.0 + y2 * (105.0 + y2)) / (945.0 + y2 * (420.0 + 15.0 * y2));
  t = 2.0 * t / (1.0 + t * t);
  return 2.0 * t / (1.0 + t * t);
}

// The dashpot, N s/m, that keeps the damping ratio of a spring k and a dashpot c over steps of dt: with
// a = k dt^2/m and h = c dt/(2 m), three successive overlaps obey
//   (1 + h') d(n+1) = (2 - a) d(n) - (1 - h') d(n-1),   h' = tanh(h sqrt(1 + (a + 4 h^2)/12)),
// an oscillation with the ratio of decay to frequency of the law, to a^2
template <class N> SLOPE_INLINE N step_dashpot(N k, N c, N inverse_mass, double dt)
{
  const N a = k * dt * dt * inverse_mass, h = 0.5 * c * dt * inverse_mass;
  const N per = 2.0 / (dt * inverse_mass);
  return per * tangent_h(N(h * root(N(1.0 + (a + 4.0 * h * h) / 12.0))));
}

// Spring and dashpot such that the steps are on the oscillation of k and c: h' = tanh(h),
// a' = 2 - (1 + h') 2 exp(-h) cos(sqrt(a - h^2)), the cosine as a series; overdamped, with q^2 = h^2 - a,
// a' = 2 - 2 cosh(q) / cosh(h), which is 0 without a spring
template <class N> SLOPE_INLINE void step_oscillator(N &k, N &c, N inverse_mass, double dt)
{
  const N a = k * dt * dt * inverse_mass, h = 0.5 * c * dt * inverse_mass;
  const N t = tangent_h(h), y = a - h * h;
  const N cosine =
      1.0 - y / 2.0 * (1.0 - y / 12.0 * (1.0 - y / 30.0 * (1.0 - y / 56.0 * (1.0 - y / 90.0))));
  const N decay = root(N((1.0 - t) / (1.0 + t)));    // exp(-h)
  N stiffness = 2.0 - 2.0 * (1.0 + t) * decay * cosine;
  if (bits(y < 0.0)) {    // rare: h of several, where the series fails
    const N q = root(larger(N(-y), N())), slow = a / (h + q);
    const N ratio =
        decay_factor(slow) * (1.0 + decay_factor(N(2.0 * q))) / (1.0 + decay_factor(N(2.0 * h)));
    stiffness = choose(y < 0.0, N(2.0 - 2.0 * ratio), stiffness);
  }
  c = t * 2.0 / (dt * inverse_mass);
  k = stiffness / (dt * dt * inverse_mass);
}

// inverse_mass (1/kg): 1/m_i + 1/m_j, where a fixed ball has none. mass_dashpot (kg): that of the
// conversion restitution -> dashpot. inverse_rolling (1/kg): 2.5 Rr^2 (1/(m_i R_i^2) + 1/(m_j R_j^2)),
// of solid spheres. dt (s) > 0
template <class N>
SLOPE_INLINE SolvedStepOf<N> solved_step(const ContactLaw &law, N inverse_mass, N mass_dashpot,
                                         N inverse_rolling, double dt)
{
  const N root_mass = root(mass_dashpot);
  SolvedStepOf<N> s;
  s.dt = dt;
  s.friction = law.friction;
  s.rolling = law.rolling;
  s.fn_least = law.fn_least;
  s.kn = N() + law.kn;
  s.kt = N() + law.kt;
  s.kr = N() + law.kr;
  s.cn = law.cn_given + law.cn_root * root_mass;
  s.ct = law.ct_given + law.ct_root * root_mass;
  s.cr = law.cr_given + law.cr_root * root_mass;
  s.cn = step_dashpot(s.kn, s.cn, inverse_mass, dt);
  step_oscillator(s.kt, s.ct, N(POINT * inverse_mass), dt);
  step_oscillator(s.kr, s.cr, inverse_rolling, dt);
  s.per_kt = law.kt > 0.0 ? N(1.0 / s.kt) : N();
  s.per_kr = law.kr > 0.0 ? N(1.0 / s.kr) : N();
  return s;
}

// the same for balls of these radii (m) and masses (kg)
template <class N>
SLOPE_INLINE SolvedStepOf<N> solved_step_of(const Sides &moves, const ContactLaw &law, double dt,
                                            N ri, N rj, N mi, N mj)
{
  const N inverse = moves.inverse_mass(mi, mj);
  return solved_step(law, inverse, N(moves.mass_factor(law) / inverse),
                     moves.inverse_rolling(law, ri, rj, mi, mj), dt);
}

template <class T, class N = T> struct SolvedContactOf : ContactOf<T, N> {
  T weight;    // of the normal dashpot in this step: 1 but in the first and the last one
  T beyond;    // stretch of the normal spring beyond the overlap, m
  T turn;      // what vn differs by in the middle of the time that this stands for, m/s
};

template <class T> struct SolvedForceOf : ContactForceOf<T> {
  T sticks, rolls;    // 1 where the tangential, the rolling force is below its limit, else 0
};

// s += u dt, kept in the plane of n
template <class T> SLOPE_INLINE void grow_spring(const T *n, const T *u, T dt, T *s)
{
  for (int d = 0; d < 3; d++) s[d] += u[d] * dt;
  const T sn = s[0] * n[0] + s[1] * n[1] + s[2] * n[2];
  for (int d = 0; d < 3; d++) s[d] -= sn * n[d];
}

// Spring and dashpot in the tangent plane with a limit, for sliding and for rolling alike:
// F = -k s - c u; if |F| exceeds the limit, F is cut to it and s is cut back to what gives the cut
// force: with F' = a F, s' = a s - (1 - a) c/k u. u must lie in the plane of n. per_k: 1 / k, 0
// without a spring. Returns a.
template <class T, class N>
SLOPE_INLINE T cut_spring(N k, T c, N per_k, T limit, const T *u, T *s, T *f)
{
  const T fx = k * s[0] + c * u[0];
  const T fy = k * s[1] + c * u[1];
  const T fz = k * s[2] + c * u[2];
  const T f2 = fx * fx + fy * fy + fz * fz;
  const T a = smaller(T(limit / f2 * root(f2)), all<T>(1.0));    // 1, too, if f2 = 0
  const T back = (1.0 - a) * c * per_k;
  f[0] = -a * fx;
  f[1] = -a * fy;
  f[2] = -a * fz;
  for (int d = 0; d < 3; d++) s[d] = a * s[d] - back * u[d];
  return a;
}

// rolling velocity Rr (wi - wj) in the tangent plane, m/s
template <class T, class N> SLOPE_INLINE void rolling_velocity(const ContactOf<T, N> &c, T *vr)
{
  const T *n = c.n;
  const T wn = c.w[0] * n[0] + c.w[1] * n[1] + c.w[2] * n[2];
  for (int d = 0; d < 3; d++) vr[d] = c.rolling_radius * (c.w[d] - wn * n[d]);
}

// Force of one contact moving with the velocities in c; its overlap is 0 if it has ended in this step.
// springs: sliding and rolling spring (3 each, m), cut back where they exceed their limit. ROLLING = false
// leaves out the rolling resistance, for laws that have none.
template <bool ROLLING = true, class T, class N>
SLOPE_INLINE void solved_force(const SolvedStepOf<N> &step, const SolvedContactOf<T, N> &c,
                               T *springs, SolvedForceOf<T> &out)
{
  const T vn = normal_velocity(c), elastic = step.kn * c.overlap;
  const T fn = larger(T(elastic + step.kn * c.beyond - step.cn * c.weight * (vn + c.turn)),
                      all<T>(step.fn_least));

  // friction and rolling are limited by a force without the weights, or they would depend on when in a step
  // contacts begin

  const T touches = choose(c.overlap > 0.0, all<T>(1.0), T());
  const T pressing = touches * larger(T(elastic + step.kn * c.beyond - step.cn * vn), T());
  T vt[3], ft[3], fr[3];
  sliding_velocity(c, vn, vt);
  const T a = cut_spring(step.kt, T(touches * step.ct), step.per_kt, T(step.friction * pressing),
                         vt, springs, ft);
  set_force(c, fn, ft, out);
  out.sticks = choose(a < 1.0, T(), touches);
  out.rolls = T();
  if (!ROLLING) return;

  rolling_velocity(c, vt);
  const T b = cut_spring(step.kr, T(touches * step.cr), step.per_kr, T(step.rolling * pressing), vt,
                         springs + 3, fr);
  out.rolls = choose(b < 1.0, T(), touches);
  for (int d = 0; d < 3; d++) out.m[d] = c.rolling_radius * fr[d];
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

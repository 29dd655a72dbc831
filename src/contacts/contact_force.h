/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact law: linear spring-dashpot, Coulomb friction with a tangential
   spring, rolling resistance with a rolling spring. One contact, pure functions,
   no LAMMPS. Nothing else computes a contact force. Derivations: doc/src/theory.rst.

   T is double, for one contact, or Four, for four at a time (SIMD): what differs
   between contacts is chosen, never branched on. N is the same, or double if all
   contacts share it.

   Units are SI: m, kg, s, N, rad. The normal n points from the partner to the ball.
*/

#ifndef SLOPE_CONTACT_FORCE_H
#define SLOPE_CONTACT_FORCE_H

#ifdef __FAST_MATH__
#error \
    "contacts that have just begun or ended need infinities and exact comparisons: build without -ffast-math"
#endif

#include "contact_law.h"
#include "lone_contact.h"
#include "simd4.h"

#include <algorithm>
#include <cmath>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

// ----------------------------------------------------------------------
// the law for balls of one mass and one time step
// ----------------------------------------------------------------------

// Velocity Verlet hands over the overlap d at the end of a step and the path V by which it grew
// in it (V = -vn dt), and the force F acts for a whole step: V becomes V - F dt^2/m. With the
// law's own F = kn d - cn vn (scheme plain) the restitution comes out too low, and scatters with
// where in the step the contact begins. Scheme exact takes
//
//   F = m/dt^2 [ w^2 dt^2 d + (1 - exp(-2 h)) V ],   w = sqrt(kn/m), h = cn dt/(2 m)
//
// and, for two balls that touch nothing else, follows the law's motion in closed form
// (lone_contact.h). With several contacts the dashpots are shared out: see crowd below.
// Derivation: doc/src/theory.rst.
template <class N> struct ContactStepOf {
  double dt, grow;         // s; grow: what the springs grow by, 0 at set-up
  N force;                 // m / dt^2: N per m
  N stiffness, damping;    // normal force in m: stiffness d + damping V
  N kt, ct, kr, cr;        // N/m, N s/m: as velocity Verlet needs them
  N taken_t, taken_r;      // share of the sliding and rolling motion that a dashpot takes in a step
  N per_kt, per_kr;        // 1 / kt, 1 / kr; 0 without a spring
  double shared;           // 1: dashpots of several contacts share what they take; 0: plain
  double friction, rolling, fn_least;
};
using ContactStep = ContactStepOf<double>;

// exp(-x), x >= 0, to 1e-9; no call, so that it takes four at a time
template <class N> SLOPE_INLINE N decay_factor(N x)
{
  const N y = 0.125 * smaller(x, all<N>(24.0));    // Pade approximant, to the eighth power
  const N even = 1.0 + 0.1 * y * y, odd = y * (0.5 + y * y / 120.0);
  N e = (even - odd) / (even + odd);
  e *= e;
  e *= e;
  return e * e;
}

// Stiffness over mass, k dt^2/m, that velocity Verlet needs to oscillate with the frequency of k:
// 2 - 2 cos(sqrt(a)) to a^3/240, and bounded
template <class N> SLOPE_INLINE N discrete(N a)
{
  return a / (1.0 + a / 12.0);
}

// inverse_mass (1/kg): 1/m_i + 1/m_j, where a fixed ball has none. mass_dashpot (kg): that of the
// conversion restitution -> dashpot. inverse_rolling (1/kg): 2.5 Rr^2 (1/(m_i R_i^2) + 1/(m_j R_j^2)),
// of solid spheres. dt (s) > 0; repeat: for the forces of the step that has just ended once more.
template <class N>
SLOPE_INLINE ContactStepOf<N> contact_step(const ContactLaw &law, N inverse_mass, N mass_dashpot,
                                           N inverse_rolling, double dt, bool repeat)
{
  const N root_mass = root(mass_dashpot);
  const N point = POINT * inverse_mass;
  const N cn = law.cn_given + law.cn_root * root_mass;
  const N ct = law.ct_given + law.ct_root * root_mass;
  const N cr = law.cr_given + law.cr_root * root_mass;
  ContactStepOf<N> s;
  s.dt = dt;
  s.grow = repeat ? 0.0 : dt;
  s.friction = law.friction;
  s.rolling = law.rolling;
  s.fn_least = law.fn_least;
  s.shared = law.exact;
  s.force = 1.0 / (inverse_mass * dt * dt);
  s.stiffness = law.kn / s.force;
  if (law.exact > 0.0) {
    s.damping = 1.0 - decay_factor(N(cn * dt * inverse_mass));
    s.taken_t = 1.0 - decay_factor(N(ct * dt * point));
    s.taken_r = 1.0 - decay_factor(N(cr * dt * inverse_rolling));
    s.kt = discrete(N(law.kt * dt * dt * point)) / (dt * dt * point);
    s.kr = discrete(N(law.kr * dt * dt * inverse_rolling)) / (dt * dt * inverse_rolling);
    s.ct = s.taken_t / (dt * point);
    s.cr = s.taken_r / (dt * inverse_rolling);
  } else {
    s.damping = cn * dt * inverse_mass;
    s.taken_t = s.taken_r = N();
    s.kt = N() + law.kt;
    s.kr = N() + law.kr;
    s.ct = ct;
    s.cr = cr;
  }
  s.per_kt = law.kt > 0.0 ? N(1.0 / s.kt) : N();
  s.per_kr = law.kr > 0.0 ? N(1.0 / s.kr) : N();
  return s;
}

// The oscillators of a lone contact; masses as for contact_step(). across (1/kg):
// 2.5 Rr (1/(m_i R_i) - 1/(m_j R_j)), how sliding and rolling act on each other
inline LoneContact lone_contact(const ContactLaw &law, double inverse_mass, double mass_dashpot,
                                double inverse_rolling, double across, double dt)
{
  const double root_mass = std::sqrt(mass_dashpot);
  const double half = 0.5 * dt, square = dt * dt;
  return LoneContact({(law.cn_given + law.cn_root * root_mass) * half * inverse_mass,
                      law.kn * square * inverse_mass},
                     {POINT * (law.ct_given + law.ct_root * root_mass) * half * inverse_mass,
                      POINT * law.kt * square * inverse_mass},
                     law.friction,
                     {{(law.cr_given + law.cr_root * root_mass) * half * inverse_rolling,
                       law.kr * square * inverse_rolling},
                      law.rolling,
                      inverse_rolling / inverse_mass,
                      across / inverse_mass});
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

// Spring and dashpot in the tangent plane with a limit, for sliding and for rolling alike:
// s += u dt, kept in the plane of n; F = -k s - c u; if |F| exceeds the limit, F is cut to it and
// s is cut back to what gives the cut force: with F' = a F, s' = a s - (1 - a) c/k u. u must lie in
// the plane of n. relax: c / k, 0 without a spring.
template <class T, class N>
SLOPE_INLINE void limited_spring(N k, T c, T relax, T limit, const T *n, const T *u, double dt,
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

// the part of c.v along n, m/s
template <class T, class N> SLOPE_INLINE T normal_velocity(const ContactOf<T, N> &c)
{
  return c.v[0] * c.n[0] + c.v[1] * c.n[1] + c.v[2] * c.n[2];
}

// velocity of the contact point in the tangent plane, m/s: v - vn n - (Ri wi + Rj wj) x n
template <class T, class N>
SLOPE_INLINE void sliding_velocity(const ContactOf<T, N> &c, T vn, T *vt)
{
  const T *n = c.n;
  vt[0] = c.v[0] - vn * n[0] - (c.rw[1] * n[2] - c.rw[2] * n[1]);
  vt[1] = c.v[1] - vn * n[1] - (c.rw[2] * n[0] - c.rw[0] * n[2]);
  vt[2] = c.v[2] - vn * n[2] - (c.rw[0] * n[1] - c.rw[1] * n[0]);
}

// force on the ball from its parts: fn along n, ft in the tangent plane
template <class T, class N>
SLOPE_INLINE void set_force(const ContactOf<T, N> &c, T fn, const T *ft, ContactForceOf<T> &out)
{
  const T *n = c.n;
  for (int d = 0; d < 3; d++) {
    out.f[d] = fn * n[d] + ft[d];
    out.m[d] = T();
  }
  out.t[0] = n[1] * ft[2] - n[2] * ft[1];
  out.t[1] = n[2] * ft[0] - n[0] * ft[2];
  out.t[2] = n[0] * ft[1] - n[1] * ft[0];
}

// Rolling: the same construction as sliding on Rr (wi - wj) in the tangent plane, torque arm Rr.
// The dashpots of sliding and of rolling act on the same spin: one more than those of sliding.
template <class T, class N>
SLOPE_INLINE void add_rolling(const ContactStepOf<N> &step, const ContactOf<T, N> &c, T crowd,
                              T pressing, T *spring, ContactForceOf<T> &out)
{
  const T *n = c.n;
  const N rr = c.rolling_radius;
  const T wn = c.w[0] * n[0] + c.w[1] * n[1] + c.w[2] * n[2];
  const T vr[3] = {rr * (c.w[0] - wn * n[0]), rr * (c.w[1] - wn * n[1]), rr * (c.w[2] - wn * n[2])};
  const T cr = step.cr / (1.0 + (2.0 * crowd + step.shared) * step.taken_r);
  T fr[3];
  limited_spring(step.kr, cr, T(cr * step.per_kr), T(step.rolling * pressing), n, vr, step.grow,
                 spring, fr);
  for (int d = 0; d < 3; d++) out.m[d] = rr * fr[d];
}

// Force of one touching contact. crowd: contacts that its balls have beside it, the larger number
// of the two; their dashpots together take no more of a motion in a step than one alone may: each
// is reduced by 1 / (1 + crowd * what it takes). history: the springs, updated.
// ROLLING = false leaves out the rolling resistance, for laws that have none.
template <bool ROLLING = true, class T, class N>
SLOPE_INLINE void contact_force(const ContactStepOf<N> &step, const ContactOf<T, N> &c, T crowd,
                                T *history, ContactForceOf<T> &out)
{
  const T *n = c.n;
  const T vn = normal_velocity(c);
  const T others = step.shared * crowd;
  const T F =
      step.stiffness * c.overlap - step.damping / (1.0 + others * step.damping) * vn * step.dt;
  const T fn = larger(T(F * step.force), all<T>(step.fn_least));
  const T pressing = larger(fn, T());

  T vt[3], ft[3];
  sliding_velocity(c, vn, vt);
  const T ct = step.ct / (1.0 + others * step.taken_t);
  limited_spring(step.kt, ct, T(ct * step.per_kt), T(step.friction * pressing), n, vt, step.grow,
                 history, ft);

  set_force(c, fn, ft, out);
  if (ROLLING) add_rolling(step, c, others, pressing, history + 3, out);
}

// a x b
inline void turn(const double *a, const double *b, double *out)
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

// v without its part along n
inline void flatten(const double *n, const double *v, double *out)
{
  const double along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  for (int d = 0; d < 3; d++) out[d] = v[d] - along * n[d];
}

// The same of a contact whose balls touch nothing else (in the step that it ends in they touch
// nothing at all). repeat: see contact_step. history: HISTORY values, updated. Returns false if repeat
// could only estimate the force.
template <bool ROLLING = true>
inline bool lone_contact_force(const ContactStep &step, const LoneContact &lone, Life life,
                               bool repeat, const Contact &c, double *history, ContactForce &out)
{
  const double *n = c.n;
  const double vn = normal_velocity(c);
  const double age = std::floor(history[PHASE]) - (repeat ? 1.0 : 0.0);    // before this step
  const bool grazes = life == BEGINS && !(vn < 0.0);                       // and parts already
  if (grazes || (life == LASTS && age >= lone.longest)) {
    contact_force<ROLLING>(step, c, 0.0, history, out);
    history[PHASE] = grazes ? BEGAN_IN_CROWD : LASTING;
    return true;
  }
  const double rr = c.rolling_radius;
  double vt[3], U[3], w[3], Y[3];
  sliding_velocity(c, vn, vt);
  const double wn = c.w[0] * n[0] + c.w[1] * n[1] + c.w[2] * n[2];
  for (int d = 0; d < 3; d++) {
    U[d] = vt[d] * step.dt;
    w[d] = rr * step.dt * (c.w[d] - wn * n[d]);
  }
  turn(n, w, Y);
  LoneContact::Springs springs;
  LoneContact::Kick kick;
  flatten(n, history, springs.slide);
  double rho[3];
  flatten(n, history + 3, rho);
  turn(n, rho, springs.roll);
  const bool slid = lone.kick(life, repeat, has_slid(history[PHASE]), c.overlap, -vn * step.dt, U,
                              Y, springs, kick);

  const double fn = std::max(kick.n * step.force, step.fn_least);
  double ft[3], fr[3];
  for (int d = 0; d < 3; d++) {
    history[d] = springs.slide[d];
    ft[d] = -kick.slide[d] * step.force;
    fr[d] = -kick.roll[d] * step.force;
  }
  set_force(c, fn, ft, out);
  if (ROLLING) {
    turn(fr, n, out.m);    // back: n x (n x v) = -v
    turn(springs.roll, n, history + 3);
    for (int d = 0; d < 3; d++) out.m[d] *= rr;
  }
  if (repeat) return !slid;
  history[PHASE] = life == ENDS ? static_cast<double>(ENDED)
                                : (life == BEGINS ? 1.0 : age + 1.0) + (slid ? SLID : 0.0);
  return true;
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

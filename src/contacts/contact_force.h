// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The force of one contact: linear spring-dashpot, Coulomb friction with a tangential
   spring, rolling resistance with a rolling spring; pure functions, no LAMMPS. Nothing else computes a contact force.
   The coefficients are in contact_law.h, what a time step makes of them in contact_step.h, where T and N are explained, too.
   Derivations: doc/src/theory.rst.

   Units are SI: m, kg, s, N, rad. The normal n points from the partner to the ball.
*/

#ifndef SLOPE_CONTACT_FORCE_H
#define SLOPE_CONTACT_FORCE_H

#include "contact_step.h"

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

template <class T, class N = T> struct ContactOf {
  T n[3];              // unit normal, partner to ball
  T overlap;           // m; < 0 if the contact has ended
  T v[3];              // velocity of the ball minus that of the partner, m/s
  T ahead;             // normal velocity that the dashpot acts on, of MovingBalls::ahead, m/s
  T rw[3];             // R_i w_i + R_j w_j, m/s
  T w[3];              // w_i - w_j, rad/s
  N rolling_radius;    // m
  T along;             // contacts of its balls that act along n, itself included

  // 1 (weight, touches, grown) or 0 (the others), but in the steps in which the contact begins and ends: see
  // ContactPasses::find_times()
  T weight;    // of the normal dashpot
  T beyond;    // stretch of the normal spring beyond the overlap, m
  T first;     // 1 in the first step, 0 in others
  T turn;    // what the normal velocity differs by in the middle of the time that it stands for, m/s
  T touches;    // 0 if the contact has ended
  T grown;      // part of the step in which the springs grow
  T early;      // time that the sliding spring is ahead, s

  SLOPE_INLINE void follow_whole_step()
  {
    along = weight = touches = grown = all<T>(1.0);
    beyond = turn = first = early = T();
  }
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
SLOPE_INLINE void limited_spring(N k, T c, T relax, T limit, const T *n, const T *u, T dt, T *s,
                                 T *f)
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
  const T a = smaller(over_root(limit, f2), all<T>(1.0));    // 1, too, if f2 = 0
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

// Number of contacts of the two balls of one, itself included, each weighted with the ball's share in its mass
template <class T, class N>
SLOPE_INLINE T mean_contacts(const ContactStepOf<N> &step, T contacts_i, T contacts_j)
{
  return contacts_j + step.share_i * (contacts_i - contacts_j);
}

// Factor of a sliding or rolling dashpot that takes so much of a motion in a step, beside others of the same ball: their
// sum is held to so much. In three dimensions n sliding contacts resist a spin as 0.48 n along it would, rolling ones as
// 0.67 n: with the numbers below they take at most 0.57 and 0.5 of it on average, and less than 2 in the directions that
// they resist most, springs included.
static constexpr double MOST_SLIDING = 1.2, MOST_ROLLING = 0.75;
template <class T, class N> SLOPE_INLINE T held_back(N taken, T contacts, double most)
{
  return most / larger(T(taken * contacts), all<T>(most));
}

// Contacts of a ball that act along the normal of one, itself included: contacts with normals n_k are as
// sum_k (n n_k)^2 parallel ones, for a symmetric group n sum_k n_k. Of fixed balls all may lie in one direction, so
// their normals are summed up; those that move add a third, as in all directions.
template <class T> SLOPE_INLINE T along_fixed(const T *n, const T *normals, T fixed, T contacts)
{
  const T facing = n[0] * normals[0] + n[1] * normals[1] + n[2] * normals[2];
  return larger(facing, T()) + (1.0 / 3.0) * (contacts - fixed);
}

// Balls that move do not overlap: two of a few contacts lie in one direction, half of many at most
template <class T> SLOPE_INLINE T along_moving(T contacts)
{
  return larger(smaller(contacts, all<T>(2.0)), T(0.5 * contacts));
}

// n parallel contacts are one of n times the spring a and the dashpot H. Its steps are stable for n (a + 3 H) < 4, and
// for n (a + 2 H) < 4 if dashpots act on the velocities of the middle: these do where n (H + a/4) exceeds MOST_AHEAD,
// which leaves room for the weight of a first step, up to 3/2, and they are held to n H < MOST_NORMAL - n a/2. The H with
// which n have the law's damping ratio is less than that of one, because each of these corrects for its own spring and
// dashpot alone: by 0.36 (n - 1) a, of those of the middle by H - a and (n - 1) H (tests/step_restitution.py).
static constexpr double MOST_NORMAL = 1.9, MOST_AHEAD = 1.1;
template <class T, class N>
SLOPE_INLINE auto crowded(const ContactStepOf<N> &step, T along) -> decltype(along > along)
{
  return T((step.taken_n + 0.25 * step.spring_n) * along) > all<T>(MOST_AHEAD);
}

// Factor of the normal dashpot of one of so many; 1 of a lone one
template <class T, class N> SLOPE_INLINE T acting_together(const ContactStepOf<N> &step, T along)
{
  const N taken = step.taken_n, spring = step.spring_n;
  const auto late = crowded(step, along);
  const N both =
      1.0 - 2.0 * step.share_i * (1.0 - step.share_i);    // 1/2 of equal balls: each has others
  const T others = both * larger(T(along - 1.0), T());
  const T up = choose(late, T(1.0 - AHEAD * (taken - spring) + T()), all<T>(1.0));
  const T down = 1.0 + others * choose(late, T(0.2 * taken + T()), T(0.36 * spring + T()));
  const T most = larger(T(MOST_NORMAL - 0.5 * spring * along), all<T>(0.25 * MOST_NORMAL));
  const T sum = taken * along;
  const auto free = T(up * sum) < T(most * down);
  return choose(free, up, most) / choose(free, down, sum);
}

// What other contacts of its balls make of the dashpots of one: factors of those along the normal, of sliding and of
// rolling; contacts as for held_back()
template <class T> struct CompanyOf {
  T normal, sliding, rolling;
};
template <class T, class N>
SLOPE_INLINE CompanyOf<T> company_of(const ContactStepOf<N> &step, T along, T contacts)
{
  return {acting_together(step, along), held_back(step.taken_t, contacts, MOST_SLIDING),
          held_back(step.taken_r, contacts, MOST_ROLLING)};
}

// In a step in which crowded contacts begin or end they take at most all of the motion: the weights of up to 3/2 would
// make them turn it around.
template <class T, class N>
SLOPE_INLINE void hold_beginning(const ContactStepOf<N> &step, ContactOf<T, N> &c)
{
  const T taken = step.taken_n * c.along * acting_together(step, c.along);
  const T most = larger(T(1.0 / taken), all<T>(0.5));
  c.weight = choose(crowded(step, c.along), smaller(c.weight, most), c.weight);
}

// Rolling: the same construction as sliding on Rr (wi - wj) in the tangent plane, torque arm Rr.
// The dashpots of sliding and of rolling act on the same spin: one more than those of sliding.
template <class T, class N>
SLOPE_INLINE void add_rolling(const ContactStepOf<N> &step, const ContactOf<T, N> &c, T held,
                              T pressing, T *spring, ContactForceOf<T> &out)
{
  const T *n = c.n;
  const N rr = c.rolling_radius;
  const T wn = c.w[0] * n[0] + c.w[1] * n[1] + c.w[2] * n[2];
  const T vr[3] = {rr * (c.w[0] - wn * n[0]), rr * (c.w[1] - wn * n[1]), rr * (c.w[2] - wn * n[2])};
  const T cr = c.touches * step.cr * held;
  T fr[3];
  limited_spring(step.kr, cr, T(cr * step.per_kr), T(step.rolling * pressing), n, vr,
                 T(step.grow * c.grown), spring, fr);
  for (int d = 0; d < 3; d++) out.m[d] = rr * fr[d];
}

// Force of one contact. history: the springs, updated.
// ROLLING = false leaves out the rolling resistance, for laws that have none; WHOLE: of a contact that touches for the whole
// step, follow_whole_step().
template <bool ROLLING = true, bool WHOLE = false, class T, class N>
SLOPE_INLINE void contact_force(const ContactStepOf<N> &step, const ContactOf<T, N> &c,
                                const CompanyOf<T> &company, T *history, ContactForceOf<T> &out)
{
  const T *n = c.n;
  const T vn = normal_velocity(c), zero = T();
  const T pressed = larger(c.overlap, zero);
  const T elastic = spring_force(step, WHOLE ? pressed : T(pressed + c.beyond));
  const T cn = step.cn * company.normal;
  const T ahead = choose(crowded(step, c.along), vn, c.ahead);
  T damping = cn * ahead, limited = damping;
  if (!WHOLE) {
    const T own =
        1.0 + AHEAD * c.first * c.weight * step.taken_n;    // its force is not in c.ahead yet
    damping = cn * c.weight * (ahead + c.turn) / own;
    limited = cn * ahead / own;
  }
  const T fn = larger(T(elastic - damping), all<T>(step.fn_least));

  // friction and rolling are limited by a force without the weight, or they would depend on when in a step
  // contacts begin

  const T pressing = c.touches * larger(T(elastic - limited), zero);
  T vt[3], ft[3];
  sliding_velocity(c, vn, vt);
  T ct = c.touches * step.ct * company.sliding;
  if (!WHOLE) ct += step.kt * c.early;
  limited_spring(step.kt, ct, T(ct * step.per_kt), T(step.friction * pressing), n, vt,
                 T(step.grow * c.grown), history, ft);

  set_force(c, fn, ft, out);
  if (ROLLING) add_rolling(step, c, company.rolling, pressing, history + 3, out);
}

// contacts: see mean_contacts()
template <bool ROLLING = true, class T, class N>
SLOPE_INLINE void contact_force(const ContactStepOf<N> &step, const ContactOf<T, N> &c, T contacts,
                                T *history, ContactForceOf<T> &out)
{
  contact_force<ROLLING>(step, c, company_of(step, c.along, contacts), history, out);
}

// v without its part along n
inline void flatten(const double *n, const double *v, double *out)
{
  const double along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
  for (int d = 0; d < 3; d++) out[d] = v[d] - along * n[d];
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What a time step makes of a law, for balls of given sizes: springs and dashpots as velocity Verlet needs them. From the
   coefficients, contact_law.h, to what contact_force() of contact_force.h evaluates. Derivations: doc/src/theory.rst.

   T is double, for one contact, or Four or Eight, for several at a time (SIMD): what differs
   between contacts is chosen, never branched on. N is the same, or double if all
   contacts share it. No LAMMPS.
*/

#ifndef SLOPE_CONTACT_STEP_H
#define SLOPE_CONTACT_STEP_H

#ifdef __FAST_MATH__
#error \
    "contacts that have just begun or ended need infinities and exact comparisons: build without -ffast-math"
#endif

#include "contact_law.h"
#include "simd4.h"

namespace Slope {

// What a step makes of the law, in two parts: what depends on the sizes of the balls, and is kept for each
// contact where they differ (contact_rows.h), N's alone; and what all contacts share.
template <class N> struct ContactOwnOf {
  N cn, kt, ct, kr, cr;           // N/m, N s/m: as velocity Verlet needs them
  N taken_n, taken_t, taken_r;    // share of a motion that its dashpot takes in a step; 0: plain
  N per_kt, per_kr;               // 1 / kt, 1 / kr; 0 without a spring
  N spring_n;                     // kn dt^2 over the contact's mass; 0: plain
  N share_i;    // of the ball in the inverse of the contact's mass; 1 - share_i: of the partner
};
struct ContactShared {
  double dt, grow;    // s; grow: what the springs grow by, 0 at set-up
  double kn;          // N/m
  double friction, rolling, fn_least;
};
template <class N> struct ContactStepOf : ContactShared, ContactOwnOf<N> {
};
using ContactStep = ContactStepOf<double>;

inline namespace SLOPE_INSTRUCTIONS {

// a solid sphere's contact point moves as 2/7 of the mass: translation and spin together
static constexpr double POINT = 3.5;

// Velocity Verlet hands over the overlap at the end of a step and the velocities of its middle, and the force
// acts for a whole step. With the law's own coefficients (scheme plain) the restitution comes out too low, and
// scatters with where in the step a contact begins. Scheme exact
//   has the normal dashpots act on velocities that are AHEAD dt nearer to those of the overlap, as the last
//   step's forces change them (MovingBalls::ahead);
//   takes other coefficients, with which the steps of a lone contact lie on an oscillation of the law's
//   damping ratio (contact_step());
//   gives the steps in which a contact begins and ends the part of the dashpot that is theirs (ContactOf of contact_force.h);
//   gives contacts of a ball that has several the dashpots of contacts that act together, and less where they would
//   take more of a motion than there is (acting_together(), held_back(), there, too).
// Derivation: doc/src/theory.rst.
static constexpr double AHEAD = 0.25;

// exp(-x), x >= 0, to 3e-8, and to 5e-9 of itself up to x = 2; no call, so that it takes several at a time
template <class N> SLOPE_INLINE N decay_factor(N x)
{
  const N y = 0.125 * smaller(x, all<N>(24.0));    // Pade approximant, to the eighth power
  const N even = 1.0 + 0.1 * y * y, odd = y * (0.5 + y * y / 120.0);
  N e = (even - odd) / (even + odd);
  e *= e;
  e *= e;
  return e * e;
}

// Share H of a motion that a dashpot must take in a step of velocity Verlet, so that the steps have the damping
// ratio of spring and dashpot, and so their restitution, although the spring stays as it is, if the dashpot
// acts on velocities that are half a step late: with a = k dt^2/m and h = c dt/(2 m) the overlaps obey
// d(n+1) = (2 - a - H) d(n) - (1 - H) d(n-1), and H = 1 - exp(-2 f h), where f solves
// cos(f sqrt(a - h^2)) = cosh(f h) - a/2 exp(f h). The series of f is that of exp(f h / 2) = f, with a
// correction for a.
template <class N> SLOPE_INLINE N share_if_late(N a, N h)
{
  const N x = smaller(N(0.5 * h), all<N>(0.25));
  const N f = 1.0 + x * (1.0 + x * (1.5 + x * (8.0 / 3.0 + x * 125.0 / 24.0)));
  const N more = f * f * (a - 8.0 * x * x) / (12.0 * (2.0 - 2.0 * x * f));
  return 1.0 - decay_factor(N(2.0 * f * (1.0 + more) * h));
}

// The same if it acts on velocities that are AHEAD of those: to the first order in AHEAD the steps are those
// of a late dashpot of H (1 - AHEAD (H (1 + h) - a)) with a spring of a (1 - AHEAD H). H is right to
// 5e-3 for a <= 1/8 (unit test); overdamped contacts take MOST_TAKEN, with which the steps are stable.
static constexpr double MOST_TAKEN = 0.9;
template <class N> SLOPE_INLINE N share_taken(N a, N h)
{
  const N late = share_if_late(a, h), softer = 1.0 - AHEAD * late;
  const N more = AHEAD * (late * (1.0 + smaller(h, all<N>(0.5))) - a);
  const N share = share_if_late(N(a * softer), N(h * root(softer))) / (1.0 - more);
  return smaller(share, all<N>(MOST_TAKEN));
}

// The share with a spring that changes, too: the steps are then on the oscillation itself, damped or
// overdamped. Returns the spring's a; H = 1 - exp(-2 h).
template <class N> SLOPE_INLINE N stepped_spring(N a, N h)
{
  const N zero = N(), y = a - h * h, decay = decay_factor(h);
  const N w = smaller(larger(y, zero), all<N>(4.0)), q = root(N(larger(N(-y), zero)));
  const N cosine =
      1.0 - w / 2.0 * (1.0 - w / 12.0 * (1.0 - w / 30.0 * (1.0 - w / 56.0 * (1.0 - w / 90.0))));
  const N slow = decay_factor(N(a / larger(N(h + q), all<N>(1.0e-30)))),
          fast = decay_factor(N(h + q));
  return 1.0 + decay * decay - choose(y < zero, N(slow + fast), N(2.0 * decay * cosine));
}

// inverse_i, inverse_j (1/kg): 1/m_i and 1/m_j, 0 of a fixed ball. mass_dashpot (kg): that of the
// conversion restitution -> dashpot. inverse_rolling (1/kg): 2.5 Rr^2 (1/(m_i R_i^2) + 1/(m_j R_j^2)),
// of solid spheres. dt (s) > 0; repeat: for the forces of the step that has just ended once more.
template <class N>
SLOPE_INLINE ContactStepOf<N> contact_step(const ContactLaw &law, N inverse_i, N inverse_j,
                                           N mass_dashpot, N inverse_rolling, double dt,
                                           bool repeat)
{
  const N root_mass = root(mass_dashpot);
  const N inverse = inverse_i + inverse_j, point = POINT * inverse;
  ContactStepOf<N> s;
  s.dt = dt;
  s.grow = repeat ? 0.0 : dt;
  s.friction = law.friction;
  s.rolling = law.rolling;
  s.fn_least = law.fn_least;
  s.share_i = inverse_i / inverse;
  s.kn = law.kn;
  const N cn = law.cn_given + law.cn_root * root_mass, ct = law.ct_given + law.ct_root * root_mass,
          cr = law.cr_given + law.cr_root * root_mass;    // the law's own
  if (law.exact > 0.0) {
    const double square = dt * dt, half = 0.5 * dt;
    s.spring_n = s.kn * square * inverse;
    s.taken_n = share_taken(s.spring_n, N(cn * half * inverse));
    s.taken_t = 1.0 - decay_factor(N(ct * dt * point));
    s.taken_r = 1.0 - decay_factor(N(cr * dt * inverse_rolling));
    s.cn = s.taken_n / (dt * inverse);
    s.ct = s.taken_t / (dt * point);
    s.cr = s.taken_r / (dt * inverse_rolling);
    s.kt = stepped_spring(N(law.kt * square * point), N(ct * half * point)) / (square * point);
    s.kr = stepped_spring(N(law.kr * square * inverse_rolling), N(cr * half * inverse_rolling)) /
        (square * inverse_rolling);
  } else {
    s.spring_n = s.taken_n = s.taken_t = s.taken_r = N();
    s.cn = cn;
    s.ct = ct;
    s.cr = cr;
    s.kt = N() + law.kt;
    s.kr = N() + law.kr;
  }
  s.per_kt = law.kt > 0.0 ? N(1.0 / s.kt) : N();
  s.per_kr = law.kr > 0.0 ? N(1.0 / s.kr) : N();
  return s;
}

// the law for balls of these radii (m) and masses (kg), time step dt (s); repeat as for contact_step()
template <class N>
SLOPE_INLINE ContactStepOf<N> step_of(const Sides &moves, const ContactLaw &law, double dt,
                                      bool repeat, N ri, N rj, N mi, N mj)
{
  return contact_step(law, N(moves.i / mi), N(moves.j / mj),
                      N(moves.mass_factor(law) / moves.inverse_mass(mi, mj)),
                      moves.inverse_rolling(law, ri, rj, mi, mj), dt, repeat);
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact law: linear spring-dashpot, Coulomb friction with a tangential
   spring, rolling resistance with a rolling spring. One contact, pure functions,
   no LAMMPS. Pair gran/restitution and fix wall/gran/balls both call it; nothing
   else computes a contact force. Derivations: doc/src/theory.rst.

   Units are SI: m, kg, s, N, rad. The normal n points from the partner to the ball.
*/

#ifndef SLOPE_CONTACT_LAW_H
#define SLOPE_CONTACT_LAW_H

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
  double predicted;                     // 1: scheme predicted, 0: plain (see contact_force)

  // mass (kg) in c = 2 zeta sqrt(k m): two moving balls, or a ball on a fixed one
  double mass(double mi, double mj) const { return mass_factor * mi * mj / (mi + mj); }
  double mass_fixed(double mi) const { return mi; }

  double cn(double m) const { return cn_given + cn_root * std::sqrt(m); }
};

// ----------------------------------------------------------------------
// one contact
// ----------------------------------------------------------------------

// Values carried from step to step: tangential spring (m), rolling spring (m).
// Seen from the partner both change sign, as LAMMPS' neighbor history assumes.
static constexpr int HISTORY = 6;

struct Contact {
  double n[3];       // unit normal, partner to ball
  double overlap;    // m, > 0
  double v[3];       // velocity of the ball minus that of the partner, m/s
  double rw[3];      // R_i w_i + R_j w_j, m/s
  double w[3];       // w_i - w_j, rad/s
  double rolling_radius;    // m
  double mass;              // kg, in the conversion restitution -> dashpot
  double inverse_mass;      // 1/kg, 1/m_i + 1/m_j; a fixed partner has none
  double fresh;             // 1: did not touch a step ago, else 0
};

struct ContactForce {
  double f[3];      // on the ball, N; the partner gets the opposite
  double t[3];      // n x Ft, N: torque on the ball is -R_i t + m, on the partner -R_j t - m
  double m[3];      // rolling torque on the ball, N m
};

// Spring and dashpot in the tangent plane with a limit, for sliding and for rolling alike:
// s += u dt, kept in the plane of n; F = -k s - c (u + yield F); if |F| exceeds the limit, F is
// cut to it and s is cut back to what gives the cut force. u must lie in the plane of n.
// yield: what half a step of unit force adds to u, so that the dashpot sees u at its end.
inline void limited_spring(double k, double c, double limit, const double *n, const double *u,
                           double dt, double yield, double *s, double *f)
{
  double sx = s[0] + u[0] * dt;
  double sy = s[1] + u[1] * dt;
  double sz = s[2] + u[2] * dt;
  const double sn = sx * n[0] + sy * n[1] + sz * n[2];
  sx -= sn * n[0];
  sy -= sn * n[1];
  sz -= sn * n[2];

  const double stiffer = 1.0 + c * yield;
  const double implicit = 1.0 / stiffer;
  const double fx = -implicit * (k * sx + c * u[0]);
  const double fy = -implicit * (k * sy + c * u[1]);
  const double fz = -implicit * (k * sz + c * u[2]);
  const double f2 = fx * fx + fy * fy + fz * fz;

  // selects, not branches, so that the compiler can vectorise a loop over contacts

  const bool cut = f2 > limit * limit;
  const double scale = cut ? limit / std::sqrt(cut ? f2 : 1.0) : 1.0;
  const double kinv = (cut && k > 0.0) ? 1.0 / k : 0.0;
  f[0] = scale * fx;
  f[1] = scale * fy;
  f[2] = scale * fz;
  s[0] = cut ? -(stiffer * f[0] + c * u[0]) * kinv : sx;
  s[1] = cut ? -(stiffer * f[1] + c * u[1]) * kinv : sy;
  s[2] = cut ? -(stiffer * f[2] + c * u[2]) * kinv : sz;
}

// Force of one touching contact. dt: the step by which the springs grow; 0 leaves their
// length as it is (set-up). history: HISTORY values, updated. ROLLING = false leaves out the
// rolling resistance, for laws that have none.
//
// Velocity Verlet hands over positions at the end of the step and velocities half a step
// earlier, and the force acts for a whole step. Used as they are (scheme plain), restitution
// comes out too low and scatters with where in the step the contact begins. Scheme predicted
// (a) takes the velocity of the dashpot half a step on, from the contact's own force:
//     F = (k d - c v) / (1 + c dt / (2 m)), solved in closed form, and
// (b) in the first and the last step of a contact applies the impulse of the part of the step
//     in which the balls touch: tau = d / |vn| is the time since (until) first (last) touch.
template <bool ROLLING = true>
inline void contact_force(const ContactLaw &law, const Contact &c, double dt, double *history,
                          ContactForce &out)
{
  const double *n = c.n;
  const double root = std::sqrt(c.mass);
  const double half = 0.5 * dt * law.predicted * c.inverse_mass;    // velocity per unit force

  // normal: Fn = kn d - cn vn

  const double vn = c.v[0] * n[0] + c.v[1] * n[1] + c.v[2] * n[2];
  const double cn = law.cn_given + law.cn_root * root;
  const double swept = std::fabs(vn) * dt * law.predicted;    // path of a step
  const bool part = c.overlap < swept && (vn > 0.0 || c.fresh > 0.0);
  const double share = part ? 0.5 + c.overlap / (part ? swept : 1.0) : 1.0;    // of the step
  const double spring = law.kn * (part ? 0.5 * swept * share * share : c.overlap);
  double fn = (spring - share * cn * vn) / (1.0 + share * cn * half);
  fn = fn > law.fn_least ? fn : law.fn_least;
  const double pressing = fn > 0.0 ? fn : 0.0;

  // tangential: vt = v - vn n - (Ri wi + Rj wj) x n; a solid ball yields 3.5 times as easily

  const double vt[3] = {c.v[0] - vn * n[0] - (c.rw[1] * n[2] - c.rw[2] * n[1]),
                        c.v[1] - vn * n[1] - (c.rw[2] * n[0] - c.rw[0] * n[2]),
                        c.v[2] - vn * n[2] - (c.rw[0] * n[1] - c.rw[1] * n[0])};
  double ft[3];
  limited_spring(law.kt, law.ct_given + law.ct_root * root, law.friction * pressing, n, vt, dt,
                 3.5 * half, history, ft);

  out.f[0] = fn * n[0] + ft[0];
  out.f[1] = fn * n[1] + ft[1];
  out.f[2] = fn * n[2] + ft[2];
  out.t[0] = n[1] * ft[2] - n[2] * ft[1];
  out.t[1] = n[2] * ft[0] - n[0] * ft[2];
  out.t[2] = n[0] * ft[1] - n[1] * ft[0];
  out.m[0] = out.m[1] = out.m[2] = 0.0;
  if (!ROLLING) return;

  // rolling: the same construction on Rr (wi - wj) in the tangent plane, with torque arm Rr

  const double wn = c.w[0] * n[0] + c.w[1] * n[1] + c.w[2] * n[2];
  const double rr = c.rolling_radius;
  const double vr[3] = {rr * (c.w[0] - wn * n[0]), rr * (c.w[1] - wn * n[1]),
                        rr * (c.w[2] - wn * n[2])};
  double fr[3];
  limited_spring(law.kr, law.cr_given + law.cr_root * root, law.rolling * pressing, n, vr, dt,
                 2.5 * half, history + 3, fr);
  out.m[0] = rr * fr[0];
  out.m[1] = rr * fr[1];
  out.m[2] = rr * fr[2];
}

}    // namespace Slope

#endif

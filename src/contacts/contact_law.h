// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What one pair of atom types needs of the contact law, and what a contact remembers from step to
   step. ContactCoeffs::law() fills it from the words of pair_coeff; contact_step() of contact_step.h makes of it what
   contact_force() of contact_force.h evaluates. No LAMMPS. Derivations: doc/src/theory.rst.

   Units are SI: m, kg, s, N, rad. */

#ifndef SLOPE_CONTACT_LAW_H
#define SLOPE_CONTACT_LAW_H

#include "constants.h"
#include "instruction_set.h"

#include <cmath>

namespace Slope {

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

struct SpringDashpot {
  double k, c;    // N/m, N s/m

  double damping_ratio(double m) const { return c / (2.0 * std::sqrt(k * m)); }    // of a mass, kg
};

// What one pair of types needs per contact. A dashpot is either a number given by the user
// (N s/m) or follows from a restitution and then grows with the root of the contact's mass:
// c = c_given + c_root * sqrt(m). One of the two is zero.
struct ContactLaw {
  double kn, kt, kr;                      // normal, tangential, rolling stiffness, N/m
  double cn_given, ct_given, cr_given;    // dashpots, N s/m
  double cn_root, ct_root, cr_root;       // dashpots per root of mass, N s/(m sqrt(kg))
  double friction;                        // tan of the friction angle
  double rolling;                         // rolling resistance coefficient mu_r
  double mass_factor;                     // 1: reduced mass, 2: mass of one of two equal balls
  double rolling_factor;                  // 2: harmonic mean radius, 1: reduced radius
  double fn_least;    // smallest normal force: -HUGE_VAL, or 0 when it must not pull
  double exact;       // 1: scheme exact, 0: plain (see contact_step())

  // spring and dashpot of a contact of mass m (kg)
  SpringDashpot normal(double m) const { return {kn, cn_given + cn_root * std::sqrt(m)}; }

  // overlap (m) that a ball of mass m reaches on a fixed surface which it hits at a speed (m/s), undamped
  double depth(double m, double speed) const { return speed * std::sqrt(m / kn); }
};

// Distance of the centres, m, at which balls of these radii (m) touch. Neighbours in a lattice are apart by the sum of
// their radii to within rounding, which differs from rank to rank; this is less by a tenth of a millionth of a
// diameter, which rounding does not bridge. The share is that of the smaller ball where one is a floor.
template <class N> SLOPE_INLINE N touching(N ri, N rj)
{
  return ri + rj - 4.0e-7 * ri * rj / (ri + rj);
}

// The normal spring at an overlap (m): its force, N, and what it holds, J. Law: the law, or a step.
template <class Law, class T> SLOPE_INLINE T spring_force(const Law &law, T overlap)
{
  return law.kn * overlap;
}
template <class Law, class T> SLOPE_INLINE T spring_energy(const Law &law, T overlap)
{
  return 0.5 * spring_force(law, overlap) * overlap;
}

// ----------------------------------------------------------------------
// the two sides of a contact
// ----------------------------------------------------------------------

// 1 for a side that moves, 0 for one that is fixed and as good as infinitely heavy
struct Sides {
  double i, j;

  // of the contact's mass, in the dashpots that follow from a restitution
  SLOPE_INLINE double mass_factor(const ContactLaw &law) const
  {
    return i * j > 0.0 ? law.mass_factor : 1.0;
  }

  // 1/kg
  template <class N> SLOPE_INLINE N inverse_mass(N mi, N mj) const { return i / mi + j / mj; }

  // 2.5 Rr^2 (1/(m_i R_i^2) + 1/(m_j R_j^2)), 1/kg: how a rolling torque turns two solid spheres
  template <class N>
  SLOPE_INLINE N inverse_rolling(const ContactLaw &law, N ri, N rj, N mi, N mj) const
  {
    const N rr = law.rolling_factor * ri * rj / (ri + rj);
    return 2.5 * rr * rr * (i / (mi * ri * ri) + j / (mj * rj * rj));
  }
};

// ----------------------------------------------------------------------
// the history of a contact
// ----------------------------------------------------------------------

// Values carried from step to step: sliding spring (3, m), rolling spring (3, m), age. Seen from the
// partner the springs change sign, the age does not.
static constexpr int HISTORY = 7;
static constexpr int AGE = 6;

// Age of a contact after a step, scheme exact: the part of the step for which it has touched, if it began in
// it; otherwise OLD. With a minus sign if it came apart in the step.
static constexpr double OLD = 2.0;

SLOPE_INLINE bool has_ended(double age)
{
  return age < 0.0;
}
SLOPE_INLINE bool is_new(double age)
{
  return age > 0.0 && age <= 1.0;
}

}    // namespace Slope

#endif

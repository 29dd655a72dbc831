/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The force that the contact law has at the end of a step in the impact of a ball on something fixed.
   What velocity Verlet is handed over for a step is another number: the change of momentum between the
   middles of two steps, from the beginning of the impact on in its first step, of a motion that is a
   little faster than the law's (theory: a force as a step needs it). No LAMMPS. */

#ifndef SLOPE_IMPACT_FORCE_H
#define SLOPE_IMPACT_FORCE_H

#include "contact_law.h"
#include "oscillator.h"

#include <algorithm>
#include <cmath>

namespace Slope {

class ImpactForce {
 public:
  // ball of this mass (kg), step (s)
  ImpactForce(const ContactLaw &law, double ball_mass, double dt) :
      mass(ball_mass), least(law.fn_least)
  {
    const double a = law.kn * dt * dt / mass;
    followed = true_at_rest({law.cn(mass) * 0.5 * dt / mass, a});
    step = followed.after(1.0);
    hurry = std::sqrt(followed.a / a);
    fast = 1.0 + followed.stiffness() / 12.0;
    newtons = mass / (dt * dt) / (hurry * fast);
  }

  double of_mass() const { return mass; }

  // Force (N) of a contact that is an impact of a phase (contact_law.h) at overlap d (m), which grew by V (m)
  // in the step; negative where the dashpot pulls.
  double normal(double phase, double d, double V) const
  {
    double rate;
    if (is_new_impact(phase)) {
      rate = followed.after(since(d, V)).rate(0.0, fast * V);
    } else {
      const double d0 = d - V;
      rate = step.rate(d0, (d - step.xx * d0) / step.xr);
    }
    return std::max(newtons * (followed.a * d + 2.0 * followed.h * rate), least);
  }

  // factor of the tangential force of a step
  double tangential(double phase, double d, double V) const
  {
    return is_new_impact(phase) ? 1.0 / (hurry * (0.5 + since(d, V))) : 1.0 / hurry;
  }

 private:
  double mass, least, hurry, fast, newtons;
  Oscillator followed;
  Motion step;

  double since(double d, double V) const { return followed.since_zero(d, fast * V); }    // steps
};

}    // namespace Slope

#endif

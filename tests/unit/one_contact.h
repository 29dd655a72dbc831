// A ball of the paper on a fixed one, for the tests of the contact law

#ifndef SLOPE_TEST_ONE_CONTACT_H
#define SLOPE_TEST_ONE_CONTACT_H

#include "contact_force.h"

#include <algorithm>
#include <cmath>

namespace OneContact {

using namespace Slope;

// The paper's ball (Table 1): kg, N/m, m
static constexpr double MASS = 8.78, KN = 3.67e7, RADIUS = 0.1;

// the largest step of the rule, s
inline double rule_step() { return 0.25 * std::sqrt(MASS / KN); }

inline ContactLaw law_of_ratio(double zeta, bool exact = true)
{
  ContactLaw law = ContactLaw();
  law.kn = law.kt = law.kr = KN;
  law.cn_root = law.ct_root = law.cr_root = 2.0 * zeta * std::sqrt(KN);
  law.mass_factor = 1.0;
  law.rolling_factor = 2.0;
  law.fn_least = -HUGE_VAL;
  law.exact = exact ? 1.0 : 0.0;
  return law;
}

inline ContactLaw law_of(double e, bool exact = true) { return law_of_ratio(damping_ratio(e), exact); }

inline Contact still_contact(double overlap)
{
  Contact c = Contact();
  c.n[2] = 1.0;
  c.overlap = overlap;
  c.rolling_radius = RADIUS;
  return c;
}

// the law of a solid ball of MASS on a fixed one of the same radius
inline ContactStep on_fixed(const ContactLaw &law, double dt, bool again = false)
{
  return contact_step(law, 1.0 / MASS, MASS, 2.5 / MASS, dt, again);
}
inline LoneContact alone_on_fixed(const ContactLaw &law, double dt)
{
  return lone_contact(law, 1.0 / MASS, MASS, 2.5 / MASS, 2.5 / MASS, dt);
}

// Velocity Verlet of the ball above the fixed one; the normal stays the z axis, motion is in the
// plane y = 0
struct Flight {
  const ContactLaw &law;
  const double dt;
  const ContactStep step, again;
  const LoneContact lone;
  const double load;    // constant force towards the fixed ball, N

  double gap, v, vx, w;    // m, m/s, m/s, rad/s about y
  double f = 0.0, fx = 0.0, torque = 0.0;
  double history[HISTORY] = {0.0};
  bool touched = false;

  // of the last step
  Contact contact;
  Life life = BEGINS;
  ContactForce out;
  bool acts = false;

  Flight(const ContactLaw &law_in, double dt_in, double gap_in, double v_in, double vx_in = 0.0,
         double w_in = 0.0, double load_in = 0.0) :
      law(law_in), dt(dt_in), step(on_fixed(law_in, dt_in)), again(on_fixed(law_in, dt_in, true)),
      lone(alone_on_fixed(law_in, dt_in)), load(load_in), gap(gap_in), v(v_in), vx(vx_in), w(w_in)
  {
    f = -load;
  }

  bool touches() const { return gap < 0.0; }
  double slip() const { return vx - RADIUS * w; }    // of the contact point
  double energy() const { return 0.5 * MASS * (v * v + vx * vx + 0.4 * RADIUS * RADIUS * w * w); }

  void half_kick()
  {
    v += 0.5 * dt * f / MASS;
    vx += 0.5 * dt * fx / MASS;
    w += 0.5 * dt * torque / (0.4 * MASS * RADIUS * RADIUS);
  }

  void make_step()
  {
    half_kick();
    gap += dt * v;
    const bool now = gap < 0.0, plain = law.exact == 0.0;
    f = -load;
    fx = torque = 0.0;
    acts = now || (touched && !plain);
    if (acts) {
      life = !now ? ENDS : touched ? LASTS : BEGINS;
      if (life == BEGINS) std::fill(history, history + HISTORY, 0.0);
      contact = still_contact(-gap);
      contact.v[0] = vx;
      contact.v[2] = v;
      contact.w[1] = w;
      contact.rw[1] = RADIUS * w;
      if (plain) contact_force(step, contact, 0.0, history, out);
      else lone_contact_force(step, lone, life, false, contact, history, out);
      f += out.f[2];
      fx = out.f[0];
      torque = out.m[1] - RADIUS * out.t[1];
    }
    touched = now;
    half_kick();
  }

  // until the contact has ended; its last force is shared with the step after
  void fly()
  {
    bool met = false;
    for (int k = 0; k < 2000000 && !(met && !acts); k++) {
      make_step();
      met = met || acts;
    }
  }
};

}    // namespace OneContact

#endif

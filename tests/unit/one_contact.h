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
  c.follow_whole_step();
  return c;
}

// the law of a solid ball of MASS on a fixed one of the same radius
inline ContactStep on_fixed(const ContactLaw &law, double dt, bool again = false)
{
  return contact_step(law, 1.0 / MASS, 0.0, MASS, 2.5 / MASS, dt, again);
}

}    // namespace OneContact

#endif

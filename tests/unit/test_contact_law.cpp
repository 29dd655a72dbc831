// The contact law by itself: coefficients, limits of sliding and rolling, and what the dashpots of
// several contacts take together.

#include "one_contact.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

using namespace OneContact;

/* ---------------------------------------------------------------------- */

TEST(ContactLaw, DampingRatioAndRestitutionAreInverse)
{
  for (double e : {0.01, 0.1, 0.25, 0.48, 0.9, 1.0})
    EXPECT_NEAR(restitution(damping_ratio(e)), e, 1e-14);
  EXPECT_EQ(restitution(1.0), 0.0);
  EXPECT_TRUE(std::isinf(contact_time(KN, MASS, 1.2)));
}

TEST(ContactLaw, PrintedDashpotsOfThePaper)
{
  const double soil = 3411.4 * PI / 6.0 * 1.25 * 1.25 * 1.25;
  const struct {
    double e, k, m, c;
  } rows[] = {{0.25, KN, MASS, 1.45e4}, {0.445, KN, MASS, 8.96e3}, {0.48, 1.96e9, soil, 1.19e6},
              {0.1, 1.96e9, soil, 3.09e6}};
  for (const auto &row : rows)
    EXPECT_NEAR(2.0 * damping_ratio(row.e) * std::sqrt(row.k * row.m) / row.c, 1.0, 5e-3) << row.c;
  const double two_moving = 1.19e6 / (2.0 * std::sqrt(1.96e9 * soil / 2.0));
  EXPECT_NEAR(restitution(two_moving), 0.344, 5e-4);
}

TEST(ContactLaw, LimitDampingNeverPulls)
{
  ContactLaw law = law_of(0.1);
  Contact c = still_contact(1e-6);
  c.v[2] = 1.0;    // leaving
  double history[HISTORY] = {0.0};
  ContactForce out;
  contact_force(on_fixed(law, 1e-5), c, 0.0, history, out);
  EXPECT_LT(out.f[2], 0.0);
  law.fn_least = 0.0;
  contact_force(on_fixed(law, 1e-5), c, 0.0, history, out);
  EXPECT_EQ(out.f[2], 0.0);
}

TEST(ContactLaw, SlidingForceSitsOnTheLimit)
{
  ContactLaw law = law_of(0.48);
  law.friction = std::tan(30.0 * PI / 180.0);
  Contact c = still_contact(1e-4);
  c.v[0] = 2.0;
  double history[HISTORY] = {0.0};
  ContactForce out;
  for (int step = 0; step < 1000; step++) contact_force(on_fixed(law, 1e-5), c, 0.0, history, out);
  EXPECT_NEAR(out.f[0], -law.friction * out.f[2], 1e-9 * out.f[2]);
  EXPECT_NEAR(out.f[1], 0.0, 1e-9);
  // the spring was cut back to the limit: it does not grow for ever
  EXPECT_LT(std::fabs(history[0]), law.friction * out.f[2] / law.kt + 2.0 * law.ct_root / law.kt * 3.0);
  // torque on the ball is -R t: friction against the motion spins the ball forward
  EXPECT_NEAR(-out.t[1], -(c.n[2] * out.f[0]), 1e-9 * out.f[2]);
}

TEST(ContactLaw, RollingTorqueHasItsLimitAndArm)
{
  ContactLaw law = law_of(0.48);
  law.rolling = 0.1;
  Contact c = still_contact(1e-4);
  c.w[1] = 50.0;
  double history[HISTORY] = {0.0};
  ContactForce out;
  for (int step = 0; step < 1000; step++) contact_force(on_fixed(law, 1e-5), c, 0.0, history, out);
  EXPECT_NEAR(out.m[1], -law.rolling * c.rolling_radius * out.f[2], 1e-9 * out.f[2]);
  c.w[1] = 0.0;
  c.w[2] = 50.0;    // spin about the normal meets none
  double none[HISTORY] = {0.0};
  contact_force(on_fixed(law, 1e-5), c, 0.0, none, out);
  EXPECT_EQ(out.m[2], 0.0);
}

TEST(ContactLaw, PartnerSeesTheOpposite)
{
  ContactLaw law = law_of(0.3);
  law.friction = 0.4;
  law.rolling = 0.2;
  Contact c = still_contact(1e-4);
  c.v[0] = 0.3;
  c.v[2] = -0.2;
  c.rw[1] = 0.5;
  c.w[0] = 4.0;
  double h[HISTORY] = {1e-6, 2e-6, 0.0, -1e-6, 3e-6, 0.0}, g[HISTORY];
  for (int k = 0; k < HISTORY; k++) g[k] = -h[k];
  Contact d = c;
  for (int k = 0; k < 3; k++) {
    d.n[k] = -c.n[k];
    d.v[k] = -c.v[k];
    d.w[k] = -c.w[k];
  }
  ContactForce a, b;
  contact_force(on_fixed(law, 1e-5), c, 0.0, h, a);
  contact_force(on_fixed(law, 1e-5), d, 0.0, g, b);
  for (int k = 0; k < 3; k++) {
    EXPECT_DOUBLE_EQ(a.f[k], -b.f[k]);
    EXPECT_DOUBLE_EQ(a.t[k], b.t[k]);
    EXPECT_DOUBLE_EQ(a.m[k], -b.m[k]);
  }
  for (int k = 0; k < PHASE; k++) EXPECT_NEAR(h[k], -g[k], 1e-18);
}

// no trace of the step is left where it is short
TEST(ContactLaw, SmallStepsGiveTheLaw)
{
  ContactLaw law = law_of(0.3);
  law.friction = 10.0;
  law.rolling = 10.0;
  const double zeta = damping_ratio(0.3), c0 = 2.0 * zeta * std::sqrt(KN * MASS), dt = 1e-8;
  Contact c = still_contact(1e-4);
  c.v[0] = 0.02;
  c.v[2] = -0.3;
  c.w[1] = 0.05;
  double history[HISTORY] = {1e-6, 0.0, 0.0, 0.0, 2e-6, 0.0};
  ContactForce out;
  contact_force(on_fixed(law, dt), c, 0.0, history, out);
  EXPECT_NEAR(out.f[2] / (KN * 1e-4 + c0 * 0.3), 1.0, 1e-4);
  EXPECT_NEAR(out.f[0] / -(KN * 1e-6 + c0 * 0.02), 1.0, 1e-3);
  EXPECT_NEAR(out.m[1] / (-RADIUS * (KN * 2e-6 + c0 * RADIUS * 0.05)), 1.0, 1e-3);
}

// What the dashpots of n contacts in a row with one motion take of it in a step stays below 1, for
// each of the motions and any dashpot; leapfrog needs (spring) + 2 (dashpots) < 4.
TEST(ContactLaw, DashpotsOfSeveralContactsShareWhatTheyTake)
{
  for (double zeta : {0.2, 0.6, 2.0, 20.0})
    for (int n : {1, 2, 4, 12}) {
      ContactLaw law = law_of_ratio(zeta);
      law.friction = law.rolling = 1e9;
      const double dt = rule_step();
      const ContactStep step = on_fixed(law, dt);
      Contact c = still_contact(1e-3);
      c.v[2] = -0.1;
      c.w[1] = 2.0;    // spin turns both springs
      c.rw[1] = RADIUS * 2.0;
      double history[HISTORY] = {0.0};
      ContactForce moving, still, out;
      ContactStep no_spring = step;
      no_spring.grow = 0.0;
      no_spring.per_kt = no_spring.per_kr = 0.0;
      contact_force(no_spring, c, n - 1.0, history, out);
      moving = out;
      contact_force(no_spring, still_contact(1e-3), n - 1.0, history, still);
      const double normal = n * (moving.f[2] - still.f[2]) * dt / (MASS * 0.1);
      // of the spin: sliding's torque R Ft and rolling's, over the moment of inertia
      const double spin = -n * (moving.m[1] - RADIUS * moving.t[1]) * dt / (0.4 * MASS * RADIUS * RADIUS * 2.0);
      EXPECT_GT(normal, 0.0);
      EXPECT_LT(normal, 1.0 + 1e-12) << zeta << " " << n;
      EXPECT_LT(spin, 1.5) << zeta << " " << n;
      if (n > 1) {
        ContactForce alone;
        contact_force(no_spring, c, 0.0, history, alone);
        EXPECT_LT(moving.f[2], alone.f[2]);
        const double taken = 1.0 - std::exp(-2.0 * zeta * std::sqrt(KN / MASS) * dt);
        EXPECT_NEAR((moving.f[2] - still.f[2]) / (alone.f[2] - still.f[2]), 1.0 / (1.0 + (n - 1) * taken), 1e-8);
      }
    }
}

// The contact law by itself: closed forms of a linear spring-dashpot impact, the limits of
// sliding and rolling, and the block of contacts against one contact at a time.

#include "contact_block.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

using namespace Slope;

// The paper's ball of 8.78 kg on a fixed one (Table 1)
static constexpr double MASS = 8.78, KN = 3.67e7;

static ContactLaw law_of(double e, bool predicted = true)
{
  ContactLaw law = ContactLaw();
  const double zeta = damping_ratio(e);
  law.kn = law.kt = law.kr = KN;
  law.cn_root = law.ct_root = law.cr_root = 2.0 * zeta * std::sqrt(KN);
  law.mass_factor = 1.0;
  law.rolling_factor = 2.0;
  law.fn_least = -HUGE_VAL;
  law.predicted = predicted ? 1.0 : 0.0;
  return law;
}

static Contact still_contact(double overlap)
{
  Contact c = Contact();
  c.n[2] = 1.0;
  c.overlap = overlap;
  c.rolling_radius = 0.1;
  c.mass = MASS;
  c.inverse_mass = 1.0 / MASS;
  return c;
}

// Velocity Verlet of an impact at 1 m/s; phase: share of a step that the ball still flies when
// the clock starts. Returns the rebound speed.
static double rebound(const ContactLaw &law, double dt, double phase)
{
  double gap = phase * dt, v = -1.0, f = 0.0;
  bool touched = false;
  for (int step = 0; step < 1000000; step++) {
    v += 0.5 * dt * f / MASS;
    gap += dt * v;
    f = 0.0;
    if (gap < 0.0) {
      Contact c = still_contact(-gap);
      c.v[2] = v;
      c.fresh = touched ? 0.0 : 1.0;
      double history[HISTORY] = {0.0};
      ContactForce out;
      contact_force(law, c, dt, history, out);
      f = out.f[2];
      touched = true;
    }
    v += 0.5 * dt * f / MASS;
    if (touched && gap >= 0.0) break;
  }
  return v;
}

struct Spread {
  double mean, deviation;
};

static Spread spread(const ContactLaw &law, double dt)
{
  double sum = 0.0, square = 0.0;
  const int n = 200;
  for (int k = 0; k < n; k++) {
    const double e = rebound(law, dt, (k + 0.5) / n);
    sum += e;
    square += e * e;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(square / n - mean * mean)};
}

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

TEST(ContactLaw, SmallStepsGiveTheRestitution)
{
  const double dt = 0.002 * std::sqrt(MASS / KN);
  for (double e : {0.1, 0.25, 0.48, 0.9})
    for (bool predicted : {false, true})
      EXPECT_NEAR(rebound(law_of(e, predicted), dt, 0.3), e, 1e-3) << e << predicted;
}

// at the rule's step, over all phases: mean within 0.005 and scatter within 0.01 of the target
TEST(ContactLaw, RuleStepKeepsTheRestitution)
{
  const double dt = 0.25 * std::sqrt(MASS / KN);
  for (double e : {0.1, 0.2, 0.25, 0.35, 0.48, 0.6, 0.75, 0.9}) {
    const Spread s = spread(law_of(e), dt);
    EXPECT_NEAR(s.mean, e, 0.005) << e;
    EXPECT_LT(s.deviation, 0.0105) << e;
  }
}

// negative control: velocities as velocity Verlet has them
TEST(ContactLaw, PlainSchemeIsBiasedAtTheRuleStep)
{
  const double dt = 0.25 * std::sqrt(MASS / KN);
  EXPECT_LT(spread(law_of(0.25, false), dt).mean, 0.235);
  EXPECT_GT(spread(law_of(0.48, false), dt).deviation, 0.02);
}

TEST(ContactLaw, LargestOverlapOfAnImpact)
{
  const double e = 0.48, zeta = damping_ratio(e), w = std::sqrt(KN / MASS);
  const double expected = 1.0 / w * std::exp(-zeta / std::sqrt(1.0 - zeta * zeta) * std::acos(zeta));
  const ContactLaw law = law_of(e);
  const double dt = 1e-3 / w;
  double gap = 0.0, v = -1.0, f = 0.0, deepest = 0.0;
  double duration = 0.0;
  do {
    v += 0.5 * dt * f / MASS;
    gap += dt * v;
    Contact c = still_contact(-gap);
    c.v[2] = v;
    double history[HISTORY] = {0.0};
    ContactForce out;
    contact_force(law, c, dt, history, out);
    f = out.f[2];
    v += 0.5 * dt * f / MASS;
    deepest = std::max(deepest, -gap);
    duration += dt;
  } while (gap < 0.0);
  EXPECT_NEAR(deepest / expected, 1.0, 2e-3);
  EXPECT_NEAR(duration / contact_time(KN, MASS, zeta), 1.0, 2e-3);
}

TEST(ContactLaw, LimitDampingNeverPulls)
{
  ContactLaw law = law_of(0.1);
  Contact c = still_contact(1e-6);
  c.v[2] = 1.0;    // leaving
  double history[HISTORY] = {0.0};
  ContactForce out;
  contact_force(law, c, 0.0, history, out);
  EXPECT_LT(out.f[2], 0.0);
  law.fn_least = 0.0;
  contact_force(law, c, 0.0, history, out);
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
  for (int step = 0; step < 1000; step++) contact_force(law, c, 1e-5, history, out);
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
  for (int step = 0; step < 1000; step++) contact_force(law, c, 1e-5, history, out);
  EXPECT_NEAR(out.m[1], -law.rolling * c.rolling_radius * out.f[2], 1e-9 * out.f[2]);
  c.w[1] = 0.0;
  c.w[2] = 50.0;    // spin about the normal meets none
  double none[HISTORY] = {0.0};
  contact_force(law, c, 1e-5, none, out);
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
  contact_force(law, c, 1e-5, h, a);
  contact_force(law, d, 1e-5, g, b);
  for (int k = 0; k < 3; k++) {
    EXPECT_DOUBLE_EQ(a.f[k], -b.f[k]);
    EXPECT_DOUBLE_EQ(a.t[k], b.t[k]);
    EXPECT_DOUBLE_EQ(a.m[k], -b.m[k]);
  }
  for (int k = 0; k < HISTORY; k++) EXPECT_DOUBLE_EQ(h[k], -g[k]);
}

TEST(ContactBlock, SameAsOneContactAtATime)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (double rolling : {0.0, 0.1}) {
    ContactLaw law = law_of(0.48);
    law.friction = 0.3;
    law.rolling = rolling;
    std::unique_ptr<ContactBlock> block(new ContactBlock);
    std::vector<Contact> contacts;
    std::vector<std::array<double, HISTORY>> histories(ContactBlock::SIZE - 3);
    for (int k = 0; k < ContactBlock::SIZE - 3; k++) {
      Contact c = still_contact(1e-4 * (1.5 + u(random)));
      const double a = PI * u(random), b = PI * u(random);
      c.n[0] = std::sin(a) * std::cos(b);
      c.n[1] = std::sin(a) * std::sin(b);
      c.n[2] = std::cos(a);
      for (int d = 0; d < 3; d++) {
        block->n[d][k] = c.n[d];
        block->v[d][k] = c.v[d] = u(random);
        block->rw[d][k] = c.rw[d] = u(random);
        block->w[d][k] = c.w[d] = 10.0 * u(random);
      }
      c.fresh = k % 2;
      block->overlap[k] = c.overlap;
      block->rolling_radius[k] = c.rolling_radius;
      block->mass[k] = c.mass;
      block->inverse_mass[k] = c.inverse_mass;
      block->fresh[k] = c.fresh;
      for (int h = 0; h < HISTORY; h++) block->history[h][k] = histories[k][h] = 1e-5 * u(random);
      contacts.push_back(c);
    }
    block->count = contacts.size();
    block->evaluate(law, 1e-4);
    for (size_t k = 0; k < contacts.size(); k++) {
      ContactForce out;
      contact_force(law, contacts[k], 1e-4, histories[k].data(), out);
      for (int d = 0; d < 3; d++) {
        EXPECT_NEAR(block->f[d][k], out.f[d], 1e-9 * KN * 1e-4);
        EXPECT_NEAR(block->t[d][k], out.t[d], 1e-9 * KN * 1e-4);
        EXPECT_NEAR(block->m[d][k], out.m[d], 1e-9 * KN * 1e-4);
        EXPECT_NEAR(block->history[d][k], histories[k][d], 1e-15);
      }
    }
  }
}

// The contact law by itself: closed forms of a linear spring-dashpot impact, the limits of
// sliding and rolling, and the block of contacts against one contact at a time.

#include "contact_list.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

using namespace Slope;

// The paper's ball of 8.78 kg on a fixed one (Table 1)
static constexpr double MASS = 8.78, KN = 3.67e7;

static ContactLaw law_of(double e, bool exact = true)
{
  ContactLaw law = ContactLaw();
  const double zeta = damping_ratio(e);
  law.kn = law.kt = law.kr = KN;
  law.cn_root = law.ct_root = law.cr_root = 2.0 * zeta * std::sqrt(KN);
  law.mass_factor = 1.0;
  law.rolling_factor = 2.0;
  law.fn_least = -HUGE_VAL;
  law.exact = exact ? 1.0 : 0.0;
  return law;
}

static Contact still_contact(double overlap)
{
  Contact c = Contact();
  c.n[2] = 1.0;
  c.overlap = overlap;
  c.rolling_radius = 0.1;
  return c;
}

// the law of a ball of MASS on a fixed one
static ContactStep on_fixed(const ContactLaw &law, double dt, bool again = false)
{
  return contact_step(law, 1.0 / MASS, MASS, dt, again);
}

struct Impact {
  double speed, duration, deepest;    // of the rebound, of the contact, largest overlap
};

// Velocity Verlet of an impact at 1 m/s; phase: share of a step that the ball still flies when
// the clock starts.
static Impact impact(const ContactLaw &law, double dt, double phase)
{
  const ContactStep s = on_fixed(law, dt);
  double gap = phase * dt, v = -1.0, f = 0.0;
  Impact result = {0.0, 0.0, 0.0};
  double history[HISTORY] = {0.0, 0.0, new_contact(still_contact(0.0).rolling_radius)};
  bool touched = false;
  for (int step = 0; step < 1000000; step++) {
    v += 0.5 * dt * f / MASS;
    gap += dt * v;
    f = 0.0;
    if (gap < 0.0) {
      Contact c = still_contact(-gap);
      c.v[2] = v;
      ContactForce out;
      contact_force(s, c, history, out);
      f = out.f[2];
      touched = true;
      result.duration += dt;
      result.deepest = std::max(result.deepest, -gap);
    }
    v += 0.5 * dt * f / MASS;
    if (touched && gap >= 0.0) break;
  }
  result.speed = v;
  return result;
}

static double rebound(const ContactLaw &law, double dt, double phase)
{
  return impact(law, dt, phase).speed;
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
    for (bool exact : {false, true})
      EXPECT_NEAR(rebound(law_of(e, exact), dt, 0.3), e, 1e-3) << e << exact;
}

// Over all phases, mean and scatter within 0.0005 of the target. Two moving balls are as one of
// half the mass: with the rule's step 1.41 times as long. Twice the rule's step still does.
TEST(ContactLaw, RuleStepKeepsTheRestitution)
{
  const double rule = 0.25 * std::sqrt(MASS / KN);
  const struct {
    double steps, tolerance;
  } rows[] = {{1.0, 5e-4}, {std::sqrt(2.0), 1e-3}, {2.0, 4e-3}};
  for (const auto &row : rows)
    for (double e : {0.1, 0.2, 0.25, 0.35, 0.48, 0.6, 0.75, 0.9}) {
      const Spread s = spread(law_of(e), row.steps * rule);
      EXPECT_NEAR(s.mean, e, row.tolerance) << e << " at " << row.steps;
      EXPECT_LT(s.deviation, row.tolerance) << e << " at " << row.steps;
    }
}

// dashpots given as numbers may be more than critical: no rebound, and nothing not finite
TEST(ContactLaw, OverdampedContactDoesNotRebound)
{
  ContactLaw law = law_of(0.5);
  law.cn_root *= 2.5 / damping_ratio(0.5);
  const double dt = 0.25 * std::sqrt(MASS / KN);
  for (double phase : {0.05, 0.3, 0.95}) {
    const ContactStep s = on_fixed(law, dt);
    double gap = phase * dt, v = -1.0, f = 0.0;
    double history[HISTORY] = {0.0, 0.0, new_contact(still_contact(0.0).rolling_radius)};
    for (int step = 0; step < 2000; step++) {
      v += 0.5 * dt * f / MASS;
      gap += dt * v;
      f = 0.0;
      if (gap < 0.0) {
        Contact c = still_contact(-gap);
        c.v[2] = v;
        ContactForce out;
        contact_force(s, c, history, out);
        f = out.f[2];
      }
      v += 0.5 * dt * f / MASS;
    }
    EXPECT_NEAR(v, 0.0, 1e-3) << phase;
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
  const Impact i = impact(law_of(e), 1e-3 / w, 0.3);
  EXPECT_NEAR(i.deepest / expected, 1.0, 2e-3);
  EXPECT_NEAR(i.duration / contact_time(KN, MASS, zeta), 1.0, 2e-3);
}

TEST(ContactLaw, LimitDampingNeverPulls)
{
  ContactLaw law = law_of(0.1);
  Contact c = still_contact(1e-6);
  c.v[2] = 1.0;    // leaving
  double history[HISTORY] = {0.0};
  ContactForce out;
  contact_force(on_fixed(law, 1e-5), c, history, out);
  EXPECT_LT(out.f[2], 0.0);
  law.fn_least = 0.0;
  contact_force(on_fixed(law, 1e-5), c, history, out);
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
  for (int step = 0; step < 1000; step++) contact_force(on_fixed(law, 1e-5), c, history, out);
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
  for (int step = 0; step < 1000; step++) contact_force(on_fixed(law, 1e-5), c, history, out);
  EXPECT_NEAR(out.m[1], -law.rolling * c.rolling_radius * out.f[2], 1e-9 * out.f[2]);
  c.w[1] = 0.0;
  c.w[2] = 50.0;    // spin about the normal meets none
  double none[HISTORY] = {0.0};
  contact_force(on_fixed(law, 1e-5), c, none, out);
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
  contact_force(on_fixed(law, 1e-5), c, h, a);
  contact_force(on_fixed(law, 1e-5), d, g, b);
  for (int k = 0; k < 3; k++) {
    EXPECT_DOUBLE_EQ(a.f[k], -b.f[k]);
    EXPECT_DOUBLE_EQ(a.t[k], b.t[k]);
    EXPECT_DOUBLE_EQ(a.m[k], -b.m[k]);
  }
  for (int k = 0; k < HISTORY; k++) EXPECT_DOUBLE_EQ(h[k], -g[k]);
}

// the springs keep their length, and the force is that of the step before
TEST(ContactLaw, AgainGivesTheSameForce)
{
  ContactLaw law = law_of(0.25);
  law.friction = 0.4;
  law.rolling = 0.1;
  const double dt = 0.25 * std::sqrt(MASS / KN);
  const ContactStep step = on_fixed(law, dt), again = on_fixed(law, dt, true);
  double gap = 0.4 * dt, v = -1.0, f = 0.0;
  Contact c = still_contact(0.0);
  double history[HISTORY] = {0.0, 0.0, new_contact(c.rolling_radius)};
  int touching = 0;
  while (gap < 0.0 || !touching) {
    v += 0.5 * dt * f / MASS;
    gap += dt * v;
    f = 0.0;
    if (gap < 0.0) {
      c.overlap = -gap;
      c.v[0] = 0.1;
      c.v[2] = v;
      c.w[1] = 3.0;
      ContactForce out, same;
      contact_force(step, c, history, out);
      std::array<double, HISTORY> kept;
      std::copy(history, history + HISTORY, kept.begin());
      contact_force(again, c, history, same);
      for (int d = 0; d < 3; d++) {
        EXPECT_NEAR(same.f[d], out.f[d], 1e-9 * std::fabs(out.f[2])) << touching;
        EXPECT_NEAR(same.m[d], out.m[d], 1e-9 * std::fabs(out.f[2])) << touching;
      }
      for (int h = 0; h < HISTORY; h++) EXPECT_NEAR(history[h], kept[h], 1e-15) << touching;
      f = out.f[2];
      touching++;
    }
    v += 0.5 * dt * f / MASS;
  }
  EXPECT_GT(touching, 8);
}

// ----------------------------------------------------------------------
// a list of contacts against one contact at a time
// ----------------------------------------------------------------------

struct Cloud {
  std::vector<Vector> x, v, omega, f, torque;
  std::vector<double> radius, mass;
  std::vector<std::array<double, HISTORY>> history;
  ContactList list;

  // n pairs of balls, two in three touching; different: sizes of their own
  Cloud(int n, bool different)
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    history.resize(n);
    for (int k = 0; k < n; k++) {
      const Vector at = {10.0 * k, 0.0, 0.0};
      const double a = PI * u(random), b = PI * u(random);
      const double ri = different ? 0.1 + 0.02 * u(random) : 0.1;
      const double rj = different ? 0.1 + 0.02 * u(random) : 0.1;
      const double r = (ri + rj) * (k % 3 ? 0.999 : 1.01);
      x.push_back(at);
      x.push_back({at.x + r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b), r * std::cos(a)});
      for (double size : {ri, rj}) {
        v.push_back({u(random), u(random), u(random)});
        omega.push_back({10.0 * u(random), 10.0 * u(random), 10.0 * u(random)});
        radius.push_back(size);
        mass.push_back(MASS * std::pow(size / 0.1, 3));
      }
      for (double &h : history[k]) h = 1e-5 * u(random);
    }
    f.assign(2 * n, {0.0, 0.0, 0.0});
    torque = f;
    list.clear();
    for (int k = 0; k < n; k++)
      list.add(2 * k, 2 * k + 1, history[k].data(), k % 2, radius[2 * k], radius[2 * k + 1],
               mass[2 * k], mass[2 * k + 1]);
  }

  MovingBalls balls()
  {
    return {x.data(), v.data(), omega.data(), radius.data(), mass.data(), f.data(), torque.data()};
  }
};

TEST(ContactList, SameAsOneContactAtATime)
{
  const int n = 150;    // three blocks, the last not full
  const double dt = 1e-4;
  for (double rolling : {0.0, 0.1})
    for (bool different : {false, true}) {
      ContactLaw law = law_of(0.48);
      law.friction = 0.3;
      law.rolling = rolling;
      Cloud cloud(n, different);
      const auto before = cloud.history;
      const MovingBalls balls = cloud.balls();
      const MovingPartners partners = {balls, 2 * n};
      int tallied = 0;
      cloud.list.apply<true>(law, dt, false, balls, partners,
                             [&](int, int, const Vector &, const Vector &) { tallied++; });
      EXPECT_EQ(cloud.list.equal, !different);
      EXPECT_EQ(tallied, 100);

      for (int k = 0; k < n; k++) {
        const int i = 2 * k, j = i + 1;
        std::array<double, HISTORY> history = before[k];
        ContactForce out = ContactForce();
        const double ri = cloud.radius[i], rj = cloud.radius[j];
        if (k % 3) {
          Contact c;
          const Vector a = cloud.x[i], b = cloud.x[j];
          const double r = std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                                     (a.z - b.z) * (a.z - b.z));
          const double delta[3] = {a.x - b.x, a.y - b.y, a.z - b.z};
          const double *vi = &cloud.v[i].x, *vj = &cloud.v[j].x;
          const double *wi = &cloud.omega[i].x, *wj = &cloud.omega[j].x;
          c.overlap = ri + rj - r;
          c.rolling_radius = 2.0 * ri * rj / (ri + rj);
          for (int d = 0; d < 3; d++) {
            c.n[d] = delta[d] / r;
            c.v[d] = vi[d] - vj[d];
            c.rw[d] = ri * wi[d] + rj * wj[d];
            c.w[d] = wi[d] - wj[d];
            if (k % 2 == 0) {    // did not touch before: starts anew
              history[d] = new_contact(c.rolling_radius) * c.n[d];
              history[3 + d] = 0.0;
            }
          }
          const double inverse = 1.0 / cloud.mass[i] + 1.0 / cloud.mass[j];
          contact_force(contact_step(law, inverse, 1.0 / inverse, dt, false), c, history.data(), out);
        } else if (k % 2) {    // touched before, no longer
          history.fill(0.0);
        }
        const double small = 1e-9 * KN * 1e-4;
        const double *fi = &cloud.f[i].x, *fj = &cloud.f[j].x;
        const double *ti = &cloud.torque[i].x, *tj = &cloud.torque[j].x;
        for (int d = 0; d < 3; d++) {
          EXPECT_NEAR(fi[d], out.f[d], small) << k;
          EXPECT_NEAR(fj[d], -out.f[d], small) << k;
          EXPECT_NEAR(ti[d], out.m[d] - ri * out.t[d], small) << k;
          EXPECT_NEAR(tj[d], -out.m[d] - rj * out.t[d], small) << k;
        }
        for (int h = 0; h < (rolling > 0.0 ? HISTORY : 3); h++)
          EXPECT_NEAR(cloud.history[k][h], history[h], 1e-13) << k;
        EXPECT_EQ(cloud.list.touches(k), k % 3 != 0) << k;
      }
    }
}

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
  c.v[2] = c.ahead = 1.0;    // leaving
  double history[HISTORY] = {0.0};
  ContactForce out;
  contact_force(on_fixed(law, 1e-5), c, 1.0, history, out);
  EXPECT_LT(out.f[2], 0.0);
  law.fn_least = 0.0;
  contact_force(on_fixed(law, 1e-5), c, 1.0, history, out);
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
  for (int step = 0; step < 1000; step++) contact_force(on_fixed(law, 1e-5), c, 1.0, history, out);
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
  for (int step = 0; step < 1000; step++) contact_force(on_fixed(law, 1e-5), c, 1.0, history, out);
  EXPECT_NEAR(out.m[1], -law.rolling * c.rolling_radius * out.f[2], 1e-9 * out.f[2]);
  c.w[1] = 0.0;
  c.w[2] = 50.0;    // spin about the normal meets none
  double none[HISTORY] = {0.0};
  contact_force(on_fixed(law, 1e-5), c, 1.0, none, out);
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
  c.ahead = -0.2;
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
  contact_force(on_fixed(law, 1e-5), c, 1.0, h, a);
  contact_force(on_fixed(law, 1e-5), d, 1.0, g, b);
  for (int k = 0; k < 3; k++) {
    EXPECT_DOUBLE_EQ(a.f[k], -b.f[k]);
    EXPECT_DOUBLE_EQ(a.t[k], b.t[k]);
    EXPECT_DOUBLE_EQ(a.m[k], -b.m[k]);
  }
  for (int k = 0; k < AGE; k++) EXPECT_NEAR(h[k], -g[k], 1e-18);
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
  c.v[2] = c.ahead = -0.3;
  c.w[1] = 0.05;
  double history[HISTORY] = {1e-6, 0.0, 0.0, 0.0, 2e-6, 0.0};
  ContactForce out;
  contact_force(on_fixed(law, dt), c, 1.0, history, out);
  EXPECT_NEAR(out.f[2] / (KN * 1e-4 + c0 * 0.3), 1.0, 1e-4);
  EXPECT_NEAR(out.f[0] / -(KN * 1e-6 + c0 * 0.02), 1.0, 1e-3);
  EXPECT_NEAR(out.m[1] / (-RADIUS * (KN * 2e-6 + c0 * RADIUS * 0.05)), 1.0, 1e-3);
}

// Steps of velocity Verlet with these coefficients decay as the law's restitution says; the overlap at rest
// is the law's
TEST(ContactLaw, StepsHaveTheLawsDampingRatio)
{
  for (double e : {0.05, 0.1, 0.3, 0.5, 0.9})
    for (double part : {1.0, 0.5, 0.1}) {
      const ContactLaw law = law_of(e);
      const double dt = part * rule_step();
      const ContactStep step = on_fixed(law, dt);
      EXPECT_EQ(step.kn, law.kn);
      const double a = KN * dt * dt / MASS, H = step.taken_n;
      EXPECT_NEAR(H, step.cn * dt / MASS, 1e-12);

      // d(n+1) - 2 d(n) + d(n-1) = -a d(n) - H (V + AHEAD (V - V')), V = d(n) - d(n-1), V' the one before:
      // e = exp(-pi decay / frequency) of the complex root of z^3 + c2 z^2 + c1 z + c0, by Newton's method
      const double t = AHEAD;
      double re = 1.0 - 0.5 * H, im = std::sqrt(a);
      for (int k = 0; k < 50; k++) {
        const double r2 = re * re - im * im, i2 = 2.0 * re * im;                     // z^2
        const double r3 = r2 * re - i2 * im, i3 = r2 * im + i2 * re;                 // z^3
        const double c2 = -2.0 + a + H * (1.0 + t), c1 = 1.0 - H * (1.0 + 2.0 * t), c0 = H * t;
        const double pr = r3 + c2 * r2 + c1 * re + c0, pi = i3 + c2 * i2 + c1 * im;
        const double qr = 3.0 * r2 + 2.0 * c2 * re + c1, qi = 3.0 * i2 + 2.0 * c2 * im;
        const double q = qr * qr + qi * qi;
        re -= (pr * qr + pi * qi) / q;
        im -= (pi * qr - pr * qi) / q;
      }
      const double got = std::exp(PI * 0.5 * std::log(re * re + im * im) / std::atan2(im, re));
      EXPECT_NEAR(got, e, 0.002) << e << " " << part;
    }
}

// the sliding spring's steps lie on the oscillation itself, damped and overdamped
TEST(ContactLaw, SteppedSpring)
{
  for (double a : {0.0, 0.01, 0.2, 1.0})
    for (double h : {0.0, 0.1, 0.5, 2.0, 10.0}) {
      const double y = a - h * h, q = std::sqrt(std::fabs(y));
      const double both = y > 0.0 ? 2.0 * std::exp(-h) * std::cos(q) : std::exp(q - h) + std::exp(-q - h);
      EXPECT_NEAR(stepped_spring(a, h), 1.0 + std::exp(-2.0 * h) - both, 1e-7) << a << " " << h;
    }
}

// No motion of n parallel contacts grows, up to twice the rule's step; what is left of one is not kept either. Velocity
// Verlet of one overlap, dashpots as contact_force() has them.
TEST(ContactLaw, ParallelContactsAreStable)
{
  int late = 0;
  for (double part : {1.0, 1.5, 2.0})
    for (double zeta : {0.05, 0.2, 0.35, 0.6, 2.0})
      for (int n : {1, 2, 3, 4, 6}) {
        const double dt = part * rule_step();
        const ContactStep step = on_fixed(law_of_ratio(zeta), dt);
        const double a = n * KN * dt * dt / MASS, sum = n * step.taken_n * acting_together(step, 1.0 * n);
        const bool ahead = !crowded(step, 1.0 * n);
        late += !ahead;
        double d = 1.0, v = 0.0, force = 0.0, most = 0.0;
        for (int k = 0; k < 1000; k++) {
          d += v;
          force = -a * d - sum * (ahead ? v + AHEAD * force : v);
          v += force;
          if (k >= 900) most = std::max(most, std::fabs(d));
        }
        EXPECT_LT(most, n * zeta < 0.1 ? 0.5 : 0.01) << part << " " << zeta << " " << n;
      }
  EXPECT_GE(late, 20);
}

// Contacts that are crowded act on the velocities of the middle, and when they begin take at most all of the motion.
TEST(ContactLaw, CrowdedDashpotsDoNotLookAhead)
{
  int many = 0, few = 0;
  for (double zeta : {0.05, 0.6, 2.0})
    for (int n : {1, 4, 6, 12}) {
      const ContactStep step = on_fixed(law_of_ratio(zeta), rule_step());
      Contact c = still_contact(1e-3);
      c.along = n;
      c.v[2] = -0.1;
      c.ahead = -0.3;
      Contact still = still_contact(1e-3);
      still.along = n;
      double history[HISTORY] = {0.0};
      ContactForce out, none;
      contact_force(step, c, 1.0 * n, history, out);
      contact_force(step, still, 1.0 * n, history, none);
      const double taken = step.taken_n * acting_together(step, 1.0 * n);
      const double seen = (out.f[2] - none.f[2]) * step.dt / (MASS * taken);
      const bool late = n * (step.taken_n + 0.25 * step.spring_n) > MOST_AHEAD;
      EXPECT_EQ(crowded(step, 1.0 * n), late);
      (late ? many : few)++;
      EXPECT_NEAR(seen, late ? 0.1 : 0.3, 1e-9) << zeta << " " << n;
      for (double weight : {-0.2, 0.3, 1.0, 1.5}) {
        c.weight = weight;
        hold_beginning(step, c);
        EXPECT_NEAR(c.weight, late ? std::min(weight, std::max(1.0 / (n * taken), 0.5)) : weight, 1e-15);
        EXPECT_LE(late ? c.weight * n * taken : 0.0, 1.0 + 1e-12);
      }
    }
  EXPECT_GE(many, 3);
  EXPECT_GE(few, 5);
}

// those of fixed balls by their normals, those that move by a third or a half
TEST(ContactLaw, ContactsAlongANormal)
{
  for (int n : {1, 3, 6}) {    // in a ring, z high
    const double z = n == 1 ? 1.0 : 0.8, out = std::sqrt(1.0 - z * z), normals[3] = {0.0, 0.0, n * z};
    for (int k = 0; k < n; k++) {
      const double normal[3] = {out * std::cos(2.0 * PI * k / n), out * std::sin(2.0 * PI * k / n), z};
      EXPECT_NEAR(along_fixed(normal, normals, 1.0 * n, 1.0 * n), n * z * z, 1e-12);
      EXPECT_NEAR(along_fixed(normal, normals, 1.0 * n, 6.0 + n), n * z * z + 2.0, 1e-12);
    }
  }
  EXPECT_EQ(along_moving(1.0), 1.0);
  EXPECT_EQ(along_moving(3.0), 2.0);
  EXPECT_EQ(along_moving(12.0), 6.0);
}

// What the dashpots of many contacts of one ball take of its motion is bounded, whatever they are and however
// many; those of few are not touched.
TEST(ContactLaw, DashpotsOfManyContactsAreHeldBack)
{
  for (double zeta : {0.05, 0.6, 2.0, 20.0})
    for (int n : {1, 2, 4, 12, 40}) {
      ContactLaw law = law_of_ratio(zeta);
      law.friction = law.rolling = 1e9;
      ContactStep step = on_fixed(law, rule_step());
      step.grow = 0.0;
      step.per_kt = step.per_kr = 0.0;
      Contact c = still_contact(1e-3);
      c.along = n;
      Contact at_rest = c;
      c.v[2] = c.ahead = -0.1;
      c.w[1] = 2.0;
      c.rw[1] = RADIUS * 2.0;
      double history[HISTORY] = {0.0};
      ContactForce out, still;
      contact_force(step, c, static_cast<double>(n), history, out);
      contact_force(step, at_rest, static_cast<double>(n), history, still);
      const double normal = (out.f[2] - still.f[2]) * step.dt / (MASS * 0.1);
      EXPECT_LE(normal, std::min(step.taken_n, MOST_NORMAL / n) + 1e-9) << zeta << " " << n;
      if (n == 1) { EXPECT_NEAR(normal, step.taken_n, 1e-9) << zeta; }
      const double sliding = -RADIUS * -out.t[1] * step.dt / (0.4 * MASS * RADIUS * RADIUS * 2.0) * -3.5 / 2.5;
      EXPECT_NEAR(std::fabs(sliding), std::min(step.taken_t, MOST_SLIDING / n), 1e-9) << zeta << " " << n;
      const double rolling = -out.m[1] * step.dt / (0.4 * MASS * RADIUS * RADIUS * 2.0);
      EXPECT_NEAR(rolling, std::min(step.taken_r, MOST_ROLLING / n), 1e-9) << zeta << " " << n;
    }
}

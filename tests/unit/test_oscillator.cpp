// The damped oscillator in closed form, against its power series and its own composition

#include "oscillator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace Slope;

// under-, critically and overdamped, and close to critical from both sides
static std::vector<Oscillator> oscillators()
{
  std::vector<Oscillator> all;
  for (double w : {1e-3, 0.05, 0.25, 0.5, 0.9})
    for (double zeta : {0.0, 0.05, 0.6, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.01, 2.5, 7.0}) all.push_back({zeta * w, w * w});
  return all;
}

// exp(t A), A = (0 1; -a -2h), from that of t/64
static Motion series(const Oscillator &o, double t)
{
  typedef long double Real;
  Real term[4] = {1, 0, 0, 1}, sum[4] = {1, 0, 0, 1};
  for (int k = 1; k < 40; k++) {
    const Real f = static_cast<Real>(t) / 64 / k;
    const Real next[4] = {-o.a * term[1] * f, (term[0] - 2 * o.h * term[1]) * f, -o.a * term[3] * f,
                          (term[2] - 2 * o.h * term[3]) * f};
    std::copy(next, next + 4, term);
    for (int m = 0; m < 4; m++) sum[m] += term[m];
  }
  for (int k = 0; k < 6; k++) {
    const Real twice[4] = {sum[0] * sum[0] + sum[1] * sum[2], sum[1] * (sum[0] + sum[3]),
                           sum[2] * (sum[0] + sum[3]), sum[2] * sum[1] + sum[3] * sum[3]};
    std::copy(twice, twice + 4, sum);
  }
  return {static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2]),
          static_cast<double>(sum[3])};
}

static void expect_near(const Motion &one, const Motion &two, double tolerance, const Oscillator &o)
{
  EXPECT_NEAR(one.xx, two.xx, tolerance) << o.h << " " << o.a;
  EXPECT_NEAR(one.xr, two.xr, tolerance) << o.h << " " << o.a;
  EXPECT_NEAR(one.rx, two.rx, tolerance) << o.h << " " << o.a;
  EXPECT_NEAR(one.rr, two.rr, tolerance) << o.h << " " << o.a;
}

TEST(Oscillator, MotionIsThatOfTheSeries)
{
  for (const Oscillator &o : oscillators())
    for (double t : {0.0, 0.1, 1.0, 3.0}) expect_near(o.after(t), series(o, t), 1e-12, o);
}

TEST(Oscillator, OneTimeAfterAnother)
{
  for (const Oscillator &o : oscillators())
    for (double t : {0.01, 0.7})
      for (double u : {0.3, 11.0}) {
        const Motion a = o.after(t), b = o.after(u);
        const Motion both = {a.xx * b.xx + a.xr * b.rx, a.xx * b.xr + a.xr * b.rr, a.rx * b.xx + a.rr * b.rx,
                             a.rx * b.xr + a.rr * b.rr};
        expect_near(o.after(t + u), both, 1e-11, o);
      }
}

TEST(Oscillator, StrongDampingLeavesTheSlowPart)
{
  const double w = 0.25, zeta = 69.0;
  const Motion far = Oscillator{zeta * w, w * w}.after(1000.0);
  const double q = zeta * w * std::sqrt(1.0 - 1.0 / (zeta * zeta)), slow = w * w / (zeta * w + q);
  EXPECT_NEAR(far.xx / (0.5 * (1.0 + zeta * w / q) * std::exp(-1000.0 * slow)), 1.0, 1e-9);
  EXPECT_TRUE(std::isfinite(Oscillator({50.0, 1.0}).after(1000.0).rr));
}

TEST(Oscillator, FirstTimeAtZero)
{
  int never = 0, found = 0;
  for (const Oscillator &o : oscillators())
    for (double r : {0.3, 0.0, -0.2, -3.0}) {
      const double t = o.until_zero(1.0, r);
      if (std::isinf(t)) {
        never++;
        for (double s = 0.0; s < 200.0; s += 0.5) EXPECT_GT(o.after(s).x(1.0, r), 0.0) << o.h << " " << o.a << " " << r;
        continue;
      }
      found++;
      EXPECT_NEAR(o.after(t).x(1.0, r), 0.0, 1e-6 * std::fabs(r) + 1e-9) << o.h << " " << o.a << " " << r;
      for (double s = 0.0; s < 0.999; s += 0.02) EXPECT_GE(o.after(s * t).x(1.0, r), 0.0);
    }
  EXPECT_GT(never, 20);
  EXPECT_GT(found, 20);
}

TEST(Oscillator, TimeSinceZero)
{
  for (const Oscillator &o : oscillators())
    for (double t : {1e-6, 0.01, 0.5, 0.999}) {
      const Motion m = o.after(t);
      // what is left of the rate must still lead to x: overdamped balls all but stand after a part of a step
      if (m.rr < 0.05) continue;
      EXPECT_NEAR(o.since_zero(2.0 * m.xr, 2.0), t, 1e-9) << o.h << " " << o.a;
    }
  // never reached: the time of free flight
  EXPECT_EQ(Oscillator({20.0, 1.0}).since_zero(0.5, 1.0), 0.5);
}

// a force -stiffness d - (1 - exp(-2h)) V once a step keeps velocity Verlet on the motion
TEST(Oscillator, DiscreteForceKeepsTheMotion)
{
  for (const Oscillator &o : oscillators()) {
    const double a = o.stiffness(), taken = 1.0 - std::exp(-2.0 * o.h);
    double x = o.after(1.0).x(0.4, 1.0), path = x - 0.4;
    for (int k = 2; k < 40; k++) {
      path -= a * x + taken * path;
      x += path;
      EXPECT_NEAR(x, o.after(k).x(0.4, 1.0), 1e-10) << o.h << " " << o.a;
    }
  }
}

TEST(Oscillator, CarriesALoadAsTheSpringDoes)
{
  for (double w : {0.05, 0.25, 0.3536, 0.5})
    for (double zeta : {0.0, 0.05, 0.3, 0.6, 0.9, 1.0, 1.2, 2.0, 3.5, 6.9, 17.0, 35.0, 69.0}) {
      const Oscillator law = {zeta * w, w * w}, o = true_at_rest(law);
      EXPECT_NEAR(o.stiffness() / law.a, 1.0, 1e-9) << w << " " << zeta;
      EXPECT_NEAR(o.h / std::sqrt(o.a), zeta, 1e-9 * (1.0 + zeta)) << w;
      EXPECT_GE(o.a, law.a * (1.0 - 1e-12)) << w << " " << zeta;
    }
  const double undamped = true_at_rest({0.0, 0.0625}).a;
  EXPECT_NEAR(std::sqrt(undamped), std::acos(1.0 - 0.03125), 1e-10);
  EXPECT_EQ(true_at_rest({0.3, 0.0}).h, 0.3);    // no spring
}

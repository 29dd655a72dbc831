// Acceleration, velocity and displacement of a record, against closed forms; files that are wrong

#include "motion_record.h"
#include "archive.h"
#include "run_clock.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <stdexcept>

using Slope::MotionRecord;
using Slope::RunClock;

namespace {

const double PI = std::acos(-1.0);

struct Three {
  double a[3], v[3], d[3];
};

Three at(const MotionRecord &record, double t)
{
  Three found;
  record.acceleration(t, found.a);
  record.velocity(t, found.v);
  record.displacement(t, found.d);
  return found;
}

class MotionFile : public ::testing::Test {
 protected:
  std::string path;

  void SetUp() override
  {
    path = std::string("motion_") +
        ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt";
  }
  void TearDown() override { std::remove(path.c_str()); }

  MotionRecord read(const std::string &text, double scale = 1.0)
  {
    std::ofstream(path, std::ios::binary) << text;
    return MotionRecord::read(path, scale);
  }

  std::string problem(const std::string &text)
  {
    try {
      read(text);
    } catch (std::runtime_error &e) {
      return e.what();
    }
    return "read";
  }
};

}    // namespace

TEST(MotionRecord, RampIsCubicInDisplacement)
{
  const MotionRecord record({{1.0, {0.0, 6.0, 0.0}}, {3.0, {4.0, 6.0, -2.0}}}, 1.0);
  for (double t : {1.0, 1.3, 2.0, 2.999}) {
    const double s = t - 1.0;
    const Three p = at(record, t);
    EXPECT_DOUBLE_EQ(p.a[0], 2.0 * s);
    EXPECT_NEAR(p.v[0], s * s, 1e-14);
    EXPECT_NEAR(p.d[0], s * s * s / 3.0, 1e-14);
    EXPECT_DOUBLE_EQ(p.a[1], 6.0);
    EXPECT_NEAR(p.v[1], 6.0 * s, 1e-14);
    EXPECT_NEAR(p.d[1], 3.0 * s * s, 1e-14);
    EXPECT_NEAR(p.d[2], -s * s * s / 6.0, 1e-14);
  }
}

TEST(MotionRecord, NothingBeforeAndConstantVelocityAfter)
{
  const MotionRecord record({{1.0, {2.0, 0.0, 0.0}}, {2.0, {2.0, 0.0, 0.0}}}, 1.0);
  for (double t : {-5.0, 0.0, 0.999}) {
    const Three before = at(record, t);
    EXPECT_EQ(before.a[0], 0.0);
    EXPECT_EQ(before.v[0], 0.0);
    EXPECT_EQ(before.d[0], 0.0);
  }
  const Three after = at(record, 5.0);
  EXPECT_EQ(after.a[0], 0.0);
  EXPECT_DOUBLE_EQ(after.v[0], 2.0);
  EXPECT_DOUBLE_EQ(after.d[0], 1.0 + 3.0 * 2.0);
}

TEST(MotionRecord, EqualTimesAreAJump)
{
  const MotionRecord record(
      {{0.0, {0, 0, 0}}, {1.0, {0, 0, 0}}, {1.0, {3, 0, 0}}, {2.0, {3, 0, 0}}, {2.0, {-1, 0, 0}}, {5.0, {-1, 0, 0}}}, 1.0);
  EXPECT_EQ(at(record, std::nextafter(1.0, 0.0)).a[0], 0.0);
  EXPECT_EQ(at(record, 1.0).a[0], 3.0);
  EXPECT_NEAR(at(record, std::nextafter(2.0, 0.0)).a[0], 3.0, 1e-14);
  EXPECT_EQ(at(record, 2.0).a[0], -1.0);
  EXPECT_DOUBLE_EQ(at(record, 1.5).v[0], 1.5);
  EXPECT_DOUBLE_EQ(at(record, 4.0).v[0], 1.0);
  EXPECT_NEAR(at(record, 4.0).d[0], 1.5 + 3.0 * 2.0 - 0.5 * 4.0, 1e-14);
}

TEST(MotionRecord, ScaleIsAFactorOnAll)
{
  const std::vector<MotionRecord::Point> points = {{0, {1, 2, 3}}, {1, {2, -1, 0}}, {4, {0, 1, 1}}};
  const MotionRecord one(points, 1.0), scaled(points, -0.01);
  for (double t : {0.5, 1.0, 3.0, 6.0}) {
    const Three a = at(one, t), b = at(scaled, t);
    for (int c = 0; c < 3; c++) {
      EXPECT_DOUBLE_EQ(-0.01 * a.a[c], b.a[c]);
      EXPECT_DOUBLE_EQ(-0.01 * a.v[c], b.v[c]);
      EXPECT_DOUBLE_EQ(-0.01 * a.d[c], b.d[c]);
    }
  }
  EXPECT_DOUBLE_EQ(one.peak(), std::sqrt(14.0));
  EXPECT_DOUBLE_EQ(scaled.peak(), 0.01 * std::sqrt(14.0));
  EXPECT_NE(one.checksum(), scaled.checksum());
}

// a sine of 2 Hz at 100 points per second: the straight lines between them are all that differs

TEST(MotionRecord, SineEndsWhereItShould)
{
  std::vector<MotionRecord::Point> points;
  const double w = 4.0 * PI, dt = 0.01;
  for (int k = 0; k <= 100; k++) points.push_back({k * dt, {std::sin(w * k * dt), 0.0, 0.0}});
  const MotionRecord record(points, 1.0);
  EXPECT_NEAR(at(record, 1.0).v[0], 0.0, 1e-14);
  EXPECT_NEAR(at(record, 1.0).d[0], 1.0 / w, 1.0 / w * w * w * dt * dt / 12.0 * 1.1);
  EXPECT_NEAR(at(record, 0.25).v[0], 2.0 / w, 2.0 / w * w * w * dt * dt / 12.0 * 1.1);
}

// the same impulse with ten steps between two points, or ten points in a step

TEST(MotionRecord, ImpulseDoesNotDependOnTheStep)
{
  std::vector<MotionRecord::Point> points;
  for (int k = 0; k <= 50; k++) points.push_back({0.02 * k, {std::sin(17.0 * k * k), 0.0, 0.0}});
  const MotionRecord record(points, 1.0);
  double exact = 0.0;
  for (int k = 0; k < 50; k++) exact += 0.01 * (points[k].a[0] + points[k + 1].a[0]);
  for (int steps : {5, 50, 500, 12345}) {
    double sum = 0.0, last = 0.0;
    for (int n = 1; n <= steps; n++) {
      const double v = at(record, 1.0 * n / steps).v[0];
      sum += v - last;
      last = v;
    }
    EXPECT_NEAR(sum, exact, 1e-14) << steps;
  }
}

TEST_F(MotionFile, ReadsCommentsCommasAndCarriageReturns)
{
  const MotionRecord record = read("\xef\xbb\xbf# t ax ay az\r\n\r\n0 1 2 3 # first\r\n\t0.5, 4,5 ,6\r\n", 2.0);
  ASSERT_EQ(record.list().size(), 2u);
  EXPECT_EQ(record.list()[1].t, 0.5);
  EXPECT_EQ(record.list()[1].a[2], 6.0);
  EXPECT_EQ(record.end(), 0.5);
  EXPECT_DOUBLE_EQ(at(record, 0.25).a[0], 5.0);
}

TEST_F(MotionFile, WhatIsWrongIsSaid)
{
  EXPECT_EQ(problem("0 0 0 0\n1 0 0\n"),
            path + ", line 2: must be 4 numbers, t ax ay az, got 1 0 0");
  EXPECT_EQ(problem("0 0 0 0\n1 0 0 0 0\n"),
            path + ", line 2: must be 4 numbers, t ax ay az, got 1 0 0 0 0");
  EXPECT_EQ(problem("# t ax ay az (gal)\n0 0 0 0\n1 0 0 0\n"),
            path + ", line 1: columns must be t ax ay az in s and m/s2, got t ax ay az (gal)");
  EXPECT_EQ(read("# t ax ay az (gal)\n0 0 0 0\n1 0 100 0\n", 0.01).peak(), 1.0);
  EXPECT_EQ(problem("0 0 0 0\n\n1 0 0 0\n0.5 0 0 0\n"),
            path + ", line 4: times must not fall, got 0.5 after 1");
  EXPECT_EQ(problem("0 0 0 0\n1 0 0 0\n1 1 0 0\n1 2 0 0\n"),
            path + ", line 4: at most two lines may have the same time, a jump, got a third one of 1");
  EXPECT_EQ(problem("0 0 0 0\n1 0 1e10 0\n"),
            path + ", line 2: numbers must be within +-1000000000, got 1e+10");
  EXPECT_EQ(problem("# nothing\n"), path + ": must hold at least 2 lines t ax ay az, got 0");
  EXPECT_EQ(problem("0 1 1 1\n"), path + ": must hold at least 2 lines t ax ay az, got 1");
  EXPECT_THROW(MotionRecord::read("no/such/file", 1.0), std::runtime_error);
}

TEST(RunClock, GoesOnToTheBitOrBeginsAtItsOwnTime)
{
  RunClock uncut, cut;
  uncut.begin(7, 0.1);
  cut.begin(7, 0.1);
  for (int n = 8; n <= 20; n++) cut.pass(n);
  RunClock restarted;
  Slope::Archive to("clock", 1);
  cut.archive(to);
  Slope::Archive from("clock", 1, to.bytes().data());
  restarted.archive(from);
  EXPECT_TRUE(restarted.begin(20, 0.1));
  EXPECT_EQ(restarted.at(33), uncut.at(33));

  EXPECT_FALSE(cut.begin(0, 0.05));    // reset_timestep, another time step
  EXPECT_DOUBLE_EQ(cut.at(2), 1.3 + 0.1);
  cut.pass(2);
  cut.change_step_size(2, 0.2);        // fix dt/reset
  EXPECT_DOUBLE_EQ(cut.at(3), 1.4 + 0.2);
  EXPECT_DOUBLE_EQ(cut.now(), 1.4);
}

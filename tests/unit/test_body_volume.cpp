/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// The volume of bodies is theirs to 1e-3: round, with sides that do and do not follow the columns, thin on
// a slope, small in a wide box; and the same to the bit on any number of ranks.

#include "body_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using Slope::body_volume;
using Slope::PlanBox;

static const double PI = 3.14159265358979323846;
static const double EXACT = 1.0e-3;
static const PlanBox NOWHERE = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};

static double sphere(double x, double y)
{
  return 2 * std::sqrt(std::max(0.0, 1 - x * x - y * y));
}

TEST(BodyVolume, Sphere)
{
  EXPECT_NEAR(body_volume({{-1, -1}, {1, 1}}, NOWHERE, sphere) / (4 * PI / 3), 1.0, EXACT);
  EXPECT_NEAR(body_volume({{-3, -1.5}, {2, 7}}, NOWHERE, sphere) / (4 * PI / 3), 1.0, EXACT);
}

// a wedge that thins out to nothing at its rim, as a body does where the slip surface comes out
TEST(BodyVolume, ConeOnTheFloor)
{
  const auto cone = [](double x, double y) {
    return std::max(0.0, 10 * (1 - std::hypot(x - 50, y - 50) / 40));
  };
  EXPECT_NEAR(body_volume({{0, 0}, {100, 100}}, NOWHERE, cone) / (PI * 1600 * 10 / 3), 1.0, EXACT);
}

// vertical sides, along the axes, between two columns, and turned
TEST(BodyVolume, Prisms)
{
  const auto block = [](double x, double y) { return x > 0.011 && x < 10.2 && y < 7 ? 0.5 : 0.0; };
  EXPECT_NEAR(body_volume({{0, 0}, {10.37, 7.1}}, NOWHERE, block) / (10.189 * 7 * 0.5), 1.0, EXACT);
  const auto turned = [](double x, double y) {
    const double u = (x + y) / std::sqrt(2.0), v = (x - y) / std::sqrt(2.0);
    return std::fabs(u) < 6 && std::fabs(v) < 2 ? 2.0 : 0.0;
  };
  EXPECT_NEAR(body_volume({{-10, -10}, {10, 10}}, NOWHERE, turned) / 96, 1.0, EXACT);
  const auto full = [](double, double) { return 3.0; };
  EXPECT_NEAR(body_volume({{0, 0}, {1, 2}}, NOWHERE, full) / 6, 1.0, 1e-9);
}

// 10 m in a box of 50 km, between the first columns: found where balls are, all of it
TEST(BodyVolume, SmallInAWideBox)
{
  const auto disc = [](double x, double y) {
    return std::hypot(x - 25501, y - 25501) < 5 ? 10.0 : 0.0;
  };
  const PlanBox all = {{0, 0}, {50000, 50000}};
  EXPECT_EQ(body_volume(all, NOWHERE, disc), 0.0);
  const PlanBox balls = {{25496.5, 25496.5}, {25505, 25505}};
  EXPECT_NEAR(body_volume(all, balls, disc) / (PI * 250), 1.0, EXACT);
}

TEST(BodyVolume, NothingThere)
{
  const auto nothing = [](double, double) { return 0.0; };
  EXPECT_EQ(body_volume({{0, 0}, {1, 1}}, NOWHERE, nothing), 0.0);
  EXPECT_EQ(body_volume({{0, 0}, {1, 1}}, {{0, 0}, {1, 1}}, nothing), 0.0);
  EXPECT_EQ(body_volume({{0, 0}, {1, 0}}, NOWHERE, [](double, double) { return 1.0; }), 0.0);
}

// a body that grows while it is looked at: no sum settles
TEST(BodyVolume, WhatHasNoVolumeIsAnError)
{
  double top = 1.0;
  const auto growing = [&top](double, double) { return top *= 1.0 + 1e-6; };
  try {
    body_volume({{0, 0}, {1, 1}}, NOWHERE, growing);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find("its volume must be a number to 1e-3, got"),
              std::string::npos);
  }
}

// threads as ranks
TEST(BodyVolume, SameOnAnyRanks)
{
  const auto length = [](double x, double y) {
    const bool in = std::hypot(x - 2, y) < 3 + 0.2 * std::sin(5 * x);
    return in ? std::max(0.0, 1 - y * y / 30 - 0.1 * x) : 0.0;
  };
  const PlanBox box = {{-10, -10}, {10, 10}}, balls = {{1, -1}, {2, 1}};
  const double expected = body_volume(box, balls, length);

  const int n = 3;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<double> total;
  int arrived = 0, left = 0;
  const auto sum = [&](std::vector<double> &values) {
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait(lock, [&]() { return left == 0; });
    if (arrived == 0) total.assign(values.size(), 0.0);
    for (size_t k = 0; k < values.size(); k++) total[k] += values[k];
    if (++arrived == n) left = n;
    changed.notify_all();
    changed.wait(lock, [&]() { return left > 0; });
    values = total;
    if (--left == 0) arrived = 0;
    changed.notify_all();
  };
  std::vector<double> found(n);
  std::vector<std::thread> ranks;
  for (int me = 0; me < n; me++)
    ranks.emplace_back([&, me]() {
      found[me] = body_volume(box, balls, length, {me, n, sum});
    });
  for (auto &rank : ranks) rank.join();
  for (const double volume : found) EXPECT_EQ(volume, expected);
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// The volume of bodies of which only the inside is known is theirs to 1e-3: round, with walls that
// do and do not follow the columns, thin in a high box, in layers, small in a wide box; and the same
// to the bit on any number of ranks.

#include "body_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <condition_variable>
#include <mutex>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using Slope::BodyVolume;

static const double PI = 3.14159265358979323846;
static const double EXACT = 1.0e-3;

static double volume(const BodyVolume::Box &box, const BodyVolume::Inside &inside)
{
  return BodyVolume(box, inside).volume();
}

TEST(BodyVolume, Sphere)
{
  const auto inside = [](double x, double y, double z) { return x * x + y * y + z * z < 1.0; };
  EXPECT_NEAR(volume({{-1, -1, -1}, {1, 1, 1}}, inside) / (4 * PI / 3), 1.0, EXACT);
  EXPECT_NEAR(volume({{-3, -1.5, -9}, {2, 7, 4}}, inside) / (4 * PI / 3), 1.0, EXACT);
}

// a wedge that thins out to nothing at its rim, as a body does where the slip surface comes out
TEST(BodyVolume, ConeOnTheFloor)
{
  const auto inside = [](double x, double y, double z) {
    return z < 10 * (1 - std::hypot(x - 50, y - 50) / 40);
  };
  EXPECT_NEAR(volume({{0, 0, 0}, {100, 100, 30}}, inside) / (PI * 1600 * 10 / 3), 1.0, EXACT);
  const auto flat = [](double x, double y, double z) {    // most of it thinner than a step
    return z < 0.5 * (1 - std::hypot(x - 50, y - 50) / 40);
  };
  EXPECT_NEAR(volume({{0, 0, 0}, {100, 100, 30}}, flat) / (PI * 1600 * 0.5 / 3), 1.0, EXACT);
}

// vertical sides, along the axes, between two columns, and turned
TEST(BodyVolume, Prisms)
{
  const auto block = [](double x, double y, double z) {
    return x > 0.011 && x < 10.2 && y > 0 && y < 7 && z > 1 && z < 1.5;
  };
  EXPECT_NEAR(volume({{0, 0, 0}, {10.37, 7.1, 3}}, block) / (10.189 * 7 * 0.5), 1.0, EXACT);
  const auto turned = [](double x, double y, double z) {
    const double u = (x + y) / std::sqrt(2.0), v = (x - y) / std::sqrt(2.0);
    return std::fabs(u) < 6 && std::fabs(v) < 2 && std::fabs(z) < 1;
  };
  EXPECT_NEAR(volume({{-10, -10, -10}, {10, 10, 10}}, turned) / 96, 1.0, EXACT);
  const auto full = [](double, double, double) { return true; };
  EXPECT_NEAR(volume({{0, 0, 0}, {1, 2, 3}}, full) / 6, 1.0, 1e-9);
}

// a blanket of 5 m, and of 1 m, on a slope of 48 degrees in a box 600 m high
TEST(BodyVolume, ThinOnASteepSlope)
{
  for (const double thick : {5.0, 1.0}) {
    const auto inside = [thick](double x, double y, double z) {
      const double ground = x - 0.5 * y;
      return std::hypot(x - 150, y - 150) < 60 && z < ground && z > ground - thick;
    };
    EXPECT_NEAR(volume({{0, 0, -300}, {300, 300, 300}}, inside) / (PI * 3600 * thick), 1.0, EXACT);
  }
}

// what is between two layers is not part of the body; gaps and sheets thinner than a step count
TEST(BodyVolume, Layers)
{
  const auto inside = [](double, double, double z) {
    return (z > 1 && z < 2) || (z > 2.05 && z < 4) || z > 8;
  };
  EXPECT_NEAR(volume({{0, 0, 0}, {10, 10, 10}}, inside) / 495, 1.0, EXACT);
  const auto sheet = [](double, double, double z) { return (z > 1 && z < 3) || (z > 8 && z < 8.2); };
  EXPECT_NEAR(volume({{0, 0, 0}, {10, 10, 10}}, sheet) / 220, 1.0, EXACT);
}

// 100 m in a box of 5 km: found where balls are
TEST(BodyVolume, SmallInAWideBox)
{
  const auto inside = [](double x, double y, double z) {
    return std::hypot(x - 2550, y - 2550) < 50 && z > 500 && z < 510;
  };
  BodyVolume body({{0, 0, 0}, {5000, 5000, 1000}}, inside);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(2500, 2600);
  for (int k = 0; k < 500; k++) {
    const double x = place(random), y = place(random);
    if (inside(x, y, 505)) body.mark(x, y);
  }
  EXPECT_NEAR(body.volume() / (PI * 2500 * 10), 1.0, EXACT);
}

TEST(BodyVolume, NothingThere)
{
  const auto inside = [](double, double, double) { return false; };
  EXPECT_EQ(volume({{0, 0, 0}, {1, 1, 1}}, inside), 0.0);
  EXPECT_EQ(volume({{0, 0, 0}, {1, 0, 1}}, [](double, double, double) { return true; }), 0.0);
  BodyVolume body({{0, 0, 0}, {100, 100, 100}}, inside);
  body.mark(50, 50);
  EXPECT_EQ(body.volume(), 0.0);
}

// a body that grows while it is looked at: no sum settles
TEST(BodyVolume, WhatHasNoVolumeIsAnError)
{
  double top = 1.0;
  const auto growing = [&top](double, double, double z) { return z < (top *= 1.0 + 1e-8); };
  try {
    volume({{0, 0, 0}, {1, 1, 1e4}}, growing);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find("its volume must be a number to 1e-3, got"),
              std::string::npos);
  }
}

// threads as ranks
TEST(BodyVolume, SameOnAnyRanks)
{
  const auto inside = [](double x, double y, double z) {
    return std::hypot(x - 2, y) < 3 + 0.2 * std::sin(5 * x) && z > 0.1 * x && z < 1 - 0.3 * y * y / 9;
  };
  const BodyVolume::Box box = {{-10, -10, -10}, {10, 10, 10}};
  BodyVolume one(box, inside);
  one.mark(2, 0);
  one.mark(2, 1);
  const double expected = one.volume();

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
      BodyVolume body(box, inside, {me, n, sum});
      if (me == 1) body.mark(2, 0);
      if (me == 2) body.mark(2, 1);
      found[me] = body.volume();
    });
  for (auto &rank : ranks) rank.join();
  for (const double volume : found) EXPECT_EQ(volume, expected);
}

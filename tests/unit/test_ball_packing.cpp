/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The disordered packing: no two balls touch, the solid fraction of any body, no order as in a lattice, and
   each seed another one. */

#include "ball_packing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

using namespace Slope;

namespace {

using Place = std::array<double, 3>;

constexpr double PI = 3.14159265358979323846;

std::vector<Place> centres(const BallPacking &packing, const Place &lo, const Place &hi)
{
  std::vector<Place> found;
  packing.visit(lo.data(), hi.data(), [&](const double *x) {
    found.push_back({{x[0], x[1], x[2]}});
  });
  return found;
}

std::vector<Place> cube(double d, uint64_t seed, double side)
{
  return centres(BallPacking(d, seed), {{3.0, -2.0, 1.0}}, {{3.0 + side, -2.0 + side, 1.0 + side}});
}

std::vector<Place> cubic_lattice(double d, double side)
{
  std::vector<Place> found;
  const int n = static_cast<int>(side / d);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      for (int k = 0; k < n; k++) found.push_back({{3.0 + i * d, -2.0 + j * d, 1.0 + k * d}});
  return found;
}

// calls with the distance of each pair that is nearer than reach, and its first ball

template <typename Take> void each_pair(const std::vector<Place> &balls, double reach, Take take)
{
  std::map<std::array<int, 3>, std::vector<size_t>> cells;
  const auto cell = [&](const Place &p) {
    return std::array<int, 3>{{static_cast<int>(std::floor(p[0] / reach)),
                               static_cast<int>(std::floor(p[1] / reach)),
                               static_cast<int>(std::floor(p[2] / reach))}};
  };
  for (size_t n = 0; n < balls.size(); n++) cells[cell(balls[n])].push_back(n);
  for (size_t n = 0; n < balls.size(); n++) {
    const auto at = cell(balls[n]);
    for (int i = -1; i <= 1; i++)
      for (int j = -1; j <= 1; j++)
        for (int k = -1; k <= 1; k++) {
          const auto near = cells.find({{at[0] + i, at[1] + j, at[2] + k}});
          if (near == cells.end()) continue;
          for (size_t m : near->second) {
            const Place &p = balls[n], &q = balls[m];
            const double r = std::sqrt(std::pow(p[0] - q[0], 2) + std::pow(p[1] - q[1], 2) +
                                       std::pow(p[2] - q[2], 2));
            if (m != n && r < reach) take(r, n);
          }
        }
  }
}

// pair correlation in bins of a twentieth of a diameter up to 5 diameters, of the balls that far inside

std::vector<double> pair_correlation(const std::vector<Place> &balls, double d, double side)
{
  static constexpr double BINS = 20.0, FAR = 5.0;
  const Place lo = {{3.0, -2.0, 1.0}};
  std::vector<bool> inner(balls.size(), true);
  for (size_t n = 0; n < balls.size(); n++)
    for (int c = 0; c < 3; c++)
      if (balls[n][c] < lo[c] + FAR * d || balls[n][c] > lo[c] + side - FAR * d) inner[n] = false;
  std::vector<double> g(static_cast<size_t>(BINS * FAR));
  each_pair(balls, FAR * d, [&](double r, size_t n) {
    if (inner[n]) g[static_cast<size_t>(BINS * r / d)] += 1.0;
  });
  const double from = std::count(inner.begin(), inner.end(), true);
  const double density = balls.size() / (side * side * side);
  for (size_t k = 0; k < g.size(); k++) {
    const double a = k * d / BINS, b = (k + 1) * d / BINS;
    g[k] /= from * density * 4.0 / 3.0 * PI * (b * b * b - a * a * a);
  }
  return g;
}

double largest_beyond(const std::vector<double> &g, double from)
{
  return *std::max_element(g.begin() + static_cast<size_t>(20.0 * from + 0.5), g.end());
}

}    // namespace

/* ---------------------------------------------------------------------- */

TEST(BallPacking, no_two_balls_touch_and_some_nearly_do)
{
  for (double d : {0.37, 1.0, 25.0})
    for (uint64_t seed : {1u, 2u, 60u}) {
      const std::vector<Place> balls = cube(d, seed, 30.0 * d);
      double least = HUGE_VAL;
      each_pair(balls, 1.5 * d, [&](double r, size_t) {
        least = std::min(least, r);
      });
      EXPECT_GT(least, 1.0001 * d) << d << " " << seed;
      EXPECT_LT(least, 1.0005 * d) << d << " " << seed;
    }
}

TEST(BallPacking, solid_fraction_of_cubes_spheres_and_slabs)
{
  const double d = 0.8, ball = PI / 6.0 * d * d * d;
  for (const auto &size : {std::make_pair(500.0, 0.02), std::make_pair(2000.0, 0.01),
                           std::make_pair(16000.0, 0.005)}) {
    const double volume = size.first * ball / 0.60, a = std::cbrt(volume);
    const double r = std::cbrt(0.75 * volume / PI);
    double slabs = 0.0;
    for (uint64_t seed = 1; seed <= 20; seed++) {
      const BallPacking packing(d, seed);
      const double in_cube =
          centres(packing, {{5.0, 6.0, 7.0}}, {{5.0 + a, 6.0 + a, 7.0 + a}}).size();
      EXPECT_NEAR(in_cube * ball / volume, 0.60, size.second) << size.first << " " << seed;
      double in_sphere = 0.0;
      for (const Place &p : centres(packing, {{-r, -r, -r}}, {{r, r, r}}))
        if (std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) < r) in_sphere += 1.0;
      EXPECT_NEAR(in_sphere * ball / volume, 0.60, size.second) << size.first << " " << seed;
      slabs +=
          centres(packing, {{5.0, 6.0, 7.0}}, {{5.0 + 2 * a, 6.0 + 2 * a, 7.0 + a / 4}}).size();
    }
    EXPECT_NEAR(slabs / 20.0 * ball / volume, 0.60, 0.005) << size.first;
    EXPECT_NEAR(BallPacking(d, 1).expected(volume), size.first, 1e-6);
  }
}

TEST(BallPacking, pair_correlation_has_no_peaks_of_a_lattice)
{
  const double d = 0.5, side = 22.0 * d;
  for (uint64_t seed : {1u, 2u, 3u})
    EXPECT_LT(largest_beyond(pair_correlation(cube(d, seed, side), d, side), 1.2), 2.0) << seed;
  EXPECT_GT(largest_beyond(pair_correlation(cubic_lattice(d, side), d, side), 1.2), 4.0);
}

// the balls in a slice, as of a section: a lattice has planes of balls, one behind the other

TEST(BallPacking, has_no_planes_of_balls)
{
  const auto unevenness = [](const std::vector<Place> &balls, double d, const Place &normal) {
    double c = 0.0, s = 0.0;
    for (const Place &p : balls) {
      const double phase = 2.0 * PI / d * (p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2]);
      c += std::cos(phase);
      s += std::sin(phase);
    }
    return std::hypot(c, s) / balls.size();
  };
  const double d = 1.0, side = 11.0;
  for (uint64_t seed = 1; seed <= 10; seed++)
    for (const Place &n : {Place{{1.0, 0.0, 0.0}}, Place{{0.0, 1.0, 0.0}}, Place{{0.0, 0.0, 1.0}}})
      EXPECT_LT(unevenness(cube(d, seed, side), d, n), 0.15) << seed;
  EXPECT_NEAR(unevenness(cubic_lattice(d, side), d, {{0.0, 0.0, 1.0}}), 1.0, 1e-9);
}

TEST(BallPacking, two_boxes_have_the_balls_of_the_whole)
{
  const BallPacking packing(0.7, 5);
  const Place lo = {{-9.0, 1000.0, 2.0}}, hi = {{4.0, 1011.0, 15.0}};
  Place left = hi, right = lo;
  left[0] = right[0] = -1.7;
  std::vector<Place> whole = centres(packing, lo, hi), parts = centres(packing, lo, left);
  for (const Place &p : centres(packing, right, hi)) parts.push_back(p);
  std::sort(whole.begin(), whole.end());
  std::sort(parts.begin(), parts.end());
  EXPECT_GT(whole.size(), 5000u);
  EXPECT_EQ(whole, parts);
}

TEST(BallPacking, each_seed_has_another_direction_and_place)
{
  std::vector<Place> first = cube(1.0, 1, 8.0);
  for (uint64_t seed = 2; seed <= 6; seed++) {
    std::vector<Place> both = cube(1.0, seed, 8.0);
    const size_t own = both.size();
    both.insert(both.end(), first.begin(), first.end());
    int near = 0;
    each_pair(both, 0.05, [&](double, size_t n) {
      near += n < own;
    });
    EXPECT_LT(near, 5) << seed;    // of some 590, by chance
  }
}

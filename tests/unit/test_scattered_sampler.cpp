/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Scattered fixed balls: one for each spacing^2 of a surface whatever its slope and direction, none too near
   another one, no order, and at the widest spacing no way through for a ball of the same size. */

#include "scattered_sampler.h"

#include "ball_flood.h"
#include "surface_gaps.h"
#include "surface_sampler.h"

#include <gtest/gtest.h>

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

using namespace Slope;

namespace {

constexpr double WIDEST = ScatteredSampler::WIDEST * 2.0 * R;

std::vector<double> places(BallSampler &sampler)
{
  std::vector<PlacedBall> balls;
  SurfaceCounts counts;
  const TilePlan tiles = sampler.tiles();
  for (int tile = 0; tile < tiles.nx * tiles.ny; tile++) sampler.sample(tile, balls, counts);
  EXPECT_EQ(counts.base, static_cast<int64_t>(balls.size()));
  std::vector<double> xyz;
  for (const PlacedBall &b : balls) xyz.insert(xyz.end(), {b.x, b.y, b.z});
  return xyz;
}

std::vector<double> scatter(double side, double spacing, const GroundHeights &surface, uint64_t seed = 1)
{
  ScatteredSampler sampler({0.0, side, 0.0, side, spacing, 0.3, 0.1}, surface, seed);
  return places(sampler);
}

double middle_of(const GroundHeights &s, double side)
{
  double z;
  s.height(0.5 * side, 0.5 * side, z);
  return z;
}

// a box around the middle of a surface, over its whole height there: is it a way for a ball?

bool gets_through(const std::vector<double> &xyz, const GroundHeights &s, double side)
{
  double zlo = HUGE_VAL, zhi = -HUGE_VAL, z;
  for (double x = 1.0; x <= side - 1.0; x += 0.1)
    for (double y = 1.0; y <= side - 1.0; y += 0.1)
      if (s.height(x, y, z)) {
        zlo = std::min(zlo, z);
        zhi = std::max(zhi, z);
      }
  return ball_gets_through(xyz, 2.0 * R, {{1.0, 1.0, zlo - 2.0}}, {{side - 1.0, side - 1.0, zhi + 2.0}});
}

}    // namespace

/* ---------------------------------------------------------------------- */

TEST(ScatteredSampler, one_ball_for_each_square_of_the_spacing_on_any_slope)
{
  for (double spacing : {0.5, 0.9})
    for (double degrees : {0.0, 22.0, 45.0, 60.0, 80.0})
      for (double azimuth : {0.0, 22.5, 45.0}) {
        const double side = degrees < 70.0 ? 60.0 * spacing : 25.0 * spacing, rim = 2.0 * spacing;
        const std::vector<double> xyz = scatter(side, spacing, plane(degrees, azimuth), 3);
        int inside = 0;
        for (size_t k = 0; k < xyz.size(); k += 3)
          inside += xyz[k] > rim && xyz[k] < side - rim && xyz[k + 1] > rim && xyz[k + 1] < side - rim;
        const double squares = std::pow((side - 2.0 * rim) / spacing, 2.0) / std::cos(degrees * PI / 180.0);
        EXPECT_NEAR(inside / squares, 1.0, 0.03) << degrees << " degrees, azimuth " << azimuth;
      }
}

TEST(ScatteredSampler, no_two_are_near_and_no_point_of_the_surface_is_far)
{
  for (double degrees : {0.0, 35.0, 60.0, 75.0, 80.0})
    for (double azimuth : {0.0, 30.0, 45.0}) {
      const double side = degrees < 60.0 ? 16.0 : 7.0;
      const GroundHeights s = plane(degrees, azimuth);
      const std::vector<double> xyz = scatter(side, WIDEST, s, 5);
      for (size_t a = 0; a < xyz.size(); a += 3)
        for (size_t b = 0; b < a; b += 3)
          ASSERT_GT(std::sqrt(std::pow(xyz[a] - xyz[b], 2) + std::pow(xyz[a + 1] - xyz[b + 1], 2) +
                              std::pow(xyz[a + 2] - xyz[b + 2], 2)),
                    0.79 * WIDEST);
      // up to the edges of the rectangle; on level ground the bound is (0.795 + sqrt(2) / 6) spacings
      EXPECT_LT(worst_gap(s, Nearest(xyz), 0.0, side, 0.0, side, std::tan(degrees * PI / 180.0)), 1.96)
          << degrees << " degrees, azimuth " << azimuth;
    }
}

// The intensity that a regular pattern scatters waves with is the number of balls at some wave vectors. Here none up
// to those of the finer lattice stands out: of 10,000 independent places the largest of 600 would be 6 to 10.

TEST(ScatteredSampler, has_no_order)
{
  auto strongest = [](const std::vector<double> &xyz) {
    double most = 0.0;
    for (int direction = 0; direction < 12; direction++)
      for (double waves = 0.3; waves < 6.5; waves += 0.01) {
        const double a = direction * PI / 12.0, k = 2.0 * PI * waves;
        std::complex<double> sum = 0.0;
        for (size_t b = 0; b < xyz.size(); b += 3)
          sum += std::polar(1.0, k * (std::cos(a) * xyz[b] + std::sin(a) * xyz[b + 1]));
        most = std::max(most, std::norm(sum) / (xyz.size() / 3));
      }
    return most;
  };
  const GroundHeights level = plane(0.0, 0.0);
  EXPECT_LT(strongest(scatter(40.0, 1.0, level)), 30.0);
  SurfaceSampler on_grid({0.0, 40.0, 0.0, 40.0, 1.0, 0.0, 0.0}, R, level);
  EXPECT_GT(strongest(places(on_grid)), 1000.0);
}

TEST(ScatteredSampler, seeds_differ_and_the_plan_does_not_matter)
{
  const GroundHeights s = plane(40.0, 20.0);
  const std::vector<double> one = scatter(20.0, 0.9, s, 1), two = scatter(20.0, 0.9, s, 2);
  EXPECT_NE(one, two);
  int same = 0, inside = 0;    // of a larger rectangle, those away from the rim of the smaller one
  ScatteredSampler larger({-31.0, 44.0, -7.5, 90.0, 0.9, 0.3, 0.1}, s, 1);
  std::vector<std::array<double, 3>> all;
  const std::vector<double> xyz = places(larger);
  for (size_t k = 0; k < xyz.size(); k += 3) all.push_back({{xyz[k], xyz[k + 1], xyz[k + 2]}});
  std::sort(all.begin(), all.end());
  for (size_t k = 0; k < one.size(); k += 3) {
    if (std::min(one[k], one[k + 1]) < 5.0 || std::max(one[k], one[k + 1]) > 15.0) continue;
    inside++;
    same += std::binary_search(all.begin(), all.end(), std::array<double, 3>{{one[k], one[k + 1], one[k + 2]}});
  }
  EXPECT_GT(inside, 100);
  EXPECT_EQ(same, inside);
}

// Zones of other spacings: a triangle, a strip that is narrower than a spacing, and what is around them

struct Zones {
  double around, triangle, strip;
  double of(double x, double y) const
  {
    if (x > 9.0 && y > 6.0 && x + 0.7 * y < 26.0) return triangle;
    return std::fabs(y - 3.0 - 0.1 * x) < 0.2 ? strip : around;
  }
};

std::vector<double> scatter_zones(double side, const Zones &zones, const GroundHeights &s, int tile = 32)
{
  auto part = [&](double spacing) {
    GroundHeights its = s;
    its.keep = [=](double x, double y) {
      return zones.of(x, y) == spacing;
    };
    return its;
  };
  ScatteredSampler sampler({0.0, side, 0.0, side, zones.around, 0.3, 0.1}, part(zones.around), 5, tile);
  sampler.add(zones.triangle, part(zones.triangle));
  sampler.add(zones.strip, part(zones.strip));
  return places(sampler);
}

TEST(ScatteredSampler, at_a_seam_none_are_nearer_and_no_gap_is_larger_than_in_the_zones)
{
  const double side = 24.0;
  for (double degrees : {0.0, 40.0})
    for (const Zones &zones : {Zones{WIDEST, 0.5, 0.7}, Zones{0.4, WIDEST, 0.5}, Zones{WIDEST, 0.94, 0.3},
                               Zones{WIDEST, 0.5, 0.94}}) {
      const GroundHeights s = plane(degrees, 25.0);
      const std::vector<double> xyz = scatter_zones(side, zones, s);
      auto spacing = [&](size_t k) {
        return zones.of(xyz[k], xyz[k + 1]);
      };
      for (size_t a = 0; a < xyz.size(); a += 3)
        for (size_t b = 0; b < a; b += 3)
          ASSERT_GT(std::sqrt(std::pow(xyz[a] - xyz[b], 2) + std::pow(xyz[a + 1] - xyz[b + 1], 2) +
                              std::pow(xyz[a + 2] - xyz[b + 2], 2)),
                    0.79 * std::min(spacing(a), spacing(b)));
      const Nearest nearest(xyz);
      double worst = 0.0, z;    // in spacings, at most (0.795 + sqrt(2) / 6) on level ground
      for (double x = 0.0; x <= side; x += 0.05)
        for (double y = 0.0; y <= side; y += 0.05) {
          s.height(x, y, z);
          worst = std::max(worst, nearest(x, y, z) * R / zones.of(x, y));
        }
      EXPECT_LT(worst, 1.031) << degrees << " degrees, spacings " << zones.around << " " << zones.triangle << " "
                              << zones.strip;
    }
}

TEST(ScatteredSampler, zones_have_the_places_of_their_spacing_whatever_the_tiles)
{
  const GroundHeights s = plane(30.0, 25.0);
  const Zones zones = {0.9, 0.5, 0.7};
  auto sorted = [](const std::vector<double> &xyz) {
    std::vector<std::array<double, 3>> all;
    for (size_t k = 0; k < xyz.size(); k += 3) all.push_back({{xyz[k], xyz[k + 1], xyz[k + 2]}});
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto all = sorted(scatter_zones(24.0, zones, s));
  EXPECT_EQ(all, sorted(scatter_zones(24.0, zones, s, 4)));
  for (double one : {zones.around, zones.triangle}) {    // away from seams
    ScatteredSampler alone({0.0, 24.0, 0.0, 24.0, one, 0.3, 0.1}, s, 5);
    int inside = 0, same = 0;
    for (const auto &p : sorted(places(alone))) {
      bool deep = true;
      for (double dx : {-3.0, 0.0, 3.0})
        for (double dy : {-3.0, 0.0, 3.0}) deep = deep && zones.of(p[0] + dx, p[1] + dy) == one;
      if (!deep) continue;
      inside++;
      same += std::binary_search(all.begin(), all.end(), p);
    }
    EXPECT_GT(inside, 20);
    EXPECT_GT(same, 0.98 * inside);    // a chain of ranks may be long
  }
}

TEST(ScatteredSampler, refuses_what_makes_no_plan)
{
  const GroundHeights s = plane(0.0, 0.0);
  EXPECT_THROW(ScatteredSampler({0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0}, s, 1), std::invalid_argument);
  EXPECT_THROW(ScatteredSampler({1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0}, s, 1), std::invalid_argument);
  EXPECT_THROW(ScatteredSampler({0.0, 1e9, 0.0, 1e9, 1.0, 0.0, 0.0}, s, 1), std::length_error);
  GroundHeights cliff;
  cliff.height = [](double x, double, double &z) {
    z = x < 5.0 ? 0.0 : 3000.0;
    return true;
  };
  EXPECT_THROW(scatter(10.0, 1.0, cliff), std::length_error);
}

/* ----------------------------------------------------------------------
   floods
------------------------------------------------------------------------- */

TEST(ScatteredSampler, no_way_through_planes)
{
  for (int degrees = 0; degrees <= 80; degrees += 10)
    for (double azimuth : {0.0, 22.5, 45.0, 77.0}) {
      const double side = degrees < 60 ? 14.0 : 8.0;
      const GroundHeights s = plane(degrees, azimuth);
      EXPECT_FALSE(gets_through(scatter(side, WIDEST, s, 1 + degrees), s, side)) << degrees << " " << azimuth;
    }
  const GroundHeights level = plane(0.0, 0.0);    // the flood would notice
  EXPECT_TRUE(gets_through(scatter(14.0, 1.4 * WIDEST, level), level, 14.0));
}

TEST(ScatteredSampler, no_way_through_cones_pits_cliffs_and_waves)
{
  const double side = 12.0;
  for (uint64_t seed = 1; seed <= 6; seed++) {
    GroundHeights cone, pit, cliff, waves;
    const double g = std::tan((55.0 + 4.0 * seed) * PI / 180.0);
    cone.height = [=](double x, double y, double &z) {
      z = -g * std::hypot(x - 6.1, y - 5.8);
      return true;
    };
    pit.height = [=](double x, double y, double &z) {
      z = g * std::min(std::hypot(x - 5.7, y - 6.3), 3.0);
      return true;
    };
    cliff.height = [=](double x, double y, double &z) {
      z = x + 0.2 * seed * y < 6.0 + 0.1 * seed ? 0.0 : 9.0;
      return true;
    };
    waves.height = [=](double x, double y, double &z) {
      z = 0.7 * x + 4.0 * std::sin(0.5 * x + seed) * std::cos(0.9 * y);
      return true;
    };
    for (const GroundHeights &s : {cone, pit, cliff, waves})
      EXPECT_FALSE(gets_through(scatter(side, WIDEST, s, seed), s, side)) << seed;
  }
}

// the field outside of a release, and the slip balls below it

TEST(ScatteredSampler, no_way_past_the_scarp_of_a_release)
{
  const double side = 12.0;
  int without_scarp = 0;
  for (uint64_t seed = 1; seed <= 6; seed++) {
    const std::vector<std::array<double, 2>> corner = {{{2.2, 5.1}}, {{9.4, 2.5}}, {{10.0, 8.7}}};
    auto ground = [=](double x, double y) { return 0.1 * seed * x + 0.2 * y; };
    auto slip = [=](double x, double y, double &z) {
      z = 0.3 * x - 3.0;
      return in_polygon(corner, x, y) && z <= ground(x, y);
    };
    GroundHeights field, bottom;
    field.height = [=](double x, double y, double &z) {
      z = ground(x, y);
      return true;
    };
    field.keep = [=](double x, double y) {
      double z;
      return !slip(x, y, z);
    };
    field.scar = slip;
    bottom.height = slip;
    for (bool scarp : {true, false}) {
      if (!scarp) field.scar = nullptr;
      std::vector<double> xyz = scatter(side, WIDEST, field, seed);
      SurfaceSampler slip_balls({0.0, side, 0.0, side, 0.5, 0.3, 0.1}, R, bottom);
      const std::vector<double> below = places(slip_balls);
      xyz.insert(xyz.end(), below.begin(), below.end());
      const bool way = ball_gets_through(xyz, 2.0 * R, {{0.5, 0.5, -5.0}}, {{side - 0.5, side - 0.5, 12.0}});
      if (scarp)
        EXPECT_FALSE(way) << seed;
      else
        without_scarp += way;
    }
  }
  EXPECT_GT(without_scarp, 3);
}

TEST(ScatteredSampler, a_hole_in_the_data_is_closed_up_to_its_rim)
{
  GroundHeights s = plane(35.0, 10.0);
  const auto whole = s.height;
  s.height = [=](double x, double y, double &z) {
    return whole(x, y, z) && !(x > 3.3 && x < 6.8 && y > 4.1 && y < 5.9);
  };
  for (uint64_t seed = 1; seed <= 5; seed++)
    EXPECT_LT(worst_gap(s, Nearest(scatter(10.0, WIDEST, s, seed)), 0.0, 10.0, 0.0, 10.0, 0.7), 1.96);
}

// each holds a cell of the lattice and is narrower than two balls may be near; most lie between the places that are
// looked at first

TEST(ScatteredSampler, small_pieces_of_ground_have_a_ball_each)
{
  GroundHeights s = plane(20.0, 30.0);
  const auto whole = s.height;
  s.height = [=](double x, double y, double &z) {
    return whole(x, y, z) && std::hypot(std::remainder(x - 1.05, 2.1), std::remainder(y - 1.05, 2.1)) < 0.24;
  };
  EXPECT_EQ(scatter(42.0, 1.0, s).size(), 3u * 20 * 20);
}

TEST(ScatteredSampler, no_curtain_up_to_a_region_above_the_ground)
{
  GroundHeights s = plane(0.0, 0.0);
  s.keep = [](double x, double y) {
    return std::hypot(x - 5.0, y - 5.0) > 2.5;
  };
  const std::vector<double> without = scatter(10.0, WIDEST, s);
  s.scar = [](double, double, double &z) {
    z = 3.0;
    return true;
  };
  EXPECT_EQ(scatter(10.0, WIDEST, s), without);
}

// of tiles that follow each other: 200 MB a rank, once
TEST(ScatteredSampler, remembers_little)
{
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "its memory is not malloc's";
#endif
  ScatteredSampler sampler({0.0, 160.0, 0.0, 160.0, 1.0, 0.3, 0.1}, plane(20.0, 30.0), 7);
  const TilePlan tiles = sampler.tiles();
  std::vector<PlacedBall> balls;
  SurfaceCounts counts;
  const size_t before = mallinfo2().uordblks;
  size_t most = 0;
  for (int tile = 0; tile < tiles.nx * tiles.ny; tile++) {
    balls.clear();
    sampler.sample(tile, balls, counts);
    most = std::max(most, mallinfo2().uordblks - before);
  }
  EXPECT_GT(most, 2000000);
  EXPECT_LT(most, 20000000);
}

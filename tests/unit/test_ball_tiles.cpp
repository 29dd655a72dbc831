/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The ground tile by tile: the same balls and numbers whatever the size of the tiles, their order and
   what was asked before; and the search in the tiles that were made finds what a loop over all finds. */

#include "ball_tiles.h"
#include "scattered_sampler.h"
#include "surface_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

using namespace Slope;

namespace {

constexpr double R = 0.5, SIDE = 90.0;

// waves with steep flanks, a hole, and a filter with a wedge that is narrower than the spacing

GroundHeights waves()
{
  GroundHeights s;
  s.height = [](double x, double y, double &z) {
    z = 0.7 * x + 4.0 * std::sin(0.5 * x) * std::cos(0.4 * y);
    return std::hypot(x - 60.0, y - 20.0) > 7.0;
  };
  s.keep = [](double x, double y) {
    return !(std::fabs(x - 20.3 - 0.01 * y) < 0.01 * (75.0 - y) && y > 3.0);
  };
  s.scar = [](double x, double y, double &z) {
    z = 0.7 * x + 4.0 * std::sin(0.5 * x) * std::cos(0.4 * y) - 3.0;
    return true;
  };
  return s;
}

NodeGrid grid(double spacing)
{
  return {0.0, SIDE, 0.0, 0.8 * SIDE, spacing, 0.3, 0.1};
}

// the two patterns

typedef std::unique_ptr<BallSampler> (*Make)(double spacing, int tile);

std::unique_ptr<BallSampler> on_grid(double spacing, int tile)
{
  return std::unique_ptr<BallSampler>(new SurfaceSampler(grid(spacing), R, waves(), tile));
}

std::unique_ptr<BallSampler> scattered(double spacing, int tile)
{
  return std::unique_ptr<BallSampler>(new ScatteredSampler(grid(spacing), waves(), 7, tile));
}

std::vector<PlacedBall> by_tiles(Make make, double spacing, int tile, unsigned seed)
{
  const std::unique_ptr<BallSampler> sampler = make(spacing, tile);
  std::vector<int> order(sampler->tiles().nx * sampler->tiles().ny);
  for (size_t k = 0; k < order.size(); k++) order[k] = static_cast<int>(k);
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<PlacedBall> balls;
  SurfaceCounts counts;
  for (int k : order) {
    if (random() % 4 == 0) sampler->forget();
    sampler->sample(k, balls, counts);
  }
  EXPECT_EQ(counts.base + counts.extra, static_cast<int64_t>(balls.size()));
  in_order(balls);
  return balls;
}

}    // namespace

TEST(SurfaceTiles, size_and_order_of_tiles_change_nothing)
{
  for (Make make : {on_grid, scattered})
    for (double spacing : {1.9 * R, R}) {
      const std::vector<PlacedBall> whole = by_tiles(make, spacing, 1024, 1);
      EXPECT_GT(std::count_if(whole.begin(), whole.end(), [](const PlacedBall &b) { return !b.first_of_cell(); }), 200);
      for (int tile : {32, 4, 64, 128}) {
        const std::vector<PlacedBall> balls = by_tiles(make, spacing, tile, tile);
        ASSERT_EQ(balls.size(), whole.size()) << tile;
        for (size_t k = 0; k < balls.size(); k++) {
          ASSERT_EQ(balls[k].number, whole[k].number) << tile;
          ASSERT_TRUE(balls[k].x == whole[k].x && balls[k].y == whole[k].y && balls[k].z == whole[k].z) << tile;
        }
      }
    }
}

TEST(SurfaceTiles, numbers_are_exact_in_a_double_and_of_one_ball_each)
{
  for (Make make : {on_grid, scattered}) {
    std::set<int64_t> seen;
    for (const PlacedBall &b : by_tiles(make, 2.0 * R, 32, 3)) {
      EXPECT_TRUE(seen.insert(b.number).second);
      EXPECT_EQ(static_cast<int64_t>(static_cast<double>(b.number)), b.number);
      EXPECT_LT(b.number, int64_t(1) << 52);
    }
  }
}

TEST(SurfaceTiles, a_tile_must_be_a_power_of_two)
{
  EXPECT_THROW(SurfaceSampler(grid(1.0), R, waves(), 24), std::invalid_argument);
  EXPECT_THROW(SurfaceSampler(grid(1.0), 0.0, waves()), std::invalid_argument);
}

/* ---------------------------------------------------------------------- */

// the same ground, turned about a place if angle is not 0

static void expect_to_find_all(Make make, double angle)
{
  const double about[2] = {31.0, -7.0}, c = std::cos(angle), s = std::sin(angle);
  auto turn = [&](PlacedBall &b) {
    const double dx = b.x - about[0], dy = b.y - about[1];
    b.x = about[0] + c * dx - s * dy;
    b.y = about[1] + s * dx + c * dy;
  };
  const std::unique_ptr<BallSampler> sampler = make(1.0, 32);
  std::vector<PlacedBall> all = by_tiles(make, 1.0, 32, 5);
  std::for_each(all.begin(), all.end(), turn);
  int made = 0;
  TilePlan plan = sampler->tiles();
  plan.turn(angle, about);
  BallTiles tiles(plan, 2.0 * R, [&](int tile, std::vector<PlacedBall> &balls) {
    SurfaceCounts counts;
    sampler->sample(tile, balls, counts);
    std::for_each(balls.begin(), balls.end(), turn);
    made++;
  });
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 2000; k++) {
    if (k == 1) {
      EXPECT_LE(made, 4);
    }
    PlacedBall here = {-3.0 + unit(random) * (SIDE + 6.0), -3.0 + unit(random) * (0.8 * SIDE + 6.0), 0.0, 0, 0};
    const double reach = 0.5 + 2.0 * unit(random);
    here.z = 0.7 * here.x + 8.0 * (unit(random) - 0.5);
    turn(here);
    const double at[3] = {here.x, here.y, here.z};
    std::set<int64_t> expected, found;
    for (const PlacedBall &b : all)
      if (std::pow(b.x - at[0], 2) + std::pow(b.y - at[1], 2) + std::pow(b.z - at[2], 2) < reach * reach)
        expected.insert(b.number);
    tiles.visit_near(at, reach, [&](int b, double) { EXPECT_TRUE(found.insert(tiles.number(b)).second); });
    ASSERT_EQ(found, expected);
  }
  EXPECT_EQ(made, sampler->tiles().nx * sampler->tiles().ny);
}

TEST(BallTiles, finds_what_a_loop_over_all_balls_finds_and_makes_only_what_is_near)
{
  for (Make make : {on_grid, scattered})
    for (double angle : {0.0, 0.4, 2.5}) expect_to_find_all(make, angle);
}

TEST(BallTiles, what_nobody_asks_for_is_dropped_and_made_again)
{
  SurfaceSampler sampler(grid(1.0), R, waves());
  int made = 0;
  BallTiles tiles(sampler.tiles(), 2.0 * R, [&](int tile, std::vector<PlacedBall> &balls) {
    SurfaceCounts counts;
    sampler.sample(tile, balls, counts);
    made++;
  });
  auto near = [&](double x, double y) {
    std::set<int64_t> found;
    const double at[3] = {x, y, 0.7 * x};
    tiles.visit_near(at, 5.0, [&](int b, double) { found.insert(tiles.number(b)); });
    return found;
  };
  const auto first = near(10.0, 10.0), second = near(80.0, 60.0);
  ASSERT_FALSE(first.empty());
  for (double x : {10.0, 40.0})
    for (double y : {10.0, 40.0, 60.0}) near(x, y);
  const int before = made;
  for (int k = 0; k < 150; k++) {
    tiles.drop_unused();
    EXPECT_EQ(near(80.0, 60.0), second);
  }
  EXPECT_EQ(made, before);
  EXPECT_LT(tiles.made(), before);
  EXPECT_EQ(near(10.0, 10.0), first);
  EXPECT_EQ(made, before + 1);
}

TEST(BallTiles, a_single_tile_of_scattered_balls_is_kept)
{
  int made = 0;
  BallTiles tiles({0.0, 0.0, HUGE_VAL, 1, 1}, 1.0, [&](int, std::vector<PlacedBall> &balls) {
    balls = {{-1000.0, 3.0, 0.0, 0, 0}, {2000.0, -50.0, 5.0, 1, 2}};
    made++;
  });
  const double at[3] = {1999.5, -50.0, 5.0}, far[3] = {0.0, 0.0, 0.0};
  int number = -1;
  tiles.visit_near(at, 1.0, [&](int k, double d2) {
    number = static_cast<int>(tiles.number(k));
    EXPECT_DOUBLE_EQ(d2, 0.25);
  });
  EXPECT_EQ(number, 1);
  for (int k = 0; k < 200; k++) tiles.drop_unused();
  tiles.visit_near(far, 1.0, [&](int, double) { ADD_FAILURE(); });
  EXPECT_EQ(made, 1);
}

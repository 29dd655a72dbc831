/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// The squares of balls are cut exactly by the cells, on and off the grid and across periodic sides;
// windows of several ranks add up to the rasters; maxima, times and the change of the deposit.

#include "deposit_bins.h"
#include "deposit_rasters.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

using namespace Slope;

static const double EXTENT[4] = {-3.0, 9.3, 2.0, 8.0};

struct Ball {
  double x[2], side;
};

static std::vector<Ball> draw(int n, double beyond)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(EXTENT[0] - beyond, EXTENT[1] + beyond),
      y(EXTENT[2] - beyond, EXTENT[3] + beyond), side(0.2, 2.5);
  std::vector<Ball> balls(n);
  for (Ball &ball : balls) ball = {{x(random), y(random)}, side(random)};
  return balls;
}

static double bin_all(DepositBins &bins, const std::vector<Ball> &balls)
{
  bins.start();
  for (const Ball &ball : balls) bins.show(ball.x, ball.side);
  bins.open();
  double beyond = 0.0;
  for (const Ball &ball : balls) beyond += bins.bin(ball.x, ball.side, 1.0, 1.0);
  return beyond;
}

// length of a..b in c..d
static double shared(double a, double b, double c, double d)
{
  return std::max(0.0, std::min(b, d) - std::max(a, c));
}

// volume in cell i,j by the overlap of rectangles; shifts: images in a periodic box
static double expected(const PlanGrid &grid, const std::vector<Ball> &balls, int i, int j,
                       double prd = 0.0)
{
  double volume = 0.0;
  for (const Ball &ball : balls)
    for (int image = prd > 0.0 ? -1 : 0; image <= (prd > 0.0 ? 1 : 0); image++) {
      const double x = ball.x[0] + image * prd, half = 0.5 * ball.side;
      volume += ball.side *
          shared(x - half, x + half, grid.lo[0] + i * grid.cell, grid.lo[0] + (i + 1) * grid.cell) *
          shared(ball.x[1] - half, ball.x[1] + half, grid.lo[1] + j * grid.cell,
                 grid.lo[1] + (j + 1) * grid.cell);
    }
  return volume;
}

TEST(PlanGrid, WholeCellsCoverTheExtent)
{
  const PlanGrid grid(EXTENT, 2.5);
  EXPECT_EQ(grid.n[0], 5);    // 12.3 / 2.5
  EXPECT_EQ(grid.n[1], 3);
  EXPECT_DOUBLE_EQ(grid.hi[0], 9.5);
  EXPECT_DOUBLE_EQ(grid.hi[1], 9.5);
  EXPECT_EQ(grid.cell_of(0, -3.0), 0);
  EXPECT_EQ(grid.cell_of(0, 9.5), 4);
  const double whole[4] = {0.0, 2.1, 0.0, 0.7};    // 2.1 / 0.7 is 3.0000000000000004
  EXPECT_EQ(PlanGrid(whole, 0.7).n[0], 3);
  EXPECT_EQ(PlanGrid(whole, 0.1).n[1], 7);
}

TEST(DepositBins, SquaresAreCutExactly)
{
  for (const double cell : {0.13, 1.0, 2.5, 20.0}) {
    const PlanGrid grid(EXTENT, cell);
    const auto balls = draw(200, 3.0);
    DepositBins bins;
    bins.set_grid(grid);
    const double beyond = bin_all(bins, balls);
    DepositWindow &window = bins.window();
    double on_grid = 0.0, released = 0.0;
    for (int j = 0; j < window.size[1]; j++)
      for (int i = 0; i < window.size[0]; i++) {
        const double wanted = expected(grid, balls, i + window.first[0], j + window.first[1]);
        ASSERT_NEAR(window.volume(i, j), wanted, 1e-12) << cell;
        on_grid += window.volume(i, j);
      }
    for (const Ball &ball : balls) released += std::pow(ball.side, 3);
    EXPECT_NEAR(on_grid + beyond, released, 1e-12 * released) << cell;
    EXPECT_GT(beyond, 0.05 * released);
  }
}

TEST(DepositBins, NothingIsBeyondInsideOfTheEdge)
{
  DepositBins bins;
  bins.set_grid(PlanGrid(EXTENT, 1.0));
  const Ball ball = {{-2.5, 2.5}, 1.0};    // touches two edges
  EXPECT_EQ(bin_all(bins, {ball}), 0.0);
  const Ball out = {{-20.0, 2.5}, 1.0};
  EXPECT_EQ(bin_all(bins, {out}), 1.0);
  EXPECT_EQ(bins.window().ncells(), 0u);
}

TEST(DepositBins, PeriodicSides)
{
  const PlanGrid grid(EXTENT, 0.41);
  const double prd = grid.hi[0] - grid.lo[0];
  DepositBins bins;
  bins.set_grid(grid);
  bins.set_period(0, true, grid.lo[0], grid.hi[0]);
  auto balls = draw(50, 0.0);
  balls.push_back({{grid.hi[0] + 0.1, 5.0}, 1.0});    // left the box a little
  bin_all(bins, balls);
  DepositWindow &window = bins.window();
  EXPECT_EQ(window.size[0], grid.n[0]);
  for (int j = 0; j < window.size[1]; j++)
    for (int i = 0; i < window.size[0]; i++)
      ASSERT_NEAR(window.volume(i, j), expected(grid, balls, i, j + window.first[1], prd), 1e-12);
}

TEST(DepositRasters, WindowsOfRanksAddUp)
{
  const PlanGrid grid(EXTENT, 0.7);
  const auto balls = draw(60, 0.0);
  DepositRasters rasters;
  rasters.create(grid);
  const std::vector<Ball> first(balls.begin(), balls.begin() + 20);
  const std::vector<Ball> second(balls.begin() + 20, balls.end());
  double released = 0.0, beyond = 0.0;
  for (const Ball &ball : balls) released += std::pow(ball.side, 3);
  for (int round = 0; round < 2; round++) {    // the second one begins at 0 again
    rasters.start();
    beyond = 0.0;
    for (const auto *part : {&first, &second}) {
      DepositBins bins;
      bins.set_grid(grid);
      beyond += bin_all(bins, *part);
      rasters.add(bins.window(), true, 0.5, 0.1);
    }
    EXPECT_NEAR(rasters.finish(true) + beyond, released, 1e-12 * released);
  }
  for (int j = 0; j < grid.n[1]; j++)
    for (int i = 0; i < grid.n[0]; i++)
      ASSERT_NEAR(rasters.thickness.at(i, j), expected(grid, balls, i, j) / 0.49, 1e-12);
}

// one ball over one cell of 1 m
static void sample(DepositRasters &rasters, const PlanGrid &grid, double x, double speed,
                   double energy, double time, bool record = true)
{
  DepositBins bins;
  bins.set_grid(grid);
  const double place[2] = {x, 4.5};
  bins.start();
  bins.show(place, 1.0);
  bins.open();
  bins.bin(place, 1.0, speed, energy);
  rasters.start();
  rasters.add(bins.window(), record, time, 0.1);
  rasters.finish(record);
}

TEST(DepositRasters, WhatCellsSaw)
{
  const PlanGrid grid(EXTENT, 1.0);
  DepositRasters rasters;
  rasters.create(grid);
  sample(rasters, grid, -2.5, 3.0, 70.0, 0.0);
  sample(rasters, grid, -2.5, 0.05, 90.0, 1.0);
  sample(rasters, grid, 1.5, 2.0, 10.0, 2.0);
  sample(rasters, grid, 5.5, 9.0, 99.0, 3.0, false);    // not to be recorded
  EXPECT_EQ(rasters.max_speed.at(0, 2), 3.0);
  EXPECT_EQ(rasters.max_energy.at(0, 2), 90.0);
  EXPECT_EQ(rasters.arrival.at(0, 2), 0.0);
  EXPECT_EQ(rasters.last_motion.at(0, 2), 0.0);    // 0.05 m/s is none
  EXPECT_EQ(rasters.arrival.at(4, 2), 2.0);
  EXPECT_EQ(rasters.max_thickness.at(4, 2), 1.0);
  EXPECT_EQ(rasters.thickness.at(4, 2), 0.0);
  EXPECT_EQ(rasters.thickness.at(8, 2), 1.0);
  EXPECT_EQ(rasters.max_thickness.at(8, 2), 0.0);
  EXPECT_TRUE(std::isnan(rasters.arrival.at(8, 2)));

  // the cells that were touched, and only they, in another one
  const auto saved = rasters.touched();
  ASSERT_EQ(saved.size(), 2u * DepositRasters::PER_CELL);
  DepositRasters other;
  other.create(grid);
  other.restore(saved.data());
  other.restore(saved.data() + DepositRasters::PER_CELL);
  EXPECT_EQ(other.max_speed.z, rasters.max_speed.z);
  EXPECT_EQ(other.max_energy.z, rasters.max_energy.z);
  EXPECT_EQ(other.max_thickness.z, rasters.max_thickness.z);
  EXPECT_EQ(other.touched().size(), saved.size());
}

TEST(DepositRasters, ChangePerTime)
{
  const PlanGrid grid(EXTENT, 1.0);
  DepositRasters rasters;
  rasters.create(grid);
  EXPECT_EQ(rasters.change, 1.0);
  sample(rasters, grid, 1.5, 1.0, 1.0, 0.0);
  rasters.take_snapshot(100, 50, 1.0, 4.0);
  EXPECT_EQ(rasters.change, 1.0);    // nothing to compare with
  sample(rasters, grid, 2.25, 1.0, 1.0, 0.0);    // three quarters of 1 m3 of 4 go on, in 0.5 s
  rasters.take_snapshot(150, 50, 1.5, 4.0);
  EXPECT_DOUBLE_EQ(rasters.change, 0.75 / 4.0 / 0.5);
  rasters.take_snapshot(230, 50, 2.5, 4.0);    // not a window later
  EXPECT_DOUBLE_EQ(rasters.change, 0.75 / 4.0 / 0.5);
  rasters.take_snapshot(280, 50, 3.0, 4.0);
  EXPECT_EQ(rasters.change, 0.0);
}

TEST(DepositRasters, FilesTogetherOrNotAtAll)
{
  char folder[] = "/tmp/test_deposit.XXXXXX";
  ASSERT_TRUE(mkdtemp(folder));
  const std::string prefix = std::string(folder) + "/out";
  const PlanGrid grid(EXTENT, 1.0);
  DepositRasters rasters;
  rasters.create(grid);
  for (double &z : rasters.base.z) z = 5.0;
  sample(rasters, grid, 1.5, 1.0, 1.0, 0.0);
  {
    FileSet files;
    rasters.write(files, prefix, "");
  }
  EXPECT_NE(access((prefix + ".base.asc").c_str(), F_OK), 0);
  FileSet files;
  rasters.write(files, prefix, "120");
  const std::vector<std::string> names = {
      "out.120.thickness.asc", "out.thickness.asc",     "out.surface.asc",
      "out.base.asc",          "out.max_thickness.asc", "out.max_speed.asc",
      "out.max_energy.asc",    "out.arrival.asc",       "out.last_motion.asc"};
  EXPECT_EQ(files.names(), names);
  files.commit();
  const ElevationGrid base = ElevationGrid::read(prefix + ".base.asc");
  const ElevationGrid surface = ElevationGrid::read(prefix + ".surface.asc");
  EXPECT_EQ(base.at(4, 2), 5.0);
  EXPECT_EQ(surface.at(4, 2), 6.0);
  for (const std::string &name : names) EXPECT_EQ(remove((folder + ("/" + name)).c_str()), 0);
  EXPECT_EQ(rmdir(folder), 0);    // nothing else
}

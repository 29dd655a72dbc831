/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// The squares of balls are cut exactly by the cells, on and off the grid and across periodic sides; only
// blocks of cells that a ball touches are there.

#include "deposit_bins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
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
  bins.clear();
  double beyond = 0.0;
  for (const Ball &ball : balls) beyond += bins.bin(ball.x, ball.side, 1.0, 1.0);
  return beyond;
}

// of a cell; 0 where no block is
static double volume_in(const DepositBins &bins, int i, int j)
{
  const auto *block = bins.blocks().find(BlockOfCells::of_cell(i), BlockOfCells::of_cell(j));
  return block ? block->values[DepositBins::VOLUME][BlockOfCells::index(i, j)] : 0.0;
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
    double on_grid = 0.0, released = 0.0;
    for (int j = 0; j < grid.n[1]; j++)
      for (int i = 0; i < grid.n[0]; i++) {
        ASSERT_NEAR(volume_in(bins, i, j), expected(grid, balls, i, j), 1e-12) << cell;
        on_grid += volume_in(bins, i, j);
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
  EXPECT_TRUE(bins.blocks().all().empty());
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
  for (int j = 0; j < grid.n[1]; j++)
    for (int i = 0; i < grid.n[0]; i++)
      ASSERT_NEAR(volume_in(bins, i, j), expected(grid, balls, i, j, prd), 1e-12);
}

// two small balls far apart: the blocks below them, not those between; and again after clear()
TEST(DepositBins, BlocksOnlyWhereBallsAre)
{
  const double extent[4] = {0.0, 1000.0, 0.0, 1000.0};
  DepositBins bins;
  bins.set_grid(PlanGrid(extent, 1.0));
  const std::vector<Ball> balls = {{{4.0, 4.0}, 0.5}, {{904.0, 500.0}, 0.5}, {{4.2, 4.0}, 0.5}};
  for (int round = 0; round < 2; round++) {
    EXPECT_EQ(bin_all(bins, balls), 0.0);
    const auto &blocks = bins.blocks().all();
    ASSERT_EQ(blocks.size(), 3u);    // the second one lies on the edge of two blocks
    EXPECT_EQ(blocks[0].column, 0);
    EXPECT_EQ(blocks[0].row, 0);
    double sum = 0.0;
    for (const auto &block : blocks)
      for (const double volume : block.values[DepositBins::VOLUME]) sum += volume;
    EXPECT_NEAR(sum, 3 * 0.125, 1e-15);    // not what was there before
    EXPECT_EQ(bins.blocks().find(50, 50), nullptr);
  }
  const double most = 4 * 1536 + 4 * 125 + 125 * 24 + 200 * 4;
  EXPECT_LT(bins.blocks().bytes(), 2 * most);
}

// the largest speed and energy of the centres over a cell; -1 where there is none
TEST(DepositBins, SpeedOfCentres)
{
  DepositBins bins;
  bins.set_grid(PlanGrid(EXTENT, 1.0));
  const double x[3][2] = {{-2.5, 2.5}, {-2.4, 2.6}, {-1.9, 2.5}};
  bins.clear();
  bins.bin(x[0], 1.0, 3.0, 5.0);
  bins.bin(x[1], 1.0, 2.0, 7.0);
  const double *speeds = bins.blocks().find(0, 0)->values[DepositBins::SPEED];
  const double *energies = bins.blocks().find(0, 0)->values[DepositBins::ENERGY];
  EXPECT_EQ(speeds[0], 3.0);
  EXPECT_EQ(energies[0], 7.0);
  EXPECT_EQ(speeds[1], -1.0);    // covered in part, no centre
  bins.bin(x[2], 1.0, 0.0, 0.0);
  EXPECT_EQ(speeds[1], 0.0);
}

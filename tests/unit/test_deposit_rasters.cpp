/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Bins of several ranks give the rasters that one rank would have; maxima, times and the change of the
// deposit; the cells in restart files; the files.

#include "deposit_bins.h"
#include "deposit_rasters.h"
#include "elevation_grid.h"
#include "atomic_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

using namespace Slope;

typedef DepositRasters Rasters;

static const double EXTENT[4] = {-3.0, 9.3, 2.0, 8.0};
static const Rasters::Name NAMES[] = {
    Rasters::THICKNESS, Rasters::MAX_THICKNESS, Rasters::MAX_SPEED, Rasters::MAX_ENERGY,
    Rasters::ARRIVAL,   Rasters::LAST_MOTION,   Rasters::SNAPSHOT};

// what a cell holds
static double at(const Rasters &rasters, Rasters::Name name, int i, int j)
{
  double row[256];    // more than the columns of any grid here
  rasters.row(name, j, row);
  return row[i];
}

struct Ball {
  double x[2], side, speed;
};

static std::vector<Ball> draw(int n)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(EXTENT[0], EXTENT[1]), y(EXTENT[2], EXTENT[3]),
      side(0.2, 2.5), speed(0.0, 0.3);
  std::vector<Ball> balls(n);
  for (Ball &ball : balls) ball = {{x(random), y(random)}, side(random), speed(random)};
  return balls;
}

// what ranks do without messages: each has some of the balls, one has the rasters
class Ranks {
 public:
  Ranks(const PlanGrid &grid, int number) : bins(number)
  {
    for (DepositBins &mine : bins) mine.set_grid(grid);
    rasters.create(grid);
  }

  // returns the volume on the grid
  double sample(const std::vector<Ball> &balls, double time, bool record = true)
  {
    for (DepositBins &mine : bins) mine.clear();
    for (size_t k = 0; k < balls.size(); k++)
      bins[k * bins.size() / balls.size()].bin(balls[k].x, balls[k].side, balls[k].speed,
                                               10.0 * balls[k].speed);
    rasters.clear();
    for (const DepositBins &from : bins)
      for (const auto &block : from.blocks().all()) rasters.add(block, record, time, 0.1);
    return rasters.finish(record);
  }

  std::vector<DepositBins> bins;
  Rasters rasters;
};

TEST(DepositRasters, OfRanksThoseOfOne)
{
  const PlanGrid grid(EXTENT, 0.1);
  const auto balls = draw(60);
  const std::vector<Ball> first(balls.begin(), balls.begin() + 40);
  Ranks one(grid, 1);
  double released = 0.0, on_grid = 0.0, moved = 0.0;
  for (const Ball &ball : first) released += std::pow(ball.side, 3);
  one.sample(balls, 0.5);
  one.rasters.take_snapshot(0.5, 0.0);
  on_grid = one.sample(first, 0.75);    // begins at 0 again
  moved = one.rasters.moved();
  EXPECT_GT(moved, 0.1 * released);

  // what is on the grid, by the overlap of the squares with all of it
  double expected = 0.0;
  for (const Ball &ball : first) {
    double part = ball.side;
    for (int dim = 0; dim < 2; dim++)
      part *= std::min(ball.x[dim] + 0.5 * ball.side, grid.hi[dim]) -
          std::max(ball.x[dim] - 0.5 * ball.side, grid.lo[dim]);
    expected += part;
  }
  EXPECT_NEAR(on_grid, expected, 1e-12 * released);

  for (const int number : {2, 3, 5}) {
    Ranks ranks(grid, number);
    ranks.sample(balls, 0.5);
    ranks.rasters.take_snapshot(0.5, 0.0);
    EXPECT_NEAR(ranks.sample(first, 0.75), on_grid, 1e-12 * released);
    EXPECT_NEAR(ranks.rasters.moved(), moved, 1e-12 * released);
    EXPECT_NEAR(ranks.rasters.largest(Rasters::MAX_THICKNESS),
                one.rasters.largest(Rasters::MAX_THICKNESS), 1e-12);
    for (const Rasters::Name name : NAMES)
      for (int j = 0; j < grid.n[1]; j++)
        for (int i = 0; i < grid.n[0]; i++) {
          const double a = at(one.rasters, name, i, j), b = at(ranks.rasters, name, i, j);
          ASSERT_EQ(std::isnan(a), std::isnan(b)) << name << " " << i << " " << j;
          if (!std::isnan(a)) ASSERT_NEAR(a, b, 1e-12) << name << " " << i << " " << j;
        }
  }
}

// one ball over one cell of 1 m
static void sample(Ranks &ranks, double x, double speed, double time, bool record = true)
{
  ranks.sample({{{x, 4.5}, 1.0, speed}}, time, record);
}

TEST(DepositRasters, WhatCellsSaw)
{
  const PlanGrid grid(EXTENT, 1.0);
  Ranks ranks(grid, 1);
  const Rasters &rasters = ranks.rasters;
  sample(ranks, -2.5, 3.0, 0.0);
  sample(ranks, -2.5, 0.05, 1.0);
  sample(ranks, 1.5, 2.0, 2.0);
  sample(ranks, 5.5, 9.0, 3.0, false);    // not to be recorded
  EXPECT_EQ(at(rasters, Rasters::MAX_SPEED, 0, 2), 3.0);
  EXPECT_EQ(at(rasters, Rasters::MAX_ENERGY, 0, 2), 30.0);
  EXPECT_EQ(at(rasters, Rasters::ARRIVAL, 0, 2), 0.0);
  EXPECT_EQ(at(rasters, Rasters::LAST_MOTION, 0, 2), 0.0);    // 0.05 m/s is none
  EXPECT_EQ(at(rasters, Rasters::ARRIVAL, 4, 2), 2.0);
  EXPECT_EQ(at(rasters, Rasters::MAX_THICKNESS, 4, 2), 1.0);
  EXPECT_EQ(at(rasters, Rasters::THICKNESS, 4, 2), 0.0);
  EXPECT_EQ(at(rasters, Rasters::THICKNESS, 8, 2), 1.0);
  EXPECT_EQ(at(rasters, Rasters::MAX_THICKNESS, 8, 2), 0.0);
  EXPECT_TRUE(std::isnan(at(rasters, Rasters::ARRIVAL, 8, 2)));
  EXPECT_EQ(at(rasters, Rasters::MAX_SPEED, 12, 5), 0.0);    // no block there
  EXPECT_TRUE(std::isnan(at(rasters, Rasters::LAST_MOTION, 12, 5)));
}

TEST(DepositRasters, ChangePerTime)
{
  Ranks ranks(PlanGrid(EXTENT, 1.0), 1);
  Rasters &rasters = ranks.rasters;
  auto take_snapshot = [&](double time) {    // of 4 m3 released
    rasters.take_snapshot(time, rasters.moved() / 4.0);
  };
  EXPECT_EQ(rasters.change, 1.0);
  sample(ranks, 1.5, 1.0, 0.0);
  take_snapshot(1.0);
  EXPECT_EQ(rasters.change, 1.0);    // nothing to compare with
  sample(ranks, 2.25, 1.0, 0.0);     // three quarters of 1 m3 of 4 go on, in 0.5 s
  take_snapshot(1.5);
  EXPECT_DOUBLE_EQ(rasters.change, 0.75 / 4.0 / 0.5);
  take_snapshot(3.0);
  EXPECT_EQ(rasters.change, 0.0);
}

static std::vector<double> all_touched(const Rasters &rasters, const PlanGrid &grid)
{
  std::vector<double> found;
  for (int j = 0; j < grid.n[1]; j++) {
    const auto cells = rasters.touched(j);
    found.insert(found.end(), cells.begin(), cells.end());
  }
  return found;
}

// the same cells, in the same order, from any number of ranks; and back
TEST(DepositRasters, TouchedCells)
{
  const PlanGrid grid(EXTENT, 0.1);
  std::vector<std::vector<double>> saved;
  for (const int number : {1, 2, 4}) {
    Ranks ranks(grid, number);
    ranks.sample(draw(20), 0.5);
    ranks.rasters.take_snapshot(0.5, 0.0);
    ranks.sample(draw(1), 1.0, false);
    saved.push_back(all_touched(ranks.rasters, grid));
  }
  const std::vector<double> &cells = saved[0];
  const size_t count = cells.size() / Rasters::PER_CELL;
  EXPECT_GT(count, 1000u);
  EXPECT_LT(count, grid.ncells());
  for (size_t k = 1; k < count; k++)
    EXPECT_LT(cells[(k - 1) * Rasters::PER_CELL], cells[k * Rasters::PER_CELL]);
  for (const auto &other : saved) {
    ASSERT_EQ(other.size(), cells.size());
    for (size_t k = 0; k < cells.size(); k++)
      ASSERT_TRUE(std::isnan(cells[k]) ? std::isnan(other[k])
                                       : std::fabs(cells[k] - other[k]) < 1e-12);
  }

  Rasters again;
  again.create(grid);
  for (size_t k = 0; k < cells.size(); k += Rasters::PER_CELL) again.restore(&cells[k]);
  const auto found = all_touched(again, grid);
  ASSERT_EQ(found.size(), cells.size());
  for (size_t k = 0; k < cells.size(); k++)
    ASSERT_TRUE(found[k] == cells[k] || (std::isnan(found[k]) && std::isnan(cells[k])));
}

static std::string text_of(const std::string &path)
{
  std::string text;
  FILE *fp = fopen(path.c_str(), "r");
  for (int c; (c = fgetc(fp)) != EOF;) text += (char) c;
  fclose(fp);
  return text;
}

// each is the file that an elevation grid with the values of all cells writes
TEST(DepositRasters, Files)
{
  const PlanGrid grid(EXTENT, 0.31);    // 40 x 20 cells: two rows of blocks and a half
  Ranks ranks(grid, 2);
  ranks.sample(draw(9), 0.5);
  const Rasters &rasters = ranks.rasters;
  std::vector<double> base;
  for (int j = 0; j < grid.n[1]; j++)
    for (int i = 0; i < grid.n[0]; i++) base.push_back(i == 7 ? NAN : 100.0 + 0.1 * i * j);
  ranks.rasters.set_base(base);

  char folder[] = "/tmp/test_deposit.XXXXXX";
  ASSERT_TRUE(mkdtemp(folder));
  const std::string path = std::string(folder) + "/one.asc", wanted = std::string(folder) + "/wanted.asc";
  const auto files = DepositRasters::files("out", "120");
  std::vector<std::string> names;
  for (const auto &file : files) names.push_back(file.path);
  EXPECT_EQ(
      names,
      std::vector<std::string>({"out.120.thickness.asc", "out.thickness.asc", "out.surface.asc",
                                "out.base.asc", "out.max_thickness.asc", "out.max_speed.asc",
                                "out.max_energy.asc", "out.arrival.asc", "out.last_motion.asc"}));
  for (const auto &file : files) {
    AtomicFile written(path);
    rasters.write(written, file);
    written.commit();

    ElevationGrid raster(grid.n[0], grid.n[1], grid.lo[0], grid.lo[1], grid.cell, 0.0);
    for (int j = 0; j < grid.n[1]; j++)
      for (int i = 0; i < grid.n[0]; i++) {
        const double z = base[j * grid.n[0] + i], h = at(rasters, Rasters::THICKNESS, i, j);
        raster.at(i, j) = file.content == DepositRasters::BASE ? z
            : file.content == DepositRasters::SURFACE          ? z + h
                                                     : at(rasters, (Rasters::Name) file.content, i, j);
      }
    AtomicFile wanted_file(wanted);
    raster.write(wanted_file, file.path.find(".thickness") < std::string::npos ? 12 : 9);
    wanted_file.commit();
    EXPECT_EQ(text_of(path), text_of(wanted)) << file.path;
  }
  EXPECT_EQ(remove(path.c_str()), 0);
  EXPECT_EQ(remove(wanted.c_str()), 0);
  EXPECT_EQ(rmdir(folder), 0);
}

TEST(FileSet, TogetherOrNotAtAll)
{
  char folder[] = "/tmp/test_deposit.XXXXXX";
  ASSERT_TRUE(mkdtemp(folder));
  const std::string a = std::string(folder) + "/a", b = std::string(folder) + "/b";
  {
    FileSet files;
    files.add(a).write("1\n");
    files.add(b).write("2\n");
    EXPECT_EQ(files.names(), std::vector<std::string>({"a", "b"}));
  }
  EXPECT_NE(access(a.c_str(), F_OK), 0);
  FileSet files;
  files.add(a).write("1\n");
  files.add(b).write("2\n");
  files.commit();
  EXPECT_EQ(remove(a.c_str()), 0);
  EXPECT_EQ(remove(b.c_str()), 0);
  EXPECT_EQ(rmdir(folder), 0);    // nothing else
}

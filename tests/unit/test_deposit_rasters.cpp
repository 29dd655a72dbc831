/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Rows in bands, shared out among ranks, hold together what one rank would hold; maxima, times and the
// change of the deposit; the cells in restart files, in pieces; the files.

#include "deposit_bins.h"
#include "deposit_rasters.h"
#include "deposit_writer.h"
#include "elevation_grid.h"
#include "file_set.h"

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

// what ranks do without messages: each has some of the balls and its rows
class Ranks {
 public:
  Ranks(const PlanGrid &grid, int number) : bins(number), rasters(number)
  {
    for (int me = 0; me < number; me++) {
      bins[me].set_grid(grid);
      rasters[me].create(grid, me, number);
    }
  }

  // returns the volume on the grid
  double sample(const std::vector<Ball> &balls, double time, bool record = true)
  {
    for (DepositBins &mine : bins) mine.clear();
    for (size_t k = 0; k < balls.size(); k++)
      bins[k * bins.size() / balls.size()].bin(balls[k].x, balls[k].side, balls[k].speed,
                                               10.0 * balls[k].speed);
    double sum = 0.0;
    for (Rasters &mine : rasters) {
      mine.clear();
      for (const DepositBins &from : bins)
        for (size_t k = 0; k < from.blocks().size(); k++)
          if (mine.bands().mine(from.blocks().band(k)))
            mine.add(from.blocks().column(k), from.blocks().band(k), from.blocks()[k], record, time,
                     0.1);
      sum += mine.finish(record);
    }
    return sum;
  }

  double at(Rasters::Name name, int i, int j) const
  {
    const int owner = rasters[0].bands().owner(DepositBands::band_of(j));
    EXPECT_TRUE(rasters[owner].bands().mine(DepositBands::band_of(j)));
    return rasters[owner].at(name, i, j);
  }

  std::vector<DepositBins> bins;
  std::vector<Rasters> rasters;
};

TEST(DepositBands, EveryRowHasOneOwner)
{
  for (const double cell : {0.05, 0.1, 0.7, 10.0}) {
    const PlanGrid grid(EXTENT, cell);
    for (const int number : {1, 2, 3, 7, 200}) {
      std::vector<int> rows(grid.n[1], 0);
      size_t most = 0, least = (size_t) -1, all = 0;
      for (int me = 0; me < number; me++) {
        const DepositBands bands(grid, me, number);
        size_t mine = 0;
        for (int band = bands.first(); band < bands.number(); band += bands.step())
          for (int j = bands.first_row(band); j < bands.end_row(band); j++) {
            EXPECT_EQ(bands.owner(band), me);
            EXPECT_EQ(bands.band_of(j), band);
            rows[j]++;
            for (int i = 0; i < grid.n[0]; i++, mine++) ASSERT_EQ(bands.place(i, j), mine);
          }
        EXPECT_EQ(bands.ncells(), mine);
        most = std::max(most, mine);
        least = std::min(least, mine);
        all += mine;
      }
      for (const int count : rows) EXPECT_EQ(count, 1);
      EXPECT_EQ((double) all, grid.ncells());
      EXPECT_LE(most - least, (size_t) DepositBands::ROWS * grid.n[0]);    // a band
    }
  }
}

TEST(DepositRasters, RanksHoldWhatOneHolds)
{
  const PlanGrid grid(EXTENT, 0.1);
  const auto balls = draw(60);
  const std::vector<Ball> first(balls.begin(), balls.begin() + 40);
  Ranks one(grid, 1);
  double released = 0.0, on_grid = 0.0, moved = 0.0;
  for (const Ball &ball : first) released += std::pow(ball.side, 3);
  one.sample(balls, 0.5);
  one.rasters[0].take_snapshot(0.5, 0.0);
  on_grid = one.sample(first, 0.75);    // begins at 0 again
  moved = one.rasters[0].moved();
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
    for (Rasters &mine : ranks.rasters) mine.take_snapshot(0.5, 0.0);
    EXPECT_NEAR(ranks.sample(first, 0.75), on_grid, 1e-12 * released);
    double sum = 0.0, largest = 0.0;
    for (Rasters &mine : ranks.rasters) {
      sum += mine.moved();
      largest = std::max(largest, mine.largest(Rasters::MAX_THICKNESS));
    }
    EXPECT_NEAR(sum, moved, 1e-12 * released);
    EXPECT_NEAR(largest, one.rasters[0].largest(Rasters::MAX_THICKNESS), 1e-12);
    for (const Rasters::Name name : NAMES)
      for (int j = 0; j < grid.n[1]; j++)
        for (int i = 0; i < grid.n[0]; i++) {
          const double a = one.at(name, i, j), b = ranks.at(name, i, j);
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
  const Rasters &rasters = ranks.rasters[0];
  sample(ranks, -2.5, 3.0, 0.0);
  sample(ranks, -2.5, 0.05, 1.0);
  sample(ranks, 1.5, 2.0, 2.0);
  sample(ranks, 5.5, 9.0, 3.0, false);    // not to be recorded
  EXPECT_EQ(rasters.at(Rasters::MAX_SPEED, 0, 2), 3.0);
  EXPECT_EQ(rasters.at(Rasters::MAX_ENERGY, 0, 2), 30.0);
  EXPECT_EQ(rasters.at(Rasters::ARRIVAL, 0, 2), 0.0);
  EXPECT_EQ(rasters.at(Rasters::LAST_MOTION, 0, 2), 0.0);    // 0.05 m/s is none
  EXPECT_EQ(rasters.at(Rasters::ARRIVAL, 4, 2), 2.0);
  EXPECT_EQ(rasters.at(Rasters::MAX_THICKNESS, 4, 2), 1.0);
  EXPECT_EQ(rasters.at(Rasters::THICKNESS, 4, 2), 0.0);
  EXPECT_EQ(rasters.at(Rasters::THICKNESS, 8, 2), 1.0);
  EXPECT_EQ(rasters.at(Rasters::MAX_THICKNESS, 8, 2), 0.0);
  EXPECT_TRUE(std::isnan(rasters.at(Rasters::ARRIVAL, 8, 2)));
  EXPECT_EQ(rasters.at(Rasters::MAX_SPEED, 12, 5), 0.0);    // no block there
  EXPECT_TRUE(std::isnan(rasters.at(Rasters::LAST_MOTION, 12, 5)));
}

TEST(DepositRasters, ChangePerTime)
{
  Ranks ranks(PlanGrid(EXTENT, 1.0), 1);
  Rasters &rasters = ranks.rasters[0];
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

// the same cells, in the same order, from any number of ranks; into any other number of them
TEST(DepositRasters, TouchedCells)
{
  const PlanGrid grid(EXTENT, 0.1);
  std::vector<std::vector<double>> saved;
  for (const int number : {1, 2, 4}) {
    Ranks ranks(grid, number);
    ranks.sample(draw(20), 0.5);
    for (Rasters &mine : ranks.rasters) mine.take_snapshot(0.5, 0.0);
    ranks.sample(draw(1), 1.0, false);
    saved.emplace_back();
    for (int band = 0; band < ranks.rasters[0].bands().number(); band++) {
      const auto cells = ranks.rasters[ranks.rasters[0].bands().owner(band)].touched(band);
      saved.back().insert(saved.back().end(), cells.begin(), cells.end());
    }
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

  Ranks again(grid, 3);
  for (Rasters &mine : again.rasters)
    for (size_t k = 0; k < cells.size(); k += Rasters::PER_CELL) mine.restore(&cells[k]);
  size_t next = 0;
  for (int band = 0; band < again.rasters[0].bands().number(); band++)
    for (const double value : again.rasters[band % 3].touched(band)) {
      ASSERT_TRUE(value == cells[next] || std::isnan(cells[next]));
      next++;
    }
  EXPECT_EQ(next, cells.size());
  for (int band = 0; band < again.rasters[0].bands().number(); band++)
    EXPECT_TRUE(again.rasters[(band + 1) % 3].touched(band).empty());    // not in others' rows
}

// bands put together are the file that one raster would write
TEST(DepositWriter, TextOfBands)
{
  const PlanGrid grid(EXTENT, 0.31);    // 40 x 20 cells: two bands and a half
  Ranks ranks(grid, 2);
  ranks.sample(draw(9), 0.5);
  for (Rasters &mine : ranks.rasters)
    for (int band = mine.bands().first(); band < 3; band += 2)
      for (int j = mine.bands().first_row(band); j < mine.bands().end_row(band); j++)
        for (int i = 0; i < grid.n[0]; i++) mine.base(i, j) = i == 7 ? NAN : 100.0 + 0.1 * i * j;

  char folder[] = "/tmp/test_deposit.XXXXXX";
  ASSERT_TRUE(mkdtemp(folder));
  const std::string path = std::string(folder) + "/one.asc";
  const auto files = DepositWriter::files("out", "120");
  std::vector<std::string> names;
  for (const auto &file : files) names.push_back(file.path);
  EXPECT_EQ(
      names,
      std::vector<std::string>({"out.120.thickness.asc", "out.thickness.asc", "out.surface.asc",
                                "out.base.asc", "out.max_thickness.asc", "out.max_speed.asc",
                                "out.max_energy.asc", "out.arrival.asc", "out.last_motion.asc"}));
  for (const auto &file : files) {
    std::string text = DepositWriter::header(grid);
    for (int band = 2; band >= 0; band--)
      text += DepositWriter::text_of_band(ranks.rasters[band % 2], file, band);

    ElevationGrid raster(grid.n[0], grid.n[1], grid.lo[0], grid.lo[1], grid.cell, 0.0);
    for (int j = 0; j < grid.n[1]; j++)
      for (int i = 0; i < grid.n[0]; i++) {
        const double base = ranks.rasters[j / 8 % 2].base(i, j);
        const double h = ranks.at(Rasters::THICKNESS, i, j);
        raster.at(i, j) = file.content == DepositWriter::BASE ? base
            : file.content == DepositWriter::SURFACE          ? base + h
                                                     : ranks.at((Rasters::Name) file.content, i, j);
      }
    raster.write(path, file.path.find(".thickness") < std::string::npos ? 12 : 9);
    std::string wanted;
    FILE *fp = fopen(path.c_str(), "r");
    for (int c; (c = fgetc(fp)) != EOF;) wanted += (char) c;
    fclose(fp);
    EXPECT_EQ(text, wanted) << file.path;
  }
  EXPECT_EQ(remove(path.c_str()), 0);
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

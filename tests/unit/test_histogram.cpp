/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Quantiles of weighted values: those of the sorted values to one bin, never too small, and the same
// when several ranks add up.

#include "histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

using Slope::Histogram;

typedef std::vector<std::pair<double, double>> Values;    // value, weight

// the smallest value that the share lies at or below
static double exact(Values values, double share)
{
  std::sort(values.begin(), values.end());
  double total = 0.0, below = 0.0;
  for (const auto &one : values) total += one.second;
  for (const auto &one : values)
    if ((below += one.second) >= share * total * (1 - 1e-12)) return one.first;
  return values.back().first;
}

static Values draw(int n)
{
  std::mt19937 random(7);
  std::gamma_distribution<double> value(2.0, 30.0);
  std::uniform_real_distribution<double> weight(0.1, 4.0);
  Values values(n);
  for (auto &one : values) one = {value(random), weight(random)};
  return values;
}

TEST(Histogram, ABinIsAtMostAThousandthOfTheRange)
{
  EXPECT_LE(Histogram(3.0, 5.0).bin(), 2.0e-3);
  EXPECT_DOUBLE_EQ(Histogram(3.0, 5.0).bin() * Histogram::BINS, 2.0);
}

TEST(Histogram, QuantilesToOneBin)
{
  const Values values = draw(20000);
  const double most = std::max_element(values.begin(), values.end())->first;
  Histogram histogram(0.0, most);
  for (const auto &one : values) histogram.add(one.first, one.second);
  for (const double share : {0.01, 0.25, 0.5, 0.9, 0.95, 0.99, 1.0}) {
    const double wanted = exact(values, share), found = histogram.quantile(share);
    EXPECT_GE(found, wanted) << share;
    EXPECT_LE(found, wanted + histogram.bin() * (1 + 1e-9)) << share;
  }
  EXPECT_EQ(histogram.quantile(1.0), most);
}

// one of them, far away, takes only itself along
TEST(Histogram, AStrayValueMovesNoQuantile)
{
  Values values = draw(20000);
  Histogram before(0.0, 1000.0), after(0.0, 1000.0);
  for (const auto &one : values) before.add(one.first, one.second);
  values.push_back({1000.0, 1.0});
  for (const auto &one : values) after.add(one.first, one.second);
  for (const double share : {0.5, 0.9, 0.95, 0.99})
    EXPECT_NEAR(after.quantile(share), before.quantile(share), before.bin() * (1 + 1e-9));
  EXPECT_EQ(after.quantile(1.0), 1000.0);
}

TEST(Histogram, RanksAddUp)
{
  const Values values = draw(3000);
  Histogram one(0.0, 500.0), two(0.0, 500.0), all(0.0, 500.0);
  for (size_t k = 0; k < values.size(); k++) {
    (k % 3 ? one : two).add(values[k].first, values[k].second);
    all.add(values[k].first, values[k].second);
  }
  for (int k = 0; k < Histogram::BINS; k++) one.weights[k] += two.weights[k];
  for (const double share : {0.5, 0.9, 0.99}) EXPECT_EQ(one.quantile(share), all.quantile(share));
}

// nine of ten equal weights are 0.9, however the sums are rounded
TEST(Histogram, Ties)
{
  for (int n = 1; n < 2000; n++) {
    Histogram histogram(0.0, 8.192);
    for (int k = 0; k < 10; k++) histogram.add(0.0005 + 0.5 * k, 0.001 * n);
    ASSERT_NEAR(histogram.quantile(0.9), 4.001, 1e-9) << n;
    ASSERT_NEAR(histogram.quantile(0.9001), 4.501, 1e-9) << n;
  }
}

TEST(Histogram, Edges)
{
  Histogram none(2.0, 3.0);
  EXPECT_EQ(none.quantile(0.99), 2.0);
  Histogram same(4.0, 4.0);
  same.add(4.0, 1.5);
  EXPECT_EQ(same.quantile(0.5), 4.0);
  Histogram beyond(0.0, 1.0);
  beyond.add(-5.0, 1.0);
  beyond.add(7.0, 1.0);
  EXPECT_DOUBLE_EQ(beyond.quantile(0.5), beyond.bin());
  EXPECT_EQ(beyond.quantile(0.6), 1.0);
}

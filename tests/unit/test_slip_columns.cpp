/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Columns of a surface below a raster: volumes against closed forms, one connected body, what its
   rim meets, layers and water of a column. */

#include "embankment.h"
#include "slip_columns.h"

#include <gtest/gtest.h>

#include <limits>

using namespace Slope;
using namespace embankment;

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();
const SlipSoil SOIL({1000.0, 0.5, 2000.0});

double cap_volume(double radius, double height)
{
  return PI * height * height * (3.0 * radius - height) / 3.0;
}

class Columns : public testing::Test {
 protected:
  ElevationGrid ground = plane(60, 1.0, 0.0);
  std::vector<char> allowed;
  SlipColumns exact, coarse;

  void cut(const SlipSurface &s)
  {
    SlipColumnMaker maker(ground, SOIL, allowed);
    ASSERT_TRUE(maker.exact(s, exact));
    ASSERT_TRUE(maker.coarse(s, 1, coarse));
  }
};

}    // namespace

TEST_F(Columns, CapsBelowPlanes)
{
  for (const double dip : {0.0, 0.4})
    for (const double height : {0.5, 3.0, 6.0}) {
      ground = plane(60, 1.0, dip);
      const double radius = 12.0;
      cut(cap(radius, std::acos(1.0 - height / radius), dip));
      EXPECT_NEAR(exact.volume / cap_volume(radius, height), 1.0, 2e-4) << dip << " " << height;
      EXPECT_NEAR(coarse.volume / cap_volume(radius, height), 1.0, 3e-2) << dip << " " << height;
      EXPECT_NEAR(exact.greatest_depth, coarse.greatest_depth, 0.05 * height);
      const double rim = radius * radius - std::pow(radius - height, 2);
      EXPECT_NEAR(exact.plan_area / (PI * rim * std::cos(dip)), 1.0, 2e-3);
      EXPECT_FALSE(exact.at_edge || exact.overhang || exact.outside);
      EXPECT_FALSE(coarse.at_edge || coarse.overhang || coarse.outside);
    }
}

TEST_F(Columns, EllipsoidAndStraightPart)
{
  for (const double direction : {0.0, 0.7}) {
    SlipSurface s(0.0, 0.0, 4.0, 8.0, direction);
    s.along = 1.3;
    s.across = 0.7;
    cut(s);
    EXPECT_NEAR(exact.volume / (1.3 * 0.7 * cap_volume(8.0, 4.0)), 1.0, 2e-4);
    s.along = s.across = 1.0;
    s.straight = 20.0;
    cut(s);
    const double segment = 64.0 * PI / 3.0 - 4.0 * std::sqrt(48.0);
    EXPECT_NEAR(exact.volume / (cap_volume(8.0, 4.0) + 20.0 * segment), 1.0, 2e-4);
  }
}

// a cap less the smaller one below the bedrock
TEST_F(Columns, CapsCutByBedrock)
{
  for (const double dip : {0.0, 0.4})
    for (const double height : {2.5, 3.0, 6.0}) {
      ground = plane(60, 1.0, dip);
      ElevationGrid rock = ground;
      for (double &z : rock.z) z -= 2.0 / std::cos(dip);
      SlipSoil soil({1000.0, 0.5, 2000.0});
      soil.set_bedrock(rock);
      const double radius = 12.0, expected = cap_volume(radius, height) - cap_volume(radius, height - 2.0);
      const SlipSurface surface = cap(radius, std::acos(1.0 - height / radius), dip);
      SlipColumnMaker maker(ground, soil, allowed);
      ASSERT_TRUE(maker.exact(surface, exact));
      ASSERT_TRUE(maker.coarse(surface, 1, coarse));
      EXPECT_NEAR(exact.volume / expected, 1.0, 2e-4) << dip << " " << height;
      EXPECT_NEAR(coarse.volume / expected, 1.0, 3e-2) << dip << " " << height;
      EXPECT_NEAR(exact.greatest_depth, 2.0 / std::cos(dip), 1e-9);
    }
}

// the bedrock rises through the ground, and beyond there is none
TEST_F(Columns, BedrockThatCropsOut)
{
  ElevationGrid rock = ground;
  for (int j = 0; j < rock.ny; j++)
    for (int i = 0; i < rock.nx; i++) {
      const double x = rock.xlo + i + 0.5;
      rock.at(i, j) = x < -5.0 ? NaN : 0.3 * (x - 1.2);
    }
  SlipSoil soil({1000.0, 0.5, 2000.0});
  soil.set_bedrock(rock);
  const SlipSurface s(0.0, 0.0, 9.0, 12.0);
  double expected = 0.0;
  const double step = 0.005, width = 5.0 + 0.5;    // the first cell with bedrock has its centre at -4.5
  for (double x = -8.0 + 0.5 * step; x < 1.2; x += step)
    for (double y = -8.0 + 0.5 * step; y < 8.0; y += step) {
      const double square = 144.0 - x * x - y * y, base = square > 0.0 ? 9.0 - std::sqrt(square) : 0.0;
      const double top = x < -width + 1.0 ? -HUGE_VAL : 0.3 * (x - 1.2);
      expected += std::max(0.0, -std::max(base, top)) * step * step;
    }
  SlipColumnMaker maker(ground, soil, allowed);
  ASSERT_TRUE(maker.exact(s, exact));
  EXPECT_NEAR(exact.volume / expected, 1.0, 1e-3);
  EXPECT_NEAR(*std::max_element(exact.dx.begin(), exact.dx.end()), 1.2, 0.1);
  EXPECT_FALSE(exact.at_edge || exact.overhang || exact.outside);
  ASSERT_EQ(exact.slope_x.size(), exact.size());
  for (size_t k = 0; k < exact.size(); k++)
    if (!std::isnan(exact.slope_x[k])) EXPECT_NEAR(exact.slope_x[k], 0.3, 1e-12);
}

// no cell's middle is below it, and still it has its volume
TEST_F(Columns, SmallerThanACell)
{
  const SlipSurface s(0.0, 0.0, 0.9, 1.0);
  SlipColumnMaker maker(ground, SOIL, allowed);
  ASSERT_TRUE(maker.exact(s, exact));
  EXPECT_NEAR(exact.volume / cap_volume(1.0, 0.1), 1.0, 1e-3);
  EXPECT_FALSE(maker.coarse(s, 1, coarse));
}

TEST_F(Columns, NothingAboveTheGround)
{
  SlipColumnMaker maker(ground, SOIL, allowed);
  EXPECT_FALSE(maker.exact({0.0, 0.0, 5.0, 4.0}, exact));
  EXPECT_FALSE(maker.coarse({0.0, 0.0, 5.0, 4.0}, 1, coarse));
  EXPECT_FALSE(maker.exact({500.0, 0.0, 5.0, 40.0}, exact));
}

// two hills in one bowl: the larger one is the body
TEST_F(Columns, LargestConnectedPart)
{
  const auto hill = [](double x, double y, double height) {
    return height * std::exp(-(x * x + y * y) / 20.0);
  };
  for (int j = 0; j < ground.ny; j++)
    for (int i = 0; i < ground.nx; i++) {
      const double x = ground.xlo + i + 0.5, y = ground.ylo + j + 0.5;
      ground.at(i, j) = hill(x - 8.0, y - 8.0, 4.0) + hill(x + 8.0, y + 8.0, 3.0);
    }
  cut({0.0, 0.0, 202.5, 202.0});
  for (const SlipColumns *c : {&exact, &coarse}) {
    EXPECT_GT(*std::min_element(c->dx.begin(), c->dx.end()), 2.0);
    EXPECT_GT(*std::min_element(c->dy.begin(), c->dy.end()), 2.0);
    double volume = 0.0;
    for (size_t i = 0; i < c->size(); i++) volume += c->thick[i] * c->area[i];
    EXPECT_NEAR(volume, c->volume, 1e-9 * volume);
  }
}

TEST_F(Columns, EdgesOfTheTerrain)
{
  for (const SlipSurface &s : {SlipSurface(28.0, 0.0, 3.0, 5.0), SlipSurface(-28.0, 0.0, 3.0, 5.0),
                               SlipSurface(0.0, 28.0, 3.0, 5.0), SlipSurface(0.0, -28.0, 3.0, 5.0)}) {
    cut(s);
    EXPECT_TRUE(exact.at_edge);
    EXPECT_TRUE(coarse.at_edge);
  }
  ground.at(31, 30) = NaN;
  cut({0.0, 0.0, 3.0, 5.0});
  EXPECT_TRUE(exact.at_edge);
  EXPECT_TRUE(coarse.at_edge);
  cut({12.0, 0.0, 3.0, 5.0});
  EXPECT_FALSE(exact.at_edge);
  EXPECT_FALSE(coarse.at_edge);
}

// where the ground at the rim is higher than the centre the lower half would end in a wall
TEST_F(Columns, Overhang)
{
  cut({0.0, 0.0, -0.5, 5.0});
  EXPECT_TRUE(exact.overhang);
  EXPECT_TRUE(coarse.overhang);
}

TEST_F(Columns, OnlyInAllowedCells)
{
  allowed.assign(ground.nx * ground.ny, 1);
  cut({0.0, 0.0, 3.0, 5.0});
  EXPECT_FALSE(exact.outside || coarse.outside);
  allowed[30 * ground.nx + 33] = 0;
  cut({0.0, 0.0, 3.0, 5.0});
  EXPECT_TRUE(exact.outside && coarse.outside);
}

TEST(SlipSoil, LayersAndWater)
{
  const double g = Slope::GRAVITY;
  const ElevationGrid ground(10, 10, -5.0, -5.0, 1.0, 0.0), second(10, 10, -5.0, -5.0, 1.0, -2.0),
      third(10, 10, -5.0, -5.0, 1.0, -5.0), water(10, 10, -5.0, -5.0, 1.0, -1.0);
  SlipSoil soil({1000.0, 0.1, 1000.0});
  soil.add_layer(second, {2000.0, 0.2, 2000.0});
  soil.add_layer(third, {3000.0, 0.3, 3000.0});
  soil.set_table(water);
  EXPECT_EQ(soil.contradiction(ground), "");

  SlipSoil::State s = soil.state(0.0, 0.0, -1.5, 0.0);
  EXPECT_DOUBLE_EQ(s.weight, g * 1500.0);
  EXPECT_DOUBLE_EQ(s.height, -0.75);
  EXPECT_DOUBLE_EQ(s.cohesion, 1000.0);
  EXPECT_DOUBLE_EQ(s.pore, g * 500.0);
  s = soil.state(0.0, 0.0, -6.0, 0.0);
  EXPECT_DOUBLE_EQ(s.weight, g * (2000.0 + 6000.0 + 3000.0));
  EXPECT_NEAR(s.height, -(2000.0 * 1.0 + 6000.0 * 3.5 + 3000.0 * 5.5) / 11000.0, 1e-12);
  EXPECT_DOUBLE_EQ(s.cohesion, 3000.0);
  EXPECT_DOUBLE_EQ(s.friction, 0.3);
  EXPECT_DOUBLE_EQ(s.pore, g * 5000.0);
  EXPECT_DOUBLE_EQ(soil.state(0.0, 0.0, -0.5, 0.0).pore, 0.0);
}

TEST(SlipSoil, Contradictions)
{
  const ElevationGrid ground(10, 10, -5.0, -5.0, 1.0, 0.0), high(10, 10, -5.0, -5.0, 1.0, 0.5);
  ElevationGrid low(10, 10, -5.0, -5.0, 1.0, -3.0);
  SlipSoil wet({0.0, 0.5, 2000.0}), crossed({0.0, 0.5, 2000.0});
  wet.set_table(high);
  EXPECT_NE(wet.contradiction(ground).find("water table"), std::string::npos);
  EXPECT_NE(wet.contradiction(ground).find("got 0.5 above 0"), std::string::npos);
  crossed.add_layer(low, {0.0, 0.5, 2000.0});
  low.at(3, 4) = -2.0;
  crossed.add_layer(low, {0.0, 0.5, 2000.0});
  EXPECT_NE(crossed.contradiction(ground).find("layer 2"), std::string::npos);
  EXPECT_NE(crossed.contradiction(ground).find("got -2 above -3 at -1.5 -0.5"), std::string::npos);
}

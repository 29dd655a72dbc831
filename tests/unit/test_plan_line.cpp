// Crossings of a polyline: places, directions, corners, ends, paths in pieces; files that are wrong

#include "plan_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <stdexcept>

using Slope::PlanLine;

namespace {

typedef std::vector<PlanLine::Crossing> Crossings;

Crossings cross(const PlanLine &line, double ax, double ay, double bx, double by)
{
  const double a[2] = {ax, ay}, b[2] = {bx, by};
  Crossings found;
  line.cross(a, b, found);
  return found;
}

int net(const Crossings &found)
{
  int sum = 0;
  for (const auto &c : found) sum += c.direction;
  return sum;
}

const PlanLine north({2.0, 0.0, 2.0, 4.0});               // its left-hand side is the west
const PlanLine hook({0.0, 0.0, 4.0, 0.0, 4.0, 4.0});      // east, then north: a corner at 4,0

class LineFile : public ::testing::Test {
 protected:
  std::string path;
  void SetUp() override
  {
    path = std::string("line_") +
        ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  }
  void TearDown() override { std::remove(path.c_str()); }

  PlanLine read(const std::string &text)
  {
    std::ofstream(path, std::ios::binary) << text;
    return PlanLine::read(path);
  }

  std::string problem(const std::string &text)
  {
    try {
      read(text);
    } catch (std::runtime_error &e) {
      return e.what();
    }
    return "read";
  }
};

}    // namespace

TEST(PlanLine, ForwardIsFromLeftToRight)
{
  const Crossings there = cross(north, 1.0, 1.0, 5.0, 3.0);
  ASSERT_EQ(there.size(), 1u);
  EXPECT_EQ(there[0].direction, 1);
  EXPECT_DOUBLE_EQ(there[0].passed, 0.25);
  EXPECT_DOUBLE_EQ(there[0].along, 1.5);
  EXPECT_DOUBLE_EQ(there[0].x, 2.0);
  EXPECT_DOUBLE_EQ(there[0].y, 1.5);
  const Crossings back = cross(north, 5.0, 3.0, 1.0, 1.0);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].direction, -1);
  EXPECT_DOUBLE_EQ(back[0].passed, 0.75);
  EXPECT_DOUBLE_EQ(back[0].along, 1.5);
}

TEST(PlanLine, BesideTheLineNothingCrosses)
{
  EXPECT_TRUE(cross(north, 1.0, 4.5, 3.0, 4.5).empty());    // past the end
  EXPECT_TRUE(cross(north, 1.0, 1.0, 1.9, 3.0).empty());    // on one side
  EXPECT_TRUE(cross(north, 1.0, 3.0, 2.4, 5.0).empty());    // in the bounding box's corner
  EXPECT_TRUE(cross(north, 2.0, 1.0, 2.0, 1.0).empty());    // at rest on it
  EXPECT_TRUE(cross(north, 2.0, 1.0, 2.0, 3.0).empty());    // along it
}

// a step that ends on the line: the ball is to the east of it; the next step brings it further, or back

TEST(PlanLine, ChecksumTellsLinesAndTheirDirectionsApart)
{
  const PlanLine line({0.0, 0.0, 5.0, -5.0, 10.0, -10.0});
  EXPECT_EQ(line.checksum(), PlanLine({0.0, 0.0, 5.0, -5.0, 10.0, -10.0}).checksum());
  EXPECT_NE(line.checksum(), PlanLine({10.0, -10.0, 5.0, -5.0, 0.0, 0.0}).checksum());
  EXPECT_NE(line.checksum(), PlanLine({0.0, 0.0, 4.0, -4.0, 10.0, -10.0}).checksum());
}

TEST(PlanLine, APathInPiecesCrossesAsOften)
{
  EXPECT_EQ(net(cross(north, 1.0, 1.0, 2.0, 1.0)), 1);
  EXPECT_TRUE(cross(north, 2.0, 1.0, 3.0, 1.0).empty());
  EXPECT_EQ(net(cross(north, 2.0, 1.0, 1.0, 1.0)), -1);
  EXPECT_TRUE(cross(north, 3.0, 1.0, 2.0, 1.0).empty());
}

TEST(PlanLine, ACornerCountsOnce)
{
  for (double dx : {-1.0, -0.3, 0.3, 1.0})
    for (double dy : {-2.0, -1.0}) {
      const Crossings over = cross(hook, 4.0 - dx - 2.0, -dy, 4.0 + dx + 2.0, dy);
      EXPECT_EQ(net(over), 1) << dx << " " << dy;
      EXPECT_EQ(over.size(), 1u);
      EXPECT_NEAR(over[0].along, 4.0, 1e-12);
    }
  EXPECT_EQ(net(cross(hook, 3.0, -1.0, 5.0, 1.0)), 0);    // touches it from outside
}

TEST(PlanLine, TwoPiecesInOneStep)
{
  const Crossings found = cross(hook, 1.0, -1.0, 5.0, 3.0);    // in through the south, out through the east
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].direction, -1);
  EXPECT_EQ(found[1].direction, 1);
  EXPECT_LT(found[0].passed, found[1].passed);
  EXPECT_DOUBLE_EQ(found[0].along, 2.0);
  EXPECT_DOUBLE_EQ(found[1].along, 6.0);
  EXPECT_DOUBLE_EQ(hook.length(), 8.0);
}

// random walks on a grid, through corners and along pieces: the sum is the side where the walk ends

TEST(PlanLine, WalksAroundAClosedLineAddUp)
{
  const PlanLine ring({0.0, 0.0, 0.0, 4.0, 4.0, 4.0, 6.0, 2.0, 4.0, 0.0, 0.0, 0.0});    // clockwise: inside is on the right
  std::mt19937 random(7);
  std::uniform_int_distribution<int> place(-2, 8);
  const auto inside = [](double x, double y) { return x > 0 && y > 0 && y < 4 && x + std::fabs(y - 2) < 6; };
  int crossed = 0;
  for (int walk = 0; walk < 300; walk++) {
    double x = -1.5, y = -1.25;
    int sum = 0;
    for (int step = 0; step < 50; step++) {
      const double nx = step == 49 ? 2.5 : place(random), ny = step == 49 ? 1.75 : place(random);
      const Crossings found = cross(ring, x, y, nx, ny);
      sum += net(found);
      crossed += (int) found.size();
      x = nx;
      y = ny;
    }
    EXPECT_TRUE(inside(x, y));
    EXPECT_EQ(sum, 1) << walk;
  }
  EXPECT_GT(crossed, 1000);
}

// against the smallest distance of all pieces

TEST(PlanLine, NearIsWithinReachOfAnyPiece)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> anywhere(-10.0, 10.0), bend(-1.5, 1.5);
  int near = 0, far = 0;
  for (int points : {2, 3, 4, 7, 50}) {
    std::vector<double> xy = {anywhere(random), anywhere(random)};
    while (xy.size() < 2 * (size_t) points)
      for (int c = 0; c < 2; c++) xy.push_back(xy[xy.size() - 2] + bend(random));
    const PlanLine line(xy);
    for (int k = 0; k < 500; k++) {
      const double place[2] = {anywhere(random), anywhere(random)};
      double least = HUGE_VAL;
      for (size_t i = 0; i + 2 < xy.size(); i += 2)
        for (int cut = 0; cut <= 1000; cut++)
          least = std::min(least,
                           std::hypot(xy[i] + 0.001 * cut * (xy[i + 2] - xy[i]) - place[0],
                                      xy[i + 1] + 0.001 * cut * (xy[i + 3] - xy[i + 1]) - place[1]));
      EXPECT_TRUE(line.is_near(place, least + 1e-9));
      EXPECT_FALSE(line.is_near(place, 0.999 * least - 1e-4));
      (least < 2.0 ? near : far)++;
    }
  }
  EXPECT_GT(near, 100);
  EXPECT_GT(far, 100);
}

TEST(PlanLine, NearAtItsEndsAndOfAPieceWithoutLength)
{
  const double end[2] = {2.0, 5.0}, beside[2] = {3.0, 2.0}, corner[2] = {5.0, -1.0};
  EXPECT_TRUE(north.is_near(end, 1.0));
  EXPECT_FALSE(north.is_near(end, 0.999));
  EXPECT_TRUE(north.is_near(beside, 1.0));
  EXPECT_FALSE(north.is_near(beside, 0.999));
  EXPECT_TRUE(hook.is_near(corner, std::sqrt(2.0) + 1e-12));
  EXPECT_FALSE(hook.is_near(corner, 1.41));
  const PlanLine tiny({0.0, 0.0, 1e-200, 0.0});
  EXPECT_TRUE(tiny.is_near(end, 6.0));
  EXPECT_FALSE(tiny.is_near(end, 5.0));
}

TEST_F(LineFile, ReadsBlanksAndCommas)
{
  const PlanLine line = read("\n# x y\n\n1 2\r\n# a bend\n 3,4 # last but one\n5 , 6\n\n");
  EXPECT_EQ(line.xy, (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(line.xlo, 1.0);
  EXPECT_EQ(line.yhi, 6.0);
}

TEST_F(LineFile, WhatIsWrongIsSaid)
{
  EXPECT_EQ(problem(""), path + ": must hold at least 2 points x y of a line, got 0");
  EXPECT_EQ(problem("1,2\n"), path + ": must hold at least 2 points x y of a line, got 1");
  EXPECT_EQ(problem("1,2\n1,2\n"), path + ", line 2: two points in a row must differ, got 1 2 twice");
  EXPECT_EQ(problem("1,2\n3,4\n\n# on the other side\n5,6\n7,8\n"),
            path + ", line 5: must be the next point of one line, without an empty line before it, got another line at 5 6");
  EXPECT_EQ(problem("# y x\n1 2\n3 4\n"), path + ", line 1: columns must be x y or x,y in m, got y x");
  EXPECT_EQ(problem("1,2\n1,2,3\n"), path + ", line 2: must be 2 numbers, x y or x,y, got 1,2,3");
}

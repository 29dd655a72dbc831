/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// A ball that leaves the ground is kept with the place and time of the edge, one that returns is not.

#include "ball_path.h"

#include <cmath>
#include <gtest/gtest.h>

using Slope::BallPath;
using Slope::LeftBall;

// ground from x 0 to 10 but for a hole from 4 to 5
static bool ground(const double *x)
{
  return x[0] >= 0.0 && x[0] <= 10.0 && !(x[0] > 4.0 && x[0] < 5.0);
}

static void move(BallPath &path, double x, double y, double before, double now)
{
  const double place[2] = {x, y};
  path.move(place, before, now, ground);
}

TEST(BallPath, LeavesAtTheEdge)
{
  BallPath path;
  move(path, 9.0, 1.0, 0.0, 0.0);
  EXPECT_FALSE(path.is_out());
  move(path, 9.5, 2.0, 0.0, 1.0);
  move(path, 11.5, 6.0, 1.0, 3.0);    // a quarter of the way
  EXPECT_TRUE(path.is_out());
  EXPECT_NEAR(path.left, 1.5, 1e-11);
  EXPECT_NEAR(path.at[0], 10.0, 1e-11);
  EXPECT_NEAR(path.at[1], 3.0, 1e-11);
  EXPECT_TRUE(ground(path.at));    // the last place above ground
  EXPECT_EQ(path.start[0], 9.0);
  EXPECT_EQ(path.start[1], 1.0);
  move(path, 15.0, 9.0, 3.0, 4.0);    // farther on: it left where it left
  EXPECT_NEAR(path.left, 1.5, 1e-11);
  EXPECT_NEAR(path.at[1], 3.0, 1e-11);
}

TEST(BallPath, ReturnsAndLeavesElsewhere)
{
  BallPath path;
  move(path, 9.0, 0.0, 0.0, 0.0);
  move(path, 11.0, 0.0, 0.0, 1.0);
  EXPECT_TRUE(path.is_out());
  move(path, 6.0, 0.0, 1.0, 2.0);
  EXPECT_FALSE(path.is_out());
  move(path, 4.5, 0.0, 2.0, 3.0);
  EXPECT_NEAR(path.at[0], 5.0, 1e-11);
  EXPECT_NEAR(path.left, 2.0 + 1.0 / 1.5, 1e-11);
  EXPECT_EQ(path.start[0], 9.0);
}

// it crossed the hole between two looks
TEST(BallPath, AcrossAHole)
{
  BallPath path;
  move(path, 3.0, 0.0, 0.0, 0.0);
  move(path, 6.0, 0.0, 0.0, 1.0);
  EXPECT_FALSE(path.is_out());
}

TEST(BallPath, NeverAboveGround)
{
  BallPath path;
  move(path, 4.5, 7.0, 0.0, 2.0);
  EXPECT_EQ(path.left, 2.0);
  EXPECT_EQ(path.at[0], 4.5);
  EXPECT_EQ(path.at[1], 7.0);
}

TEST(BallPath, TextByTimeAndBall)
{
  const LeftBall late = {1, 0.125, 2.5, {10, 3}, {9, 1}};
  const LeftBall early = {7, 1.0 / 3.0, 1.0, {0, 0.5}, {2, 2}};
  const LeftBall too = {3, 2.0, 1.0, {-1.5, 0}, {2, 2}};
  EXPECT_EQ(Slope::left_csv({late, early, too}),
            "ball,volume,time,x,y,from_x,from_y\n"
            "3,2,1,-1.5,0,2,2\n"
            "7,0.333333333333333,1,0,0.5,2,2\n"
            "1,0.125,2.5,10,3,9,1\n");
  EXPECT_EQ(Slope::left_csv({}), "ball,volume,time,x,y,from_x,from_y\n");
}

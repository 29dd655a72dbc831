/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A sunk surface: a ball of radius H around a point of it touches the surface from below and nowhere
   crosses it. Planes, spheres and kinks have closed forms; hills of a raster are looked at in points
   much closer than the columns of the sunk surface. Beyond its rim it goes on to the ground, or ends
   H beyond a wall; balls on it and on the ground around leave no way through, and no place for a ball
   of the ground near the body. */

#include "all_balls.h"
#include "sunk_surface.h"

#include "ball_flood.h"
#include "elevation_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

using namespace Slope;

namespace {

constexpr double PI = 3.14159265358979323846;
constexpr double H = 1.25;
constexpr double PITCH = H / 8.0;

double rad(double degrees)
{
  return degrees * PI / 180.0;
}

typedef std::function<double(double x, double y)> Height;

// a surface everywhere in a square, sunk without a rim

Bed open_bed(const Height &surface, double half)
{
  Bed bed = {-half, half, -half, half, nullptr, nullptr, false};
  bed.height = [=](double x, double y, double, double &z) {
    z = surface(x, y);
    return true;
  };
  return bed;
}

// a body between its lower surface and the ground, in a square where it is at all

Bed body(const Height &bottom, const Height &ground, double half,
         const std::function<bool(double, double)> &in = nullptr)
{
  Bed bed = {-half, half, -half, half, nullptr, nullptr, true};
  bed.height = [=](double x, double y, double, double &z) {
    z = bottom(x, y);
    return z <= ground(x, y) && (!in || in(x, y));
  };
  bed.ground = [=](double x, double y, double, double &z) {
    z = ground(x, y);
    return true;
  };
  return bed;
}

// distance from a point to the nearest of a surface, in columns so close that it is exact to 1e-3 H
// on slopes up to 60 degrees

double distance_to(const Height &surface, double x, double y, double z)
{
  double nearest2 = std::numeric_limits<double>::infinity();
  for (double b = y - 1.5 * H; b <= y + 1.5 * H; b += 0.02 * H)
    for (double a = x - 1.5 * H; a <= x + 1.5 * H; a += 0.02 * H) {
      const double dx = a - x, dy = b - y, dz = surface(a, b) - z;
      nearest2 = std::min(nearest2, dx * dx + dy * dy + dz * dz);
    }
  return std::sqrt(nearest2);
}

}    // namespace

/* ----------------------------------------------------------------------
   closed forms
------------------------------------------------------------------------- */

TEST(SunkSurface, plane_is_shifted_along_its_normal)
{
  for (double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 84.0})
    for (double azimuth : {0.0, 22.5, 45.0, 131.0}) {
      const double slope = std::tan(rad(degrees)), a = rad(azimuth);
      const Height plane = [=](double x, double y) {
        return slope * (std::cos(a) * x + std::sin(a) * y);
      };
      for (double pitch : {PITCH, 0.5 * H}) {
        const SunkSurface sunk(open_bed(plane, 6.0), H, pitch);
        for (double y = -3.0; y <= 3.0; y += 0.37)
          for (double x = -3.0; x <= 3.0; x += 0.41) {
            double z;
            ASSERT_TRUE(sunk.height(x, y, z));
            EXPECT_NEAR(z, plane(x, y) - H / std::cos(rad(degrees)), 1e-9)
                << degrees << " degrees, azimuth " << azimuth;
          }
      }
    }
}

TEST(SunkSurface, sphere_becomes_a_larger_one)
{
  // no ground: the lower half, and around its rim what is H beyond

  const double r = 5.0;
  Bed bed = {-r, r, -r, r, nullptr, nullptr, true};
  bed.height = [=](double x, double y, double, double &z) {
    const double under = r * r - x * x - y * y;
    z = -std::sqrt(std::max(under, 0.0));
    return under >= 0.0;
  };
  const SunkSurface sunk(bed, H, PITCH);
  EXPECT_NEAR(sunk.lowest(), -r - H, 1e-3 * H);
  for (double y = -r - H; y <= r + H; y += 0.173)
    for (double x = -r - H; x <= r + H; x += 0.167) {
      double z;
      const double plan = std::hypot(x, y);
      const bool there = sunk.height(x, y, z);
      if (plan < r + H - 0.02 * H) ASSERT_TRUE(there) << x << " " << y;
      if (plan > r + H + 0.001 * H) ASSERT_FALSE(there) << x << " " << y;
      const double within = plan < 0.86 * (r + H) ? 0.003 : 0.02;    // on slopes up to 60 degrees
      if (there)
        EXPECT_NEAR(std::sqrt(plan * plan + z * z), r + H, within * H) << x << " " << y << " " << z;
    }
}

TEST(SunkSurface, a_ball_rolls_around_the_bottom_of_a_valley)
{
  // two planes that meet below, in a column: the centres turn around the line where they meet

  for (double degrees : {10.0, 30.0, 45.0}) {
    const double slope = std::tan(rad(degrees)), turn = H * std::sin(rad(degrees));
    const SunkSurface sunk(open_bed(
                               [=](double x, double) {
                                 return slope * std::fabs(x);
                               },
                               40 * PITCH),
                           H, PITCH);
    for (double x = -4.0; x <= 4.0; x += 0.0931) {
      double z;
      ASSERT_TRUE(sunk.height(x, 0.2, z));
      const double expected = std::fabs(x) < turn
          ? -std::sqrt(H * H - x * x)
          : slope * std::fabs(x) - H / std::cos(rad(degrees));
      EXPECT_NEAR(z, expected, 1e-3 * H) << degrees << " degrees, x " << x;
    }
  }
}

TEST(SunkSurface, a_valley_between_the_columns_is_cut_off_by_half_a_pitch_at_most)
{
  const double slope = 1.0, x0 = 0.5 * PITCH;
  const SunkSurface sunk(open_bed(
                             [=](double x, double) {
                               return slope * std::fabs(x - x0);
                             },
                             40 * PITCH),
                         H, PITCH);
  double z;
  ASSERT_TRUE(sunk.height(x0, 0.0, z));
  EXPECT_GE(z, -H);
  EXPECT_LE(z, -H + 0.5 * PITCH * slope);
}

TEST(SunkSurface, below_a_crest_the_ball_touches_both_sides)
{
  const double slope = std::tan(rad(35.0));
  const SunkSurface sunk(open_bed(
                             [=](double x, double) {
                               return -slope * std::fabs(x);
                             },
                             6.0),
                         H, PITCH);
  for (double x = -4.0; x <= 4.0; x += 0.0931) {
    double z;
    ASSERT_TRUE(sunk.height(x, 0.2, z));
    EXPECT_NEAR(z, -slope * std::fabs(x) - H / std::cos(rad(35.0)), 1e-9) << x;
  }
}

/* ----------------------------------------------------------------------
   what it is, seen in another way
------------------------------------------------------------------------- */

TEST(SunkSurface, a_ball_below_the_hills_of_a_raster_touches_and_does_not_cross_them)
{
  ElevationGrid grid(16, 16, -8.0, -8.0, 1.0, 0.0);    // cells smaller than the ball
  for (int j = 0; j < 16; j++)
    for (int i = 0; i < 16; i++)
      grid.at(i, j) = 0.45 * i + 0.8 * std::sin(0.9 * i + 0.3 * j) * std::cos(0.8 * j);
  const Height hills = [&](double x, double y) {
    return grid.height(x, y);
  };
  const SunkSurface sunk(open_bed(hills, 7.9), H, PITCH);
  double deepest = 0.0;
  for (double y = -5.5; y <= 5.5; y += 0.83)
    for (double x = -5.5; x <= 5.5; x += 0.79) {
      double z;
      ASSERT_TRUE(sunk.height(x, y, z));
      EXPECT_NEAR(distance_to(hills, x, y, z), H, 0.02 * H) << x << " " << y;
      deepest = std::max(deepest, hills(x, y) - z);
    }
  EXPECT_GT(deepest, 1.3 * H);    // the hills are steep: straight down would be H
}

/* ----------------------------------------------------------------------
   the rim
------------------------------------------------------------------------- */

TEST(SunkSurface, a_slip_plane_goes_on_in_its_plane_to_the_ground)
{
  // it comes out of a level ground at x = 0 and is a body's on the left; also where a wall cuts it

  for (double degrees : {12.0, 20.0, 35.0, 60.0}) {
    const double slope = std::tan(rad(degrees)), azimuth = 0.3;
    const Height slip = [=](double x, double y) {
      return slope * (std::cos(azimuth) * x + std::sin(azimuth) * y);
    };
    const Height ground = [](double, double) {
      return 0.0;
    };
    const SunkSurface sunk(body(slip, ground, 8.0), H, PITCH);
    const double meets = H / std::sin(rad(degrees));
    for (double t = -3.0; t <= meets; t += 0.11) {    // along the dip, from the rim
      double z;
      const double x = t * std::cos(azimuth), y = t * std::sin(azimuth);
      ASSERT_TRUE(sunk.height(x, y, z)) << degrees << " degrees, at " << t;
      EXPECT_NEAR(z, slope * t - H / std::cos(rad(degrees)), 1e-6)
          << degrees << " degrees, at " << t;
    }
  }
}

TEST(SunkSurface, a_slip_surface_that_fades_out_still_meets_the_ground)
{
  const double slope = std::tan(rad(3.0));
  const SunkSurface sunk(body(
                             [=](double x, double) {
                               return slope * x;
                             },
                             [](double, double) {
                               return 0.0;
                             },
                             10.0),
                         H, PITCH);
  double z, end = 0.0;
  for (double x = -2.0; x < 9.0 * H; x += 0.05)
    if (sunk.height(x, 0.0, z) && z < 0.0) {
      EXPECT_LT(z, slope * x - 0.95 * H + 0.21 * std::max(x + 2.0 * H, 0.0));
      end = x;
    }
  EXPECT_GT(end, 3.0 * H);
  EXPECT_LT(end, 4.5 * H);    // in its plane it would not come up before 19 H
}

TEST(SunkSurface, a_body_with_walls_is_enlarged_by_H)
{
  // a pit with a bottom that dips, in level ground

  const double deep = 5.0, slope = 0.2;
  const Height bottom = [=](double x, double) {
    return slope * x - deep;
  };
  const Height ground = [](double, double) {
    return 0.0;
  };
  const auto pit = [](double x, double y) {
    return std::fabs(x) < 4.03 && std::fabs(y) < 3.02;
  };
  const SunkSurface sunk(body(bottom, ground, 6.0, pit), H, PITCH);
  double z;
  for (double t = 0.0; t < 2.0 * H; t += 0.03) {
    const bool there = sunk.height(0.4, 3.02 + t, z);
    EXPECT_EQ(there, t < H) << t;    // within 0.03
    if (there) {
      // the bottom's edge, which dips: a ball touches it where the edge is square to its radius
      const double across = std::sqrt(H * H - t * t) * std::sqrt(1.0 + slope * slope);
      EXPECT_NEAR(z, bottom(0.4, 0.0) - across, 0.01 * H) << t;
    }
  }
  ASSERT_TRUE(sunk.height(0.0, 0.0, z));
  EXPECT_NEAR(z, bottom(0.0, 0.0) - H * std::sqrt(1.0 + slope * slope), 1e-9);
}

TEST(SunkSurface, a_ground_is_looked_at_where_heights_are_asked_for)
{
  // a ground of 3.7e11 columns; the order in which heights are asked for does not matter

  int looks = 0;
  const Height hills = [](double x, double y) {
    return 3.0 * std::sin(x / 7.0) + 2.0 * std::cos(y / 5.0);
  };
  Bed wide = open_bed(hills, 5.0e4 * H);
  const auto height = wide.height;
  wide.height = [&](double x, double y, double near, double &z) {
    looks++;
    return height(x, y, near, z);
  };
  const SunkSurface sunk(wide, H, PITCH), again(wide, H, PITCH);
  EXPECT_EQ(looks, 0);
  std::vector<double> first;
  for (int k = 0; k < 40; k++) {
    double z;
    ASSERT_TRUE(sunk.height(3.0 * k, 900.0 - k, z));
    EXPECT_NEAR(distance_to(hills, 3.0 * k, 900.0 - k, z), H, 0.02 * H);
    first.push_back(z);
  }
  EXPECT_LT(looks, 1e6);
  for (int k = 39; k >= 0; k--) {
    double z;
    ASSERT_TRUE(again.height(3.0 * k, 900.0 - k, z));
    EXPECT_EQ(z, first[k]);
  }
}

TEST(SunkSurface, refuses_what_has_no_columns)
{
  const Bed bed = open_bed(
      [](double, double) {
        return 0.0;
      },
      1.0);
  EXPECT_THROW(SunkSurface(bed, H, 0.0), std::invalid_argument);
  EXPECT_THROW(SunkSurface(bed, H, H), std::invalid_argument);
  EXPECT_THROW(SunkSurface(bed, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(SunkSurface(bed, 1e-6, 1e-7), std::length_error);
  Bed empty = bed;
  std::swap(empty.xlo, empty.xhi);
  EXPECT_THROW(SunkSurface(empty, H, PITCH), std::invalid_argument);

  Bed nothing = bed;
  nothing.height = [](double, double, double, double &) {
    return false;
  };
  double z;
  EXPECT_FALSE(SunkSurface(nothing, H, PITCH).height(0.0, 0.0, z));
  EXPECT_FALSE(SunkSurface(bed, H, PITCH).height(1.1, 0.0, z));    // beyond it
}

/* ----------------------------------------------------------------------
   slip balls below a body and field balls around: no way through, and room for the body
------------------------------------------------------------------------- */

namespace {

struct Ground {
  std::vector<double> slip, field;
};

// as fix wall/gran/balls places them: soil of diameter d, field balls of diameter field

Ground place(const Bed &bed, const Height &ground, double half, double d, double field, double sink,
             bool goes_on = true)
{
  const SunkSurface sunk(bed, sink, std::min(std::max(sink, d) / 8.0, 0.5 * sink));
  GroundHeights below, around;
  below.height = [&](double x, double y, double &z) {
    if (!sunk.height(x, y, z) || z >= ground(x, y)) return false;
    double bottom;
    return goes_on || bed.height(x, y, z, bottom);
  };
  around.height = [&](double x, double y, double &z) {
    z = ground(x, y);
    return true;
  };
  around.keep = [&](double x, double y) {
    double z;
    return !(sunk.height(x, y, z) && z < ground(x, y));
  };
  around.scar = [&](double x, double y, double &z) {
    return sunk.height(x, y, z) && z < ground(x, y);
  };
  const double smallest = std::min(d, field);
  Ground balls;
  balls.slip = sample_surface({-half, half, -half, half, 0.5 * d, 0.1, 0.2}, 0.5 * d, below).xyz;
  balls.field =
      sample_surface({-half, half, -half, half, field, 0.0, 0.0}, 0.25 * (smallest + field), around)
          .xyz;
  return balls;
}

bool leaks(const Ground &balls, double half, double zlo, double zhi, double d, double field)
{
  const double inner = half - 0.5 * field;
  BallFlood flood({{-inner, -inner, zlo}}, {{inner, inner, zhi}}, 0.075 * d);
  flood.add(balls.slip, d);
  flood.add(balls.field, 0.5 * (d + field));
  return flood.gets_through();
}

// how close centres of soil in the body come to fixed ones, over columns of it that are a pitch apart

double closest(const std::vector<double> &xyz, const Bed &bed, double half, double pitch = 0.06)
{
  double nearest2 = std::numeric_limits<double>::infinity();
  for (double y = -half; y <= half; y += pitch)
    for (double x = -half; x <= half; x += pitch) {
      double bottom, top;
      if (!bed.height(x, y, 0.0, bottom)) continue;
      bed.ground(x, y, 0.0, top);
      for (size_t k = 0; k < xyz.size(); k += 3) {
        const double dx = xyz[k] - x, dy = xyz[k + 1] - y;
        const double dz = xyz[k + 2] - std::min(std::max(xyz[k + 2], bottom), top);
        nearest2 = std::min(nearest2, dx * dx + dy * dy + dz * dz);
      }
    }
  return std::sqrt(nearest2);
}

}    // namespace

TEST(SunkSurface, soil_on_a_sunk_slip_sphere_finds_no_way_through)
{
  const double half = 7.0;
  for (double degrees : {20.0, 50.0}) {
    const double slope = std::tan(rad(degrees));
    const Height ground = [=](double x, double y) {
      return slope * x + 0.3 * std::sin(1.3 * x) * std::cos(y);
    };
    const double up = 3.5 * std::cos(rad(degrees)), back = -3.5 * std::sin(rad(degrees));
    const Height sphere = [=](double x, double y) {    // of radius 5 around a point above the slope
      const double dx = x - back, under = 25.0 - dx * dx - y * y;
      return under < 0.0 ? 1e9 : up - std::sqrt(under);
    };
    const Bed bed = body(sphere, ground, half);
    const double high = slope * half + 3.0;
    for (double field : {0.6, 1.0, 1.4}) {
      const double d = 1.0;
      const Ground balls = place(bed, ground, half, d, field, d);
      EXPECT_FALSE(leaks(balls, half, -high - 3.0, high, d, field))
          << degrees << " field " << field;
      EXPECT_GT(closest(balls.slip, bed, half), 0.97 * d);    // the crown is vertical
      EXPECT_GT(closest(balls.field, bed, half), 0.99 * d);
    }

    // slip balls below the body alone leave a ring open

    const Ground short_of = place(bed, ground, half, 1.0, 1.0, 1.0, false);
    EXPECT_TRUE(leaks(short_of, half, -high - 3.0, high, 1.0, 1.0)) << degrees;
  }
}

TEST(SunkSurface, soil_in_a_sunk_pit_with_walls_finds_no_way_through)
{
  const double half = 6.0;
  const Height ground = [](double x, double y) {
    return 0.4 * x + 0.1 * y;
  };
  const Height bottom = [=](double x, double y) {
    return ground(x, y) - 2.5 + 0.2 * std::sin(x);
  };
  const auto triangle = [](double x, double y) {
    return x > -3.1 && y > -2.9 && x + y < 1.3;
  };
  const Bed bed = body(bottom, ground, half, triangle);
  for (double d : {0.7, 1.0, 1.7}) {
    const Ground balls = place(bed, ground, half, d, d, d);
    EXPECT_FALSE(leaks(balls, half, -10.0, 5.0, d, d)) << d;
    EXPECT_GT(closest(balls.slip, bed, half), 0.95 * d);    // the corners are sharp
    EXPECT_GT(closest(balls.field, bed, half), 0.95 * d);
  }
}

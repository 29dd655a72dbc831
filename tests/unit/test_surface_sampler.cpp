/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The fixed balls of a surface leave no way through: every point of it lies closer than two
   radii to a ball centre, so that a ball of the same size whose centre gets there touches one.
   Looked at here in many more points than the sampler looks at, found in another way.
   The plan grid is left as it is where it is good. */


#include "all_balls.h"
#include "ball_flood.h"
#include "surface_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

using namespace Slope;

namespace {

constexpr double S = 2.0 * R;     // the paper's spacing of the ground
constexpr double LIMIT = 1.93;    // in radii: cover radius and sampling

GroundHeights level()
{
  return plane(0.0, 0.0);
}

NodeGrid square(double side, double spacing = S)
{
  return {0.0, side, 0.0, side, spacing, 0.0, 0.0};
}

}    // namespace

/* ---------------------------------------------------------------------- */

TEST(SurfaceSampler, planes_of_any_slope_are_closed)
{
  for (double spacing : {S, 0.5 * S})
    for (double azimuth : {0.0, 22.5, 45.0, 77.0, 180.0})
      for (double degrees : {0.0, 30.0, 45.0, 50.0, 54.7, 60.0, 66.0, 70.0, 75.0, 80.0, 85.0}) {
        const double side = degrees < 75.0 ? 6.0 * S : 2.0 * S;
        const GroundHeights s = plane(degrees, azimuth);
        const SurfaceBalls balls = sample_surface(square(side, spacing), R, s);
        const double gap =
            worst_gap(s, Nearest(balls.xyz), 0.0, side, 0.0, side, std::tan(degrees * PI / 180.0));
        EXPECT_LT(gap, LIMIT) << degrees << " degrees, azimuth " << azimuth << ", spacing "
                              << spacing / R << " R";
      }
}

TEST(SurfaceSampler, without_the_extra_balls_a_ball_passes_above_54_7_degrees)
{
  // along the slope a plan cell is 2R by 2R/cos: its middle is R sqrt(1 + 1/cos^2) from a node

  for (double degrees : {50.0, 54.0, 55.5, 60.0, 70.0}) {
    const GroundHeights s = plane(degrees, 0.0);
    const SurfaceBalls balls = sample_surface(square(6.0 * S), R, s);
    const double cosine = std::cos(degrees * PI / 180.0);
    const double gap = worst_gap(s, Nearest(balls.xyz, balls.base), S, 5.0 * S, S, 5.0 * S,
                                 std::tan(degrees * PI / 180.0));
    EXPECT_NEAR(gap, std::sqrt(1.0 + 1.0 / (cosine * cosine)), 0.02) << degrees << " degrees";
    EXPECT_EQ(gap > 2.0, degrees > 54.7) << degrees << " degrees";
  }
}

TEST(SurfaceSampler, up_to_45_degrees_the_plan_grid_is_all)
{
  for (double azimuth = 0.0; azimuth < 360.0; azimuth += 15.0)
    for (double degrees : {0.0, 20.0, 40.0, 45.0}) {
      const SurfaceBalls balls = sample_surface(square(10.0 * S), R, plane(degrees, azimuth));
      EXPECT_EQ(balls.base, 121);
      EXPECT_EQ(balls.extra, 0) << degrees << " degrees, azimuth " << azimuth;
    }
}

TEST(SurfaceSampler, extra_balls_are_few)
{
  // one per cell closes a slope of 60 degrees

  const SurfaceBalls balls = sample_surface(square(20.0 * S), R, plane(60.0, 0.0));
  EXPECT_EQ(balls.base, 441);
  EXPECT_EQ(balls.extra, 400);
}

TEST(SurfaceSampler, balls_lie_on_the_surface)
{
  const GroundHeights s = plane(75.0, 30.0);
  const SurfaceBalls balls = sample_surface({0.0, 5.3, -2.1, 4.4, S, 0.2, 0.3}, R, s);
  ASSERT_EQ(balls.xyz.size(), 3 * static_cast<size_t>(balls.base + balls.extra));
  EXPECT_GT(balls.extra, 0);
  for (size_t k = 0; k < balls.xyz.size(); k += 3) {
    double z;
    s.height(balls.xyz[k], balls.xyz[k + 1], z);
    EXPECT_NEAR(balls.xyz[k + 2], z, 1e-9);
  }
}

/* ----------------------------------------------------------------------
   the plan grid
------------------------------------------------------------------------- */

TEST(SurfaceSampler, nodes_are_origin_plus_multiples_row_by_row)
{
  const SurfaceBalls balls = sample_surface({-1.0, 2.0, 3.0, 4.6, 0.75, 0.5, 0.25}, R, level());
  const std::vector<double> x = {-1.0, -0.25, 0.5, 1.25, 2.0}, y = {3.25, 4.0};
  ASSERT_EQ(balls.base, 10);
  EXPECT_EQ(balls.nodes, 10);
  for (int k = 0; k < 10; k++) {
    EXPECT_NEAR(balls.xyz[3 * k], x[k % 5], 1e-12);
    EXPECT_NEAR(balls.xyz[3 * k + 1], y[k / 5], 1e-12);
    EXPECT_EQ(balls.xyz[3 * k + 2], 0.0);
  }
}

TEST(SurfaceSampler, round_off_loses_no_row_at_the_edge)
{
  // 3 * 0.1 > 0.3 and the surface ends there

  GroundHeights s;
  s.height = [](double x, double y, double &z) {
    z = 0.0;
    return x >= 0.0 && x <= 0.3 && y >= 0.0 && y <= 0.3;
  };
  const SurfaceBalls balls = sample_surface({0.0, 0.3, 0.0, 0.3, 0.1, 0.0, 0.0}, 0.05, s);
  EXPECT_EQ(balls.base, 16);
  EXPECT_EQ(balls.extra, 0);
  EXPECT_EQ(count_nodes({0.0, 0.3, 0.0, 0.3, 0.1, 0.0, 0.0}), 16.0);
}

TEST(SurfaceSampler, the_strip_beyond_the_last_node_is_closed)
{
  const GroundHeights s = plane(30.0, 20.0);
  const SurfaceBalls balls = sample_surface({0.0, 5.9, 0.0, 5.9, S, 0.0, 0.0}, R, s);
  EXPECT_EQ(balls.base, 36);
  EXPECT_LT(worst_gap(s, Nearest(balls.xyz), 0.0, 5.9, 0.0, 5.9, 0.6), LIMIT);
}

TEST(SurfaceSampler, wide_spacing_is_left_alone_on_almost_level_ground)
{
  const SurfaceBalls gentle = sample_surface(square(15.0 * R, 3.0 * R), R, plane(10.0, 0.0));
  EXPECT_EQ(gentle.base, 36);
  EXPECT_EQ(gentle.extra, 0);
  EXPECT_GT(3.0 * R, widest_spacing(R));    // what callers warn of
  EXPECT_NEAR(cover_radius(widest_spacing(R), R) + sampling_slack(R), 2.0 * R, 1e-12 * R);

  const GroundHeights steep = plane(60.0, 0.0);
  const SurfaceBalls balls = sample_surface(square(15.0 * R, 3.0 * R), R, steep);
  EXPECT_LT(R * worst_gap(steep, Nearest(balls.xyz), 0.0, 15.0 * R, 0.0, 15.0 * R, 1.74),
            cover_radius(3.0 * R, R) + sampling_slack(R));
}

TEST(SurfaceSampler, refuses_what_makes_no_grid)
{
  EXPECT_THROW(sample_surface(square(1.0, 0.0), R, level()), std::invalid_argument);
  EXPECT_THROW(sample_surface(square(1.0, -1.0), R, level()), std::invalid_argument);
  EXPECT_THROW(sample_surface(square(1.0), 0.0, level()), std::invalid_argument);
  EXPECT_THROW(sample_surface({1.0, 0.0, 0.0, 1.0, S, 0.0, 0.0}, R, level()),
               std::invalid_argument);
  EXPECT_THROW(sample_surface(square(1.0, 1e-9), R, level()), std::length_error);
  EXPECT_EQ(sample_surface({0.1, 0.2, 0.1, 0.2, S, 0.0, 0.0}, R, level()).nodes, 0);
}

TEST(SurfaceSampler, same_balls_every_time)
{
  const GroundHeights s = plane(72.0, 33.0);
  const SurfaceBalls a = sample_surface(square(8.0 * S), R, s);
  const SurfaceBalls b = sample_surface(square(8.0 * S), R, s);
  EXPECT_EQ(a.xyz, b.xyz);
}

/* ----------------------------------------------------------------------
   shapes
------------------------------------------------------------------------- */

TEST(SurfaceSampler, vertical_step_is_closed)
{
  // the surface between the nodes on both sides of the step is the chord from foot to top

  const double top = 9.0, edge = 3.2;
  GroundHeights step, chord;
  step.height = [=](double x, double, double &z) {
    z = x < edge ? 0.0 : top;
    return true;
  };
  chord.height = [=](double x, double, double &z) {
    z = top * std::min(std::max((x - 3.0) / S, 0.0), 1.0);
    return true;
  };
  const SurfaceBalls balls = sample_surface(square(8.0 * S), R, step);
  EXPECT_EQ(balls.base, 81);
  EXPECT_LT(worst_gap(chord, Nearest(balls.xyz), 0.0, 8.0, 0.0, 4.0, top / S), LIMIT);
  EXPECT_GT(worst_gap(chord, Nearest(balls.xyz, balls.base), 0.0, 8.0, 0.0, 4.0, top / S), 2.0);

  // and nothing is added where the ground is level

  for (size_t k = 3 * balls.base; k < balls.xyz.size(); k += 3) {
    EXPECT_GE(balls.xyz[k], 3.0);
    EXPECT_LE(balls.xyz[k], 4.0);
  }
}

TEST(SurfaceSampler, enormous_step_takes_no_enormous_time)
{
  GroundHeights s;
  s.height = [](double x, double, double &z) {
    z = x < 1.5 ? 0.0 : 3000.0;
    return true;
  };
  const SurfaceBalls balls = sample_surface(square(3.0 * S), R, s);
  EXPECT_GT(balls.extra, 3 * 1000);
  EXPECT_LT(balls.extra, 3 * 12000);
}

TEST(SurfaceSampler, cone_is_closed)
{
  const double g = std::tan(70.0 * PI / 180.0);
  GroundHeights cone;
  cone.height = [=](double x, double y, double &z) {
    z = -g * std::hypot(x - 6.1, y - 5.8);
    return true;
  };
  const SurfaceBalls balls = sample_surface(square(12.0 * S), R, cone);

  // between the nodes the sampler closes the patches, which cut off up to S^2/(8 r) of the curve

  GroundHeights outer = cone;
  outer.keep = [](double x, double y) {
    return std::hypot(x - 6.1, y - 5.8) > 3.0;
  };
  EXPECT_LT(worst_gap(outer, Nearest(balls.xyz), 0.0, 12.0, 0.0, 12.0, g), LIMIT + 0.06);
}

TEST(SurfaceSampler, bowl_is_closed_up_to_its_rim)
{
  // a slip sphere of 24 R, cut by a ground that rises at 20 degrees; columns beyond have no surface

  const double r = 24.0 * R, c = 8.0 * R;
  GroundHeights bowl;
  bowl.height = [=](double x, double y, double &z) {
    const double under = r * r - x * x - y * y;
    if (under < 0.0) return false;
    z = c - std::sqrt(under);
    return z <= 0.36 * x;
  };
  for (double spacing : {S, 0.5 * S}) {
    const SurfaceBalls balls = sample_surface({-r, r, -r, r, spacing, 0.1, 0.2}, R, bowl);
    EXPECT_GT(balls.without_surface, 0);
    EXPECT_EQ(balls.nodes, balls.without_surface + balls.base);
    EXPECT_LT(worst_gap(bowl, Nearest(balls.xyz), -r, r, -r, r, 2.0), LIMIT + 0.03);
    for (size_t k = 0; k < balls.xyz.size(); k += 3)
      EXPECT_LE(balls.xyz[k + 2], 0.36 * balls.xyz[k] + 1e-9);
  }
}

TEST(SurfaceSampler, bowl_with_vertical_rim_is_closed)
{
  const double r = 12.0 * R;
  GroundHeights bowl;
  bowl.height = [=](double x, double y, double &z) {
    const double under = r * r - x * x - y * y;
    z = -std::sqrt(std::max(under, 0.0));
    return under >= 0.0;
  };
  const SurfaceBalls balls = sample_surface({-r, r, -r, r, S, 0.0, 0.0}, R, bowl);
  const Nearest nearest(balls.xyz);
  double worst = 0.0;
  for (double lat = 0.0; lat < 90.0; lat += 0.3)    // degrees below the rim
    for (double az = 0.0; az < 360.0; az += 0.3) {
      const double a = az * PI / 180.0, b = lat * PI / 180.0;
      worst = std::max(
          worst,
          nearest(r * std::cos(a) * std::cos(b), r * std::sin(a) * std::cos(b), -r * std::sin(b)));
    }
  EXPECT_LT(worst, 2.0);
}

TEST(SurfaceSampler, hole_in_the_data_is_closed_up_to_its_rim)
{
  GroundHeights s = plane(35.0, 10.0);
  const auto ground = s.height;
  s.height = [=](double x, double y, double &z) {
    return ground(x, y, z) && !(x > 3.3 && x < 6.8 && y > 4.1 && y < 5.9);
  };
  const SurfaceBalls balls = sample_surface(square(10.0 * S), R, s);
  EXPECT_EQ(balls.nodes, 121);
  EXPECT_EQ(balls.without_surface, 3);    // x 4, 5, 6 at y 5
  EXPECT_EQ(balls.base, 118);
  EXPECT_LT(worst_gap(s, Nearest(balls.xyz), 0.0, 10.0, 0.0, 10.0, 0.7), LIMIT);
}

/* ----------------------------------------------------------------------
   filter
------------------------------------------------------------------------- */

TEST(SurfaceSampler, filter_keeps_whole_columns_and_is_closed_up_to_its_rim)
{
  for (bool inside : {true, false}) {
    GroundHeights s = plane(40.0, 70.0);
    s.keep = [=](double x, double y) {
      return (std::hypot(x - 6.0, y - 6.0) < 3.7) == inside;
    };
    const SurfaceBalls balls = sample_surface(square(12.0 * S), R, s);
    EXPECT_EQ(balls.nodes, 169);
    EXPECT_EQ(balls.nodes, balls.base + balls.dropped);
    EXPECT_EQ(balls.base, inside ? 45 : 124);    // lattice points within 3.7 of one: 45
    for (size_t k = 0; k < balls.xyz.size(); k += 3) {
      const double beyond = std::hypot(balls.xyz[k] - 6.0, balls.xyz[k + 1] - 6.0) - 3.7;
      EXPECT_LT(inside ? beyond : -beyond, 0.01 * R);
    }
    EXPECT_LT(worst_gap(s, Nearest(balls.xyz), 0.0, 12.0, 0.0, 12.0, 0.84), LIMIT);
  }
}

TEST(SurfaceSampler, filter_keeps_the_sharp_corner_between_nodes)
{
  // a wedge whose tip lies in a cell that has no node inside

  GroundHeights s = level();
  s.keep = [](double x, double y) {
    return y > 4.0 && y < 8.9 && std::fabs(x - 2.5) < 0.3 * (8.9 - y);
  };
  const SurfaceBalls balls = sample_surface(square(10.0 * S), R, s);
  EXPECT_LT(worst_gap(s, Nearest(balls.xyz), 0.0, 10.0, 0.0, 10.0), LIMIT + 0.1);
}

/* ----------------------------------------------------------------------
   scarp: the ground outside of a scar with vertical walls, 6 deep
------------------------------------------------------------------------- */

static double worst_on_walls(const Nearest &nearest,
                             const std::vector<std::array<double, 2>> &corner, double depth,
                             double gradient)
{
  double worst = 0.0;
  for (size_t c = 0; c < corner.size(); c++) {
    const auto &a = corner[c], &b = corner[(c + 1) % corner.size()];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    for (double t = 0.0; t <= 1.0; t += 0.05 * R / length)
      for (double h = 0.0; h <= depth; h += 0.05 * R) {
        const double x = a[0] + t * (b[0] - a[0]), y = a[1] + t * (b[1] - a[1]);
        if (std::min(t, 1.0 - t) * length < 0.5 * R) continue;    // the sampler rounds corners off
        worst = std::max(worst, nearest(x, y, gradient * x - h));
      }
  }
  return worst;
}

TEST(SurfaceSampler, wall_of_a_scar_is_closed)
{
  const double depth = 6.0, g = 0.3;
  const std::vector<std::vector<std::array<double, 2>>> scars = {
      {{3.3, 2.2}, {8.8, 2.2}, {8.8, 9.4}, {3.3, 9.4}},    // along the grid
      {{5.0, 1.5}, {9.6, 5.5}, {6.0, 10.2}, {1.7, 6.0}},
      {{1.95, 5.5}, {10.0, 2.9}, {10.0, 8.1}}};    // pointed, between nodes
  for (const auto &corner : scars) {
    GroundHeights s = plane(std::atan(g) * 180.0 / PI, 0.0);
    s.keep = [=](double x, double y) {
      return !in_polygon(corner, x, y);
    };

    const SurfaceBalls open = sample_surface(square(12.0 * S), R, s);
    EXPECT_GT(worst_on_walls(Nearest(open.xyz), corner, depth, g), 2.0);

    s.scar = [=](double x, double, double &z) {
      z = g * x - depth;
      return true;
    };
    const SurfaceBalls closed = sample_surface(square(12.0 * S), R, s);
    EXPECT_EQ(closed.base, open.base);
    EXPECT_LT(worst_on_walls(Nearest(closed.xyz), corner, depth, g), LIMIT + 0.05);
  }
}

TEST(SurfaceSampler, no_scarp_where_the_scar_ends_at_the_ground)
{
  // a slip plane that comes out of the ground at x = 5

  GroundHeights s = level();
  s.keep = [](double x, double) {
    return x > 5.3;
  };
  const SurfaceBalls without = sample_surface(square(10.0 * S), R, s);
  s.scar = [](double x, double, double &z) {
    z = x - 5.3;
    return true;
  };
  EXPECT_EQ(sample_surface(square(10.0 * S), R, s).xyz, without.xyz);
}

TEST(SurfaceSampler, no_curtain_up_to_a_region_above_the_ground)
{
  GroundHeights s = level();
  s.keep = [](double x, double y) {
    return std::hypot(x - 5.0, y - 5.0) > 2.5;
  };
  const SurfaceBalls without = sample_surface(square(10.0 * S), R, s);
  s.scar = [](double, double, double &z) {
    z = 3.0;
    return true;
  };
  EXPECT_EQ(sample_surface(square(10.0 * S), R, s).xyz, without.xyz);
}

/* ----------------------------------------------------------------------
   ground and scar together: the field balls outside of a release, the slip balls below it
------------------------------------------------------------------------- */

static void expect_closed(const std::function<double(double, double)> &ground,
                          const std::function<bool(double, double, double &)> &slip, double zlo,
                          double zhi, bool needs_scarp)
{
  const double side = 12.0;
  GroundHeights field, bottom;
  field.height = [=](double x, double y, double &z) {
    z = ground(x, y);
    return true;
  };
  field.keep = [=](double x, double y) {
    double z;
    return !(slip(x, y, z) && z <= ground(x, y));
  };
  field.scar = slip;
  bottom.height = [=](double x, double y, double &z) {
    return slip(x, y, z) && z <= ground(x, y);
  };

  const std::array<double, 3> lo = {{0.0, 0.0, zlo}}, hi = {{side, side, zhi}};
  for (double slip_spacing : {S, 0.5 * S}) {
    std::vector<double> xyz = sample_surface(square(side), R, field).xyz;
    EXPECT_TRUE(ball_gets_through(xyz, 2.0 * R, lo, hi));
    const SurfaceBalls slip_balls =
        sample_surface({0.0, side, 0.0, side, slip_spacing, 0.3, 0.1}, R, bottom);
    xyz.insert(xyz.end(), slip_balls.xyz.begin(), slip_balls.xyz.end());
    EXPECT_FALSE(ball_gets_through(xyz, 2.0 * R, lo, hi));
  }

  if (!needs_scarp) return;
  field.scar = nullptr;
  std::vector<double> xyz = sample_surface(square(side), R, field).xyz;
  const SurfaceBalls slip_balls = sample_surface(square(side), R, bottom);
  xyz.insert(xyz.end(), slip_balls.xyz.begin(), slip_balls.xyz.end());
  EXPECT_TRUE(ball_gets_through(xyz, 2.0 * R, lo, hi));
}

TEST(SurfaceSampler, no_way_under_the_ground_past_a_slip_sphere)
{
  // in a slope of 58 degrees with waves on it

  const double g = std::tan(58.0 * PI / 180.0);
  expect_closed(
      [=](double x, double y) {
        return g * x + 0.4 * std::sin(2.0 * x) * std::cos(y);
      },
      [=](double x, double y, double &z) {
        const double dx = x - 3.0, dy = y - 6.2, r = 7.0;
        const double under = r * r - dx * dx - dy * dy;
        z = 13.2 - std::sqrt(std::max(under, 0.0));
        return under >= 0.0;
      },
      -3.0, 22.0, false);
}

TEST(SurfaceSampler, no_way_under_the_ground_past_a_vertical_wall)
{
  const std::vector<std::array<double, 2>> corner = {{{2.2, 5.1}}, {{9.4, 2.5}}, {{10.0, 8.7}}};
  expect_closed(
      [](double x, double y) {
        return 0.5 * x + 0.2 * y;
      },
      [=](double x, double y, double &z) {
        z = 0.3 * x - 3.0;
        return in_polygon(corner, x, y);
      },
      -5.0, 11.0, true);
}

/* ----------------------------------------------------------------------
   balls that are smaller than the fixed ones: half the distance of contact in place of the radius
------------------------------------------------------------------------- */

TEST(SurfaceSampler, ground_for_smaller_balls_leaves_them_no_way)
{
  const double small = 0.55 * R, contact = small + R, side = 5.0;
  for (double degrees : {45.0, 52.0, 60.0, 72.0})
    for (double azimuth : {0.0, 30.0, 45.0}) {
      const GroundHeights s = plane(degrees, azimuth);
      double middle;
      s.height(0.5 * side, 0.5 * side, middle);
      const double high = side * std::tan(degrees * PI / 180.0);
      const std::array<double, 3> lo = {{0.5, 0.5, middle - high}};
      const std::array<double, 3> hi = {{side - 0.5, side - 0.5, middle + high}};
      const NodeGrid grid = square(side, 0.9 * S);
      EXPECT_FALSE(ball_gets_through(sample_surface(grid, 0.5 * contact, s).xyz, contact, lo, hi))
          << degrees << " degrees, azimuth " << azimuth;
      if (degrees > 50.0 && azimuth == 0.0)
        EXPECT_TRUE(ball_gets_through(sample_surface(grid, R, s).xyz, contact, lo, hi))
            << degrees << " degrees";
    }
}

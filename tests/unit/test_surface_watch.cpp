/* Which points of a surface a ball touches: faces, edges and corners once each, whatever the triangles. */

#include "surface_watch.h"
#include "terrain_surface.h"
#include "triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

using namespace Slope;

static const double R = 0.5;

static void add_square(std::vector<Triangle> &list, const Vector &a, const Vector &u, const Vector &v, int n = 1)
{
  auto at = [&](double i, double j) { return moved(moved(a, i / n, u), j / n, v); };
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      list.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      list.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

// a cube from 0 to 2
static std::vector<Triangle> cube(int n = 1)
{
  std::vector<Triangle> list;
  const Vector o = {0, 0, 0}, x = {2, 0, 0}, y = {0, 2, 0}, z = {0, 0, 2};
  for (const Vector *shift : {&o, &z}) add_square(list, *shift, x, y, n);
  for (const Vector *shift : {&o, &y}) add_square(list, *shift, x, z, n);
  for (const Vector *shift : {&o, &x}) add_square(list, *shift, y, z, n);
  return list;
}

static std::vector<SurfaceContact> contacts(const std::vector<Triangle> &list, const Vector &x, double r = R)
{
  std::vector<SurfacePoint> points;
  for (size_t k = 0; k < list.size(); k++) {
    const SurfacePoint p = nearest_point(list[k], static_cast<int>(k), x);
    if (p.distance < r) points.push_back(p);
  }
  std::vector<SurfaceContact> own;
  SurfaceWatch::choose(points, r, own);
  return own;
}

static void expect_vector(const Vector &a, double x, double y, double z)
{
  EXPECT_NEAR(a.x, x, 1e-12);
  EXPECT_NEAR(a.y, y, 1e-12);
  EXPECT_NEAR(a.z, z, 1e-12);
}

// as deep as it gets: such a ball is refused at the start, but a fast one may come there
TEST(SurfaceWatch, ACentreOnAnEdgeHasNoForceWithoutBound)
{
  std::vector<Triangle> list;
  add_square(list, {0, 0, 0}, {2, 0, 0}, {0, 2, 0});
  add_square(list, {0, 0.4, 0}, {2, 0, 0}, {0, -2, 2});
  for (double z : {0.0, 1e-300, -1e-12, -1e-3})
    for (const SurfaceContact &c : contacts(list, {1.25, -std::fabs(z), -z})) {
      EXPECT_TRUE(c.overlap > 0.0 && c.overlap < 4.0 * R) << z << " " << c.overlap;
      EXPECT_TRUE(c.spring > 0.0 && c.spring <= R) << z << " " << c.spring;
    }
  EXPECT_EQ(contacts(list, {1.25, 0.0, 0.0}).size(), 2u);
}

TEST(NearestPoint, IsTheNearestOfAllPoints)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int k = 0; k < 300; k++) {
    auto point = [&]() { return Vector{any(random), any(random), any(random)}; };
    const Triangle t = {point(), point(), point()};
    const Vector x = point();
    const SurfacePoint p = nearest_point(t, 7, x);
    EXPECT_EQ(p.triangle, 7);
    EXPECT_NEAR(size_of(minus(x, p.point)), p.distance, 1e-12);
    expect_vector(moved(p.point, p.distance, p.normal), x.x, x.y, x.z);
    double least = HUGE_VAL;
    for (int i = 0; i <= 60; i++)
      for (int j = 0; i + j <= 60; j++) {
        const Vector q = moved(moved(t.a, i / 60.0, minus(t.b, t.a)), j / 60.0, minus(t.c, t.a));
        least = std::min(least, size_of(minus(x, q)));
      }
    EXPECT_LE(p.distance, least + 1e-12);
    EXPECT_GE(p.distance, least - 0.06);
  }
}

TEST(NearestPoint, HasANormalEvenOnTheTriangle)
{
  const Triangle t = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  expect_vector(nearest_point(t, 0, {0.2, 0.2, 0.0}).normal, 0, 0, 1);
  expect_vector(nearest_point(t, 0, {0.0, 0.0, 0.0}).normal, 0, 0, 1);
  expect_vector(nearest_point(t, 0, {0.2, 0.2, -0.3}).normal, 0, 0, -1);    // two sides
}

TEST(Choose, AFaceCountsOnceWhateverItsTriangles)
{
  for (const int n : {1, 2, 7, 30})
    for (const Vector &x : {Vector{1.0, 1.0, 2.4}, Vector{0.7, 1.3, 2.1}, Vector{1.0, 0.4, 2.3}, Vector{1, 1, 2.05}}) {
      const auto found = contacts(cube(n), x);
      ASSERT_EQ(found.size(), 1u) << n;
      EXPECT_NEAR(found[0].at.distance, x.z - 2.0, 1e-12);
      expect_vector(found[0].at.normal, 0, 0, 1);
    }
}

TEST(Choose, AnEdgeAndACornerCountOnceFromOutside)
{
  for (const int n : {1, 3}) {
    auto found = contacts(cube(n), {2.2, 1.0, 2.2});
    ASSERT_EQ(found.size(), 1u);
    expect_vector(found[0].at.point, 2, 1, 2);
    expect_vector(found[0].at.normal, std::sqrt(0.5), 0, std::sqrt(0.5));
    found = contacts(cube(n), {2.2, -0.2, 2.2});
    ASSERT_EQ(found.size(), 1u);
    expect_vector(found[0].at.point, 2, 0, 2);
    // beside an edge the face alone
    found = contacts(cube(n), {1.95, 1.0, 2.3});
    ASSERT_EQ(found.size(), 1u);
    expect_vector(found[0].at.normal, 0, 0, 1);
  }
}

TEST(Choose, FromInsideTheFacesCountAndNoEdge)
{
  for (const int n : {1, 5}) {
    EXPECT_EQ(contacts(cube(n), {1.0, 1.0, 0.4}).size(), 1u);
    EXPECT_EQ(contacts(cube(n), {1.6, 1.0, 0.4}).size(), 2u);
    const auto found = contacts(cube(n), {1.6, 0.45, 0.4});
    ASSERT_EQ(found.size(), 3u);
    std::set<int> axes;
    for (const SurfaceContact &c : found)
      axes.insert(std::fabs(c.at.normal.x) > 0.9 ? 0 : std::fabs(c.at.normal.y) > 0.9 ? 1 : 2);
    EXPECT_EQ(axes.size(), 3u);
  }
}

// two squares that rise by an angle beyond x = 0
static std::vector<Triangle> kink(double angle)
{
  std::vector<Triangle> list;
  add_square(list, {-4, -4, 0}, {4, 0, 0}, {0, 8, 0});
  add_square(list, {0, -4, 0}, {4 * std::cos(angle), 0, 4 * std::sin(angle)}, {0, 8, 0});
  return list;
}

// a sphere's lower half from the inside
static std::vector<Triangle> bowl(double radius, int n)
{
  std::vector<Triangle> list;
  const double pi = std::acos(-1.0);
  auto at = [&](int i, int j) {
    const double down = pi - 0.5 * pi * (i + 0.3) / n, turn = 2.0 * pi * j / n;
    return Vector{radius * std::sin(down) * std::cos(turn), radius * std::sin(down) * std::sin(turn),
                  radius * std::cos(down)};
  };
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      list.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      list.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return list;
}

// of a spring of stiffness 1
static Vector force(const std::vector<Triangle> &list, const Vector &x)
{
  Vector sum = {0, 0, 0};
  for (const SurfaceContact &c : contacts(list, x)) sum = moved(sum, std::max(c.overlap, 0.0), c.at.normal);
  return sum;
}

static double energy(const std::vector<Triangle> &list, const Vector &x)
{
  double sum = 0.0;
  for (const SurfaceContact &c : contacts(list, x)) sum += 0.5 * c.spring * c.spring;
  return sum;
}

// a step of height h along x = 0: its foot in the plane, its edge above
static std::vector<Triangle> kerb(double h)
{
  std::vector<Triangle> list;
  add_square(list, {-4, -4, 0}, {4, 0, 0}, {0, 8, 0});
  add_square(list, {0, -4, 0}, {0, 8, 0}, {0, 0, h});
  add_square(list, {0, -4, h}, {4, 0, 0}, {0, 8, 0});
  return list;
}

// a flat hexagon, and six faces that rise by an angle from its sides
static std::vector<Triangle> pit(double half_width, double angle)
{
  std::vector<Triangle> list;
  const double pi = std::acos(-1.0), out = half_width / std::cos(pi / 6), far = 4.0;
  auto at = [&](int k, double r, double z) {
    return Vector{r * std::cos(k * pi / 3), r * std::sin(k * pi / 3), z};
  };
  for (int k = 0; k < 6; k++) {
    const double up = (far - out) * std::cos(pi / 6) * std::tan(angle);
    const Vector a = at(k, out, 0), b = at(k + 1, out, 0), c = at(k + 1, far, up), d = at(k, far, up);
    list.push_back({{0, 0, 0}, a, b});
    list.push_back({a, b, c});
    list.push_back({a, c, d});
  }
  return list;
}

TEST(Choose, AConcaveEdgeHasAContactWithEachFace)
{
  for (const double degrees : {31.0, 45.0, 90.0}) {
    const double a = degrees * std::acos(-1.0) / 180.0;
    const double h = 0.999 * R;    // both overlap alike
    const auto found = contacts(kink(a), {-h * std::tan(0.5 * a), 0.3, h});
    ASSERT_EQ(found.size(), 2u) << degrees;
    EXPECT_NEAR(found[0].at.distance, h, 1e-9);
    EXPECT_NEAR(found[1].at.distance, h, 1e-9);
  }
}

// Its overlap is the way of the ball back to where it touches both faces, along the line of their middle.
TEST(Choose, AnEdgeOfUpTo30DegreesIsOneContact)
{
  for (const double degrees : {0.001, 0.2, 3.0, 16.0, 29.9})
    for (const double deep : {1e-4, 1e-2, 0.2}) {
      const double a = degrees * std::acos(-1.0) / 180.0, half = std::tan(0.5 * a);
      const double h = (1.0 - deep) * R;
      const auto found = contacts(kink(a), {-h * half, 0.3, h});
      ASSERT_EQ(found.size(), 1u) << degrees;
      EXPECT_NEAR(found[0].overlap, deep * R / std::cos(0.5 * a), 1e-9 * R) << degrees;
      EXPECT_NEAR(found[0].at.normal.x, -std::sin(0.5 * a), degrees > 0.1 ? 1e-6 : 1e-4) << degrees;
    }
}

TEST(Choose, AFineBowlIsOneContact)
{
  for (const double radius : {0.8, 2.0})    // the ball's is 0.5
    for (const double overlap : {0.01, 0.2}) {
      const double depth = radius - (1.0 - overlap) * R;
      const auto found = contacts(bowl(radius, 60), {depth * 0.3, 0.0, -depth * std::sqrt(1 - 0.09)});
      ASSERT_EQ(found.size(), 1u) << radius << " " << overlap;
      EXPECT_NEAR(found[0].overlap, overlap * R, 1e-3 * radius) << radius << " " << overlap;    // how flat a face is
    }
}

// n faces that rise from a point: a cone is one contact along its axis, however fine, or one with each face
TEST(Choose, AConeIsOneContactIfItsFacesTurnLittle)
{
  const double pi = std::acos(-1.0);
  for (const int n : {6, 16, 64, 300}) {
    std::vector<Triangle> list;
    auto at = [&](double k) { return Vector{2 * std::cos(2 * pi * k / n), 2 * std::sin(2 * pi * k / n), 2}; };
    for (int k = 0; k < n; k++) list.push_back({{0, 0, 0}, at(k), at(k + 1)});
    Vector up = list[0].twice_area();
    up = moved({0, 0, 0}, 1.0 / size_of(up), up);
    const auto found = contacts(list, {1e-5, 2e-5, 0.98 * R / std::fabs(up.z)});
    ASSERT_EQ(found.size(), n == 6 ? 6u : 1u) << n;
    if (n == 6) continue;
    EXPECT_NEAR(found[0].at.normal.z, 1.0, 1e-4) << n;
    EXPECT_NEAR(found[0].overlap, 0.02 * R / std::fabs(up.z), 1e-4 * R) << n;
  }
}

// a step of this height, or a gap of this width, across a plane: nothing beside the plane
TEST(Choose, ASeamThatIsNotWeldedIsNoContactOfItsOwn)
{
  for (const double step : {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3})
    for (const double gap : {0.0, 1e-9, 1e-3, 0.05}) {
      std::vector<Triangle> list;
      add_square(list, {-4, -4, 0}, {4 - gap * R, 0, 0}, {0, 8, 0});
      add_square(list, {0, -4, -step * R}, {4, 0, 0}, {0, 8, 0}, 3);    // and corners on an edge
      for (int k = -300; k <= 300; k++) {
        const auto found = contacts(list, {1e-3 * k * R, 0.3, 0.99 * R});
        ASSERT_EQ(found.size(), 1u) << step << " " << gap << " " << k;
        EXPECT_NEAR(found[0].overlap, 0.01 * R, (step + gap * gap) * R + 1e-12) << step << " " << gap << " " << k;
      }
    }
}

// The force has a potential: on a closed path it does no work, over concave edges and deep in them.
TEST(Choose, AClosedPathTakesNoWork)
{
  struct Case {
    std::vector<Triangle> list;
    Vector middle;
  };
  const double degree = std::acos(-1.0) / 180.0;
  const Case cases[] = {{kink(5 * degree), {-0.02, 0.3, 0.46}},  {kink(12 * degree), {-0.05, 0.3, 0.46}},
                        {kink(25 * degree), {-0.1, 0.3, 0.46}},  {kink(40 * degree), {-0.15, 0.3, 0.46}},
                        {bowl(2.0, 12), {0.5, 0.1, -1.41}},      {bowl(0.9, 12), {0.1, 0.1, -0.4}},
                      {pit(0.05, 8 * degree), {0, 0, 0.46}},   {kerb(0.01), {-0.1, 0.3, 0.46}}};
  for (const Case &c : cases) {
    const int n = 20000;
    const double pi = std::acos(-1.0), reach = 0.07;
    auto at = [&](int k) {
      const double turn = 2.0 * pi * k / n;
      return moved(c.middle, reach, {std::cos(turn), 0.3 * std::sin(2.0 * turn), std::sin(turn)});
    };
    double work = 0.0, least = 0.0, most = 0.0;
    for (int k = 0; k < n; k++) {
      const Vector f = force(c.list, moved(at(k), 0.5, minus(at(k + 1), at(k))));
      work += dot(f, minus(at(k + 1), at(k)));
      least = std::min(least, work);
      most = std::max(most, work);
    }
    EXPECT_GT(most - least, 1e-3);    // a path over hill and valley
    EXPECT_LT(std::fabs(work), 0.02 * (most - least)) << &c - cases;
  }
}

// The force is the gradient of the energy, whatever is touched: faces, sides and corners, one or many.
TEST(Choose, TheForceIsTheGradientOfTheEnergy)
{
  const double degree = std::acos(-1.0) / 180.0;
  std::vector<Triangle> ridge;    // a convex edge that rises out of a plane
  add_square(ridge, {-4, -4, 0}, {8, 0, 0}, {0, 8, 0});
  ridge.push_back({{-1, 0, 0}, {3, 0, 0.12}, {3, 0.1, -0.5}});
  ridge.push_back({{-1, 0, 0}, {3, -0.1, -0.5}, {3, 0, 0.12}});
  auto spike = [degree](double foot) {    // a corner that stands out of a plane
    std::vector<Triangle> list;
    add_square(list, {-4, -4, 0}, {8, 0, 0}, {0, 8, 0});
    auto at = [&](int k) {
      return Vector{foot * std::cos(120 * degree * k), foot * std::sin(120 * degree * k), 0};
    };
    for (int k = 0; k < 3; k++) list.push_back({{0, 0, 0.03}, at(k), at(k + 1)});
    return list;
  };
  struct Case {
    const char *name;
    std::vector<Triangle> list;
    Vector middle;
  };
  const Case cases[] = {{"kink 3", kink(3 * degree), {0, 0, 0.48}},
                        {"kink 12", kink(12 * degree), {-0.05, 0, 0.47}},
                        {"kink 60", kink(60 * degree), {-0.28, 0, 0.47}},
                        {"bowl", bowl(1.5, 12), {0.3, 0.2, -0.97}},
                        {"tight bowl", bowl(0.9, 12), {0.1, 0.1, -0.4}},
                        {"pit", pit(0.05, 8 * degree), {0, 0, 0.48}},
                        {"kerb", kerb(0.01), {-0.1, 0, 0.485}},
                        {"ridge", ridge, {0.5, 0.15, 0.485}},
                        {"spike", spike(0.3), {0.15, 0.05, 0.485}},
                        {"needle", spike(0.01), {0.15, 0.05, 0.48}}};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.05, 0.05);
  for (const Case &c : cases) {
    int touched = 0, off = 0;
    double sum = 0.0;
    for (int n = 0; n < 2000; n++) {
      const Vector x = {c.middle.x + any(random), c.middle.y + any(random), c.middle.z + any(random)};
      if (contacts(c.list, x).empty()) continue;
      const double step = 1e-6;
      auto slope = [&](const Vector &way) {
        return (energy(c.list, moved(x, step, way)) - energy(c.list, moved(x, -step, way))) / (2 * step);
      };
      const Vector f = force(c.list, x);
      const Vector wanted = {-slope({1, 0, 0}), -slope({0, 1, 0}), -slope({0, 0, 1})};
      const double error = size_of(minus(f, wanted)) / std::max(size_of(wanted), 1e-3 * R);
      touched++;
      off += error > 0.02;
      sum += error;
    }
    EXPECT_GT(touched, 500) << c.name;
    EXPECT_LT(sum, 0.01 * touched) << c.name;
    EXPECT_LT(off, 0.005 * touched) << c.name;    // where a contact comes within a step of the difference
  }
}

TEST(Choose, WhatIsHiddenBehindAFaceDoesNotCount)
{
  std::vector<Triangle> list = cube();
  add_square(list, {0, 0, 1.97}, {2, 0, 0}, {0, 2, 0});    // a plate in the cube, close below its top
  EXPECT_EQ(contacts(list, {1.0, 1.0, 2.2}).size(), 1u);
  list = cube();
  for (Triangle &t : cube()) list.push_back(t);    // everything twice
  EXPECT_EQ(contacts(list, {1.0, 1.0, 2.2}).size(), 1u);
}

TEST(Choose, AnOpenEdgeCounts)
{
  std::vector<Triangle> list;
  add_square(list, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 3);
  const auto found = contacts(list, {-0.3, 1.0, 0.0});
  ASSERT_EQ(found.size(), 1u);
  expect_vector(found[0].at.normal, -1, 0, 0);
}

// --- followed from step to step ---

struct Followed {
  TriangleMesh mesh;
  SurfaceWatch watch;
  explicit Followed(const std::vector<Triangle> &list) : mesh(list)
  {
    std::vector<int> all;
    for (int k = 0; k < mesh.count(); k++) all.push_back(k);
    watch.add_ball(42, all);
  }
  int touching(const Vector &x)
  {
    watch.find_features(0, x, R, 0.001, mesh);
    int n = 0;
    for (const SurfaceWatch::Slot &slot : watch.slots) n += slot.touches;
    return n;
  }
};

TEST(SurfaceWatch, AContactKeepsItsSlotFromFaceToFace)
{
  Followed f(cube(4));
  EXPECT_EQ(f.touching({1.0, 1.0, 2.6}), 0);
  for (int k = 0; k <= 1000; k++) EXPECT_EQ(f.touching({1.0 + 1e-3 * k, 1.0, 2.499}), 1) << k;
  const double pi = std::acos(-1.0);
  for (int k = 0; k <= 1000; k++) {    // around the edge
    const double a = 0.5 * pi * k / 1000;
    EXPECT_EQ(f.touching({2 + 0.499 * std::sin(a), 1.0, 2 + 0.499 * std::cos(a)}), 1);
  }
  EXPECT_EQ(f.touching({2.499, 1.0, 1.0}), 1);
  EXPECT_EQ(f.watch.slots.size(), 1u);
  EXPECT_EQ(f.watch.number_of(0), 42);
}

TEST(SurfaceWatch, APhantomTouchesTheBallWhereTheSurfaceDoes)
{
  Followed f(cube());
  f.touching({2.2, 1.0, 2.3});
  ASSERT_EQ(f.watch.slots.size(), 1u);
  const SurfaceWatch::Slot &slot = f.watch.slots[0];
  const Vector way = minus(Vector{2.2, 1.0, 2.3}, slot.centre);
  EXPECT_NEAR(2 * R - size_of(way), R - std::sqrt(0.13), 1e-12);
  expect_vector(slot.contact.at.normal, way.x / size_of(way), 0, way.z / size_of(way));
}

TEST(SurfaceWatch, ASecondContactGetsASlotAndItIsUsedAgain)
{
  Followed f(cube());
  EXPECT_EQ(f.touching({1.0, 1.0, 0.49}), 1);
  EXPECT_EQ(f.touching({1.51, 1.0, 0.49}), 2);    // from inside, floor and wall
  EXPECT_EQ(f.watch.slots[1].contact.at.normal.x, -1.0);
  EXPECT_EQ(f.touching({1.49, 1.0, 0.49}), 1);
  EXPECT_LT(f.watch.slots[1].centre.x, 1e9);    // left in this step: its place is known
  EXPECT_NEAR(f.watch.slots[1].contact.at.distance, 0.51, 1e-12);
  EXPECT_EQ(f.touching({1.49, 1.0, 0.49}), 1);
  EXPECT_GT(f.watch.slots[1].centre.x, 1e9);
  EXPECT_EQ(f.touching({0.49, 1.0, 0.49}), 2);
  EXPECT_EQ(f.watch.slots.size(), 2u);
  EXPECT_EQ(f.watch.slots[1].contact.at.normal.x, 1.0);
}

TEST(SurfaceWatch, AStoredContactIsFoundByItsNormal)
{
  Followed f(cube());
  f.watch.add_slot(0, {-1, 0, 0});
  f.watch.add_slot(0, {0, 0, 1});
  EXPECT_EQ(f.touching({1.51, 1.0, 0.49}), 2);
  EXPECT_EQ(f.watch.slots.size(), 2u);
  EXPECT_EQ(f.watch.slots[0].contact.at.normal.x, -1.0);
  EXPECT_EQ(f.watch.slots[1].contact.at.normal.z, 1.0);
}

TEST(SurfaceWatch, FarJumpsAndSmallStepsFindTheSame)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-0.6, 2.6), small(-0.004, 0.004);
  Followed f(cube(6));
  Vector x = {1, 1, 2.4};
  int touched = 0;
  for (int k = 0; k < 20000; k++) {
    if (k % 50 == 0) x = {any(random), any(random), any(random)};
    x = {x.x + small(random), x.y + small(random), x.z + small(random)};
    const int n = f.touching(x);
    EXPECT_EQ(n, static_cast<int>(contacts(cube(6), x).size()));
    touched += n > 0;
  }
  EXPECT_GT(touched, 5000);
}

// --- what is near ---

TEST(TriangleMesh, FindsAllThatIsNear)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-10.0, 10.0), small(-0.5, 0.5);
  std::vector<Triangle> list;
  for (int k = 0; k < 3000; k++) {
    const Vector a = {any(random), any(random), any(random)};
    auto beside = [&]() { return Vector{a.x + small(random), a.y + small(random), a.z + small(random)}; };
    list.push_back({a, beside(), beside()});
  }
  const TriangleMesh mesh(list);
  size_t handed = 0, near = 0;
  for (int k = 0; k < 300; k++) {
    const Vector x = {any(random), any(random), any(random)};
    std::vector<int> found;
    mesh.find_near(x, 0.8, found);
    const std::set<int> set(found.begin(), found.end());
    EXPECT_EQ(set.size(), found.size());
    handed += found.size();
    for (int m = 0; m < mesh.count(); m++)
      if (nearest_point(list[m], m, x).distance < 0.8) {
        near++;
        EXPECT_TRUE(set.count(m));
      }
  }
  EXPECT_GT(near, 300u);
  EXPECT_LT(handed, 300u * 60);
}

TEST(TriangleMesh, ManyEqualMiddlesEnd)
{
  const TriangleMesh mesh(std::vector<Triangle>(1000, Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  std::vector<int> found;
  mesh.find_near({0, 0, 0}, 0.1, found);
  EXPECT_EQ(found.size(), 1000u);
}

TEST(TriangleMesh, AnotherMeshHasAnotherSum)
{
  std::vector<Triangle> a = cube(), b = cube();
  std::swap(b[0], b[1]);
  EXPECT_NE(TriangleMesh(a).checksum(), TriangleMesh(b).checksum());
}

// --- terrain ---

TEST(TerrainSurface, IsTheGridsPlaneUpToTheRim)
{
  ElevationGrid grid(5, 4, 10.0, 20.0, 2.0, 0.0);
  for (int j = 0; j < grid.ny; j++)
    for (int i = 0; i < grid.nx; i++) grid.at(i, j) = 0.3 * (11.0 + 2.0 * i) - 0.2 * (21.0 + 2.0 * j) + 5.0;
  const TerrainSurface ground(grid, "g");
  double area = 0.0;
  for (int k = 0; k < ground.count(); k++) {
    const Triangle t = ground.triangle(k);
    for (const Vector *c : {&t.a, &t.b, &t.c}) EXPECT_NEAR(c->z, 0.3 * c->x - 0.2 * c->y + 5.0, 1e-12);
    EXPECT_GT(t.twice_area().z, 0.0);
    area += 0.5 * t.twice_area().z;
  }
  EXPECT_NEAR(area, 80.0, 1e-9);    // all of the raster, once
  expect_vector(ground.low(), 10, 20, 0.3 * 10 - 0.2 * 28 + 5.0);
  expect_vector(ground.high(), 20, 28, 0.3 * 20 - 0.2 * 20 + 5.0);
}

TEST(TerrainSurface, FindsAllThatIsNear)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-2.0, 22.0), height(0.0, 3.0);
  ElevationGrid grid(20, 20, 0.0, 0.0, 1.0, 0.0);
  for (double &z : grid.z) z = height(random);
  grid.at(7, 9) = NAN;
  const TerrainSurface ground(grid, "g");
  EXPECT_EQ(ground.about().missing, 4);
  size_t near = 0;
  for (int k = 0; k < 300; k++) {
    const Vector x = {any(random), any(random), 2.0 * height(random)};
    std::vector<int> found;
    ground.find_near(x, 1.3, found);
    const std::set<int> set(found.begin(), found.end());
    for (const int m : found) EXPECT_TRUE(std::isfinite(ground.triangle(m).area()));
    for (int m = 0; m < ground.count(); m++) {
      const Triangle t = ground.triangle(m);
      if (!std::isfinite(t.area() + ground.triangle(m ^ 1).area()) || !(nearest_point(t, m, x).distance < 1.3)) continue;
      near++;
      EXPECT_TRUE(set.count(m)) << m;
    }
  }
  EXPECT_GT(near, 1000u);
}

TEST(TerrainSurface, IsTheSameWithHeightsThatAreElsewhere)
{
  ElevationGrid grid(9, 7, 0.0, 0.0, 1.0, 0.0);
  for (size_t k = 0; k < grid.z.size(); k++) grid.z[k] = std::sin(3.0 * k);
  const TerrainSurface ground(grid, "g");
  const std::vector<double> heights(ground.heights(), ground.heights() + 11 * 9);
  const TerrainSurface other(ground.about(), heights.data());
  ASSERT_EQ(other.count(), ground.count());
  EXPECT_EQ(other.checksum(), ground.checksum());
  EXPECT_EQ(other.memory_usage(), 0.0);
  EXPECT_EQ(other.high().z, ground.high().z);
  for (int k = 0; k < ground.count(); k++) {
    EXPECT_EQ(other.triangle(k).a.z, ground.triangle(k).a.z);
    EXPECT_EQ(other.triangle(k).c.x, ground.triangle(k).c.x);
  }
}

TEST(TerrainSurface, NeedsAQuadrangle)
{
  ElevationGrid grid(3, 3, 0.0, 0.0, 1.0, NAN);
  EXPECT_THROW(TerrainSurface(grid, "g"), std::runtime_error);
  EXPECT_EQ(TerrainSurface(ElevationGrid(1, 1, 0.0, 0.0, 1.0, 2.0), "g").count(), 8);
}

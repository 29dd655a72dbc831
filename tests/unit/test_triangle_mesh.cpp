/* What is closed, and what is inside. */

#include "triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

using namespace Slope;

typedef std::vector<Triangle> Triangles;

// f of each corner of an octahedron whose faces are n^2 triangles
template <typename Place> static Triangles star(int n, Place f)
{
  Triangles list;
  for (int k = 0; k < 8; k++) {
    auto at = [&](int i, int j) {
      const double x = i, y = j, z = n - i - j;
      return f(Vector{k & 1 ? x : -x, k & 2 ? y : -y, k & 4 ? z : -z});
    };
    for (int i = 0; i < n; i++)
      for (int j = 0; i + j < n; j++) {
        list.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j < n - 1) list.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  return list;
}

static Triangles octahedron(double size)    // |x| + |y| + |z| = size
{
  return star(5, [size](const Vector &v) { return Vector{0.2 * size * v.x, 0.2 * size * v.y, 0.2 * size * v.z}; });
}

static Triangles sphere()
{
  return star(12, [](const Vector &v) {
    const double r = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return Vector{v.x / r, v.y / r, v.z / r};
  });
}

TEST(TriangleMesh, IsClosedWhereEachEdgeIsOfTwo)
{
  const Triangles whole = octahedron(5.0);
  EXPECT_TRUE(TriangleMesh(whole).closed());
  EXPECT_TRUE(TriangleMesh(sphere()).closed());
  Triangles list = whole;
  list.pop_back();
  EXPECT_FALSE(TriangleMesh(list).closed());
  list.push_back(list[0]);    // an even number of edges
  EXPECT_FALSE(TriangleMesh(list).closed());
  list = whole;
  list.insert(list.end(), whole.begin(), whole.end());    // each edge of four
  EXPECT_FALSE(TriangleMesh(list).closed());
  EXPECT_FALSE(TriangleMesh({whole[0]}).closed());
}

TEST(TriangleMesh, EnclosesWhatIsInside)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.2, 1.2);
  const TriangleMesh mesh(sphere());
  int inside = 0;
  for (int k = 0; k < 20000; k++) {
    const Vector x = {any(random), any(random), any(random)};
    const double r = std::sqrt(x.x * x.x + x.y * x.y + x.z * x.z);
    if (r > 0.97 && r < 1.0) continue;    // between the sphere and its triangles
    EXPECT_EQ(mesh.encloses(x), r < 1.0) << x.x << " " << x.y << " " << x.z;
    inside += r < 1.0;
  }
  EXPECT_GT(inside, 4000);
}

TEST(TriangleMesh, EnclosesBelowEdgesAndCorners)
{
  const TriangleMesh mesh(octahedron(5.0));    // corners at whole numbers
  for (int i = -12; i <= 12; i++)
    for (int j = -12; j <= 12; j++)
      for (int k = -12; k <= 12; k++) {
        const Vector x = {0.5 * i, 0.5 * j, 0.5 * k};
        const int far = std::abs(i) + std::abs(j) + std::abs(k);
        if (far != 10) EXPECT_EQ(mesh.encloses(x), far < 10) << x.x << " " << x.y << " " << x.z;
      }
}

TEST(TriangleMesh, ShellEnclosesWhatIsInItsWall)
{
  Triangles shell = octahedron(5.0);
  const Triangles inner = octahedron(2.0);
  shell.insert(shell.end(), inner.begin(), inner.end());
  const TriangleMesh mesh(shell);
  EXPECT_TRUE(mesh.closed());
  EXPECT_TRUE(mesh.encloses({3.0, 0.1, 0.2}));
  EXPECT_FALSE(mesh.encloses({1.0, 0.1, 0.2}));
  EXPECT_FALSE(mesh.encloses({9.0, 0.1, 0.2}));
}

/* The shortest way out of faces: it leaves all of them, and there is no shorter one. */

#include "way_out.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

using namespace Slope;

static Vector unit(const Vector &v)
{
  return moved({0, 0, 0}, 1.0 / size_of(v), v);
}

static double largest_left(const std::vector<OverlappedFace> &faces, const Vector &u)
{
  double most = -HUGE_VAL;
  for (const OverlappedFace &f : faces) most = std::max(most, f.depth - dot(u, f.normal));
  return most;
}

// Hildreth's method: by one face at a time, with what it pushed before taken back
static Vector by_rounds(const std::vector<OverlappedFace> &faces)
{
  std::vector<double> push(faces.size(), 0.0);
  Vector u = {0, 0, 0};
  for (int round = 0; round < 20000; round++)
    for (size_t k = 0; k < faces.size(); k++) {
      const double to = std::max(0.0, push[k] + faces[k].depth - dot(u, faces[k].normal));
      u = moved(u, to - push[k], faces[k].normal);
      push[k] = to;
    }
  return u;
}

TEST(WayOut, LeavesOneFaceAlongItsNormal)
{
  const Vector u = WayOut::of({{{0, 0.6, 0.8}, 0.1}}, 0.5);
  EXPECT_DOUBLE_EQ(u.x, 0.0);
  EXPECT_DOUBLE_EQ(u.y, 0.06);
  EXPECT_DOUBLE_EQ(u.z, 0.08);
}

TEST(WayOut, IsTheProjectionOnWhereNoFaceIsOverlapped)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int many = 0;
  for (int trial = 0; trial < 400; trial++) {
    std::vector<OverlappedFace> faces;
    const double spread = std::pow(10.0, -1.0 + 1.1 * any(random));
    for (int k = 0; k <= trial % 12; k++)
      faces.push_back({unit({spread * any(random), spread * any(random), 1.0}), 0.01 + 0.01 * spread * any(random)});
    const Vector u = WayOut::of(faces, 1.0), v = by_rounds(faces);
    EXPECT_LT(largest_left(faces, u), 1e-9) << trial;
    EXPECT_NEAR(size_of(u), size_of(v), 1e-4 * size_of(v)) << trial;
    double deepest = 0.0;
    for (const OverlappedFace &f : faces) deepest = std::max(deepest, f.depth);
    many += size_of(u) > 1.0001 * deepest;
  }
  EXPECT_GT(many, 50);    // more than one face decides
}

TEST(WayOut, OfFacesThatAlmostAreOneIsNoLonger)
{
  for (const double turn : {1e-3, 1e-6, 1e-9, 1e-12, 0.0})
    for (const double more : {0.0, 1e-16, 1e-13, 1e-10}) {
      const std::vector<OverlappedFace> faces = {{{0, 0, 1}, 0.01},
                                                 {unit({turn, 0, 1}), 0.01 + more},
                                                 {unit({0, turn, 1}), 0.01},
                                                 {unit({-turn, turn, 1}), 0.01 + more}};
      const Vector u = WayOut::of(faces, 0.5);
      EXPECT_NEAR(size_of(u), 0.01, 0.01 * turn * turn + 1e-9) << turn << " " << more;
    }
}

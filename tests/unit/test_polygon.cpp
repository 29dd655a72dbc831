/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Polygons: what is inside by the even-odd rule, against a plain loop over all edges, shared edges
// that belong to one side, areas, and bad files as one clear line.

#include "polygon.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <stdexcept>

using Slope::Polygon;

class PolygonFile : public testing::Test {
 protected:
  std::string path;

  void SetUp() override
  {
    char name[] = "/tmp/test_polygon.XXXXXX";
    const int fd = mkstemp(name);
    ASSERT_GE(fd, 0);
    close(fd);
    path = name;
  }

  void TearDown() override { remove(path.c_str()); }

  Polygon read(const std::string &text) const
  {
    std::ofstream(path) << text;
    return Polygon::read(path);
  }

  // the one line of the error, with a short name of the file
  std::string error(const std::string &text) const
  {
    try {
      read(text);
    } catch (std::runtime_error &e) {
      const std::string line = e.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      const size_t at = line.find(path);
      EXPECT_NE(at, std::string::npos) << line;
      return line.substr(0, at) + "p.csv" + line.substr(at + path.size());
    }
    return "no error";
  }
};

static const char *SQUARE = "0,0\n10,0\n10,10\n0,10\n";

// number of rings around a point, edge by edge in any order: nothing shared with the class
static bool plain_inside(const Polygon &p, double x, double y)
{
  bool odd = false;
  size_t start = 0;
  for (const int n : p.sizes) {
    for (int k = 0; k < n; k++) {
      const double *a = &p.xy[2 * (start + k)], *b = &p.xy[2 * (start + (k + 1) % n)];
      if ((a[1] > y) != (b[1] > y) && x - a[0] < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]))
        odd = !odd;
    }
    start += n;
  }
  return odd;
}

/* ---- reading ---- */

TEST_F(PolygonFile, RingsCommentsAndRepeatedPoints)
{
  const Polygon p = read("# a road\r\n\r\n# still none\n 0 , 0 # corner\r\n0,0\n10,0\n# inside\n"
                         "10,0\n10,10\n0,10\n0,0\n\n\n2,2\n4,2\n4,4");
  EXPECT_EQ(p.sizes, (std::vector<int>{4, 3}));
}

TEST_F(PolygonFile, ARingOfOnePointIsAnError)
{
  EXPECT_EQ(error("0,0\n\n0,0\n10,0\n10,10\n"),
            "p.csv, line 1: a ring must have at least 3 points, got 1");
}

TEST_F(PolygonFile, BadFiles)
{
  const std::string s = SQUARE;
  EXPECT_EQ(error(""), "p.csv: must hold a ring of points x,y, it has none");
  EXPECT_EQ(error("# nothing\n\n"), "p.csv: must hold a ring of points x,y, it has none");
  EXPECT_EQ(error("0,0\n1,1\n"), "p.csv, line 1: a ring must have at least 3 points, got 2");
  EXPECT_EQ(error(s + "\n0,0\n1,1\n0,0\n"),
            "p.csv, line 6: a ring must have at least 3 points, got 2");
  EXPECT_EQ(error("x,y\n0,0\n"), "p.csv, line 1: must be 2 numbers, x,y, got x,y");
  EXPECT_EQ(error("# y,x\n0,0\n1,0\n0,1\n"), "p.csv, line 1: columns must be x,y in m, got y,x");
  EXPECT_EQ(error("1,2,3\n"), "p.csv, line 1: must be 2 numbers, x,y, got 1,2,3");
  EXPECT_EQ(error("0,0\n1e13,1\n"),
            "p.csv, line 2: x and y must be within +-1e+12, got 1e+13,1");
  EXPECT_EQ(error("\x89PNG\r\n"), "p.csv, line 1: must be 2 numbers, x,y, got ?PNG");
  EXPECT_EQ(error("0,0\n1,1\n3,3\n2,2\n"),
            "p.csv, line 1: a ring must have an area > 0, its points are on a line");
  EXPECT_EQ(error("0.1,0.1\n0.2,0.2\n0.7,0.7\n"),
            "p.csv, line 1: a ring must have an area > 0, its points are on a line");
  EXPECT_EQ(error(s + "\n" + s),
            "p.csv: must have an area > 0, got 0, rings cancel each other");
}

TEST_F(PolygonFile, MissingFile)
{
  try {
    Polygon::read(path + ".none");
    FAIL();
  } catch (std::runtime_error &e) {
    EXPECT_EQ(e.what(), "cannot read " + path + ".none: No such file or directory");
  }
  EXPECT_THROW(Polygon::read("/tmp"), std::runtime_error);
}

TEST_F(PolygonFile, CrossingsAreNamed)
{
  const std::string meets = " line 2: a ring must not cross or touch itself, the edges from lines ";
  // a bow tie
  EXPECT_EQ(error("#\n0,0\n10,10\n10,0\n0,10\n"), "p.csv," + meets + "2 and 4 meet at 5,5");
  // a vertex on an edge, and two vertices at one place
  EXPECT_EQ(error("#\n0,0\n10,0\n10,10\n5,0\n0,10\n"), "p.csv," + meets + "2 and 4 meet at 5,0");
  EXPECT_NE(error("0,0\n5,5\n10,0\n10,10\n5,5\n0,10\n").find(" meet at 5,5"), std::string::npos);
  // back along an edge: from a vertex, and between others
  EXPECT_NE(error("0,0\n10,0\n6,0\n6,8\n").find(" lines 1 and 2 meet at "), std::string::npos);
  EXPECT_NE(error("0,0\n10,0\n10,5\n20,5\n10,5\n10,10\n0,10\n").find(" meet at "),
            std::string::npos);
  // two rings
  EXPECT_EQ(error(std::string(SQUARE) + "\n5,5\n15,5\n15,7\n"),
            "p.csv, line 2: rings must not cross, the edges from lines 2 and 6 do at 10,5");
}

TEST_F(PolygonFile, RingsMayTouch)
{
  const std::string s = SQUARE;
  EXPECT_EQ(read(s + "\n10,0\n20,0\n20,10\n10,10\n").area(), 200.0);     // share an edge
  EXPECT_EQ(read(s + "\n10,3\n20,3\n20,4\n10,4\n").area(), 110.0);    // a part of an edge
  EXPECT_EQ(read(s + "\n10,10\n20,10\n20,20\n10,20\n").area(), 200.0);   // share a point
  EXPECT_EQ(read(s + "\n0,0\n5,0\n5,5\n0,5\n").area(), 75.0);    // a hole at the edge
  EXPECT_EQ(read(s + "\n0,0\n10,0\n10,5\n0,5\n\n0,5\n10,5\n10,10\n0,10\n\n20,0\n21,0\n21,1\n").area(),
            0.5);
  // rings that cross each other in the points 0,1 and 4,1, and share an edge
  EXPECT_NEAR(read("0,0\n4,1\n4,5\n2,1\n0,4\n\n4,1\n4,5\n0,4\n0,1\n").area(), 9.0, 1e-14);
}

// slivers thinner than rounding: what exact arithmetic takes for valid is valid here, too
TEST_F(PolygonFile, NearlyTouchingIsNotTouching)
{
  const double thin = std::nextafter(0.1, 1.0), line = 0.1 * 3.0;    // 0.30000000000000004
  char text[400];
  snprintf(text, sizeof(text), "0,0\n100,0\n100,10\n0.3,0.1\n0,10\n\n0.1,0.1\n%.17g,0.1\n0.1,0.2\n",
           thin);
  EXPECT_NO_THROW(read(text));
  // a vertex within 1e-17 of the line from 0,0 to 0.9,0.3, on either side of it
  snprintf(text, sizeof(text), "0,0\n0.9,0.3\n5,5\n%.17g,0.1\n-5,5\n", 0.29999999999999993);
  EXPECT_NO_THROW(read(text));
  snprintf(text, sizeof(text), "0,0\n0.9,0.3\n5,5\n%.17g,0.1\n-5,5\n", line);
  EXPECT_NE(error(text).find("lines 1 and 3 meet at 0.3,0.1"), std::string::npos) << error(text);
}

/* ---- inside ---- */

TEST_F(PolygonFile, AnEdgeBelongsToItsEastAndNorth)
{
  const Polygon p = read(SQUARE);
  int count = 0;
  for (int i = -1; i <= 11; i++)
    for (int j = -1; j <= 11; j++) {
      EXPECT_EQ(p.inside(i, j), i >= 0 && i < 10 && j >= 0 && j < 10) << i << " " << j;
      count += p.inside(i, j);
    }
  EXPECT_EQ(count, 100);    // as many as the area
  const Polygon west = read("0,0\n10,10\n0,10\n"), east = read("10,10\n0,0\n10,0\n");
  for (int i = 0; i < 10; i++) {
    EXPECT_FALSE(west.inside(i, i)) << i;
    EXPECT_TRUE(east.inside(i, i)) << i;
  }
  EXPECT_FALSE(p.inside(std::nan(""), 5.0));
  EXPECT_FALSE(p.inside(5.0, std::nan("")));
  EXPECT_FALSE(p.inside(INFINITY, 5.0));
  EXPECT_FALSE(Polygon().inside(0.0, 0.0));
}

TEST_F(PolygonFile, HolesAndIslands)
{
  const Polygon p = read(std::string(SQUARE) + "\n8,8\n2,8\n2,2\n8,2\n\n4,4\n6,4\n6,6\n4,6\n");
  EXPECT_TRUE(p.inside(1, 5));
  EXPECT_FALSE(p.inside(3, 5));
  EXPECT_TRUE(p.inside(5, 5));
  EXPECT_FALSE(p.inside(7, 3));
  EXPECT_TRUE(p.inside(9, 9));
  EXPECT_EQ(p.area(), 100.0 - 36.0 + 4.0);
}

// a fan of triangles that share slanted edges, given in both directions: each point of the square
// is in one of them
TEST_F(PolygonFile, SharedEdgesPartThePlane)
{
  const double cx = 3.3, cy = 4.7, corner[4][2] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  std::vector<Polygon> parts;
  for (int k = 0; k < 4; k++) {
    const double *a = corner[k], *b = corner[(k + 1) % 4];
    parts.push_back(Polygon(k % 2 ? std::vector<double>{cx, cy, a[0], a[1], b[0], b[1]} :
                                    std::vector<double>{b[0], b[1], a[0], a[1], cx, cy}, {3}));
  }
  for (int i = 0; i < 1000; i++) {    // on the diagonals, as near as rounding allows
    const double f = i / 1000.0;
    for (const auto &c : corner) {
      const double x = cx + f * (c[0] - cx), y = cy + f * (c[1] - cy);
      int count = 0;
      for (const Polygon &p : parts) count += p.inside(x, y);
      ASSERT_EQ(count, 1) << x << " " << y;
    }
  }
}

// edges that meet on the border of two strips, here at y = 5 of 10 strips: in the strip, one of them
// reaches both farther west and farther east than the other if it is made a little longer
TEST_F(PolygonFile, TipsOnTheBordersOfStrips)
{
  for (const double sign : {1.0, -1.0})
    for (const double up : {1.0, -1.0}) {
      std::vector<double> xy = {5, 0, 9, 0, 0, 5};
      for (int k = 0; k < 4; k++) xy.insert(xy.end(), {20.0 + k, k % 2 ? 10.0 : 8.0});
      for (int k = 3; k >= 0; k--) xy.insert(xy.end(), {20.0 + k, k % 2 ? 9.0 : 7.0});
      for (size_t k = 0; k < xy.size(); k += 2) {
        xy[k] *= sign;
        xy[k + 1] *= up;
      }
      const Polygon p(xy, {3, 8});    // 10 edges that are not along x
      for (double x = -30.0; x < 30.0; x += 0.0625)
        for (double y = -9.96875; y < 10.0; y += 0.0625)
          ASSERT_EQ(p.inside(x, y), plain_inside(p, x, y)) << x << " " << y;
    }
}

// stars, combs and roads of many vertices, with points at random and at vertices' heights
TEST_F(PolygonFile, AgreesWithThePlainLoop)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const int kind : {0, 1, 2, 3, 4, 5}) {
    const int n = 1000;
    const double far = kind < 3 ? 0.0 : 4.1e9;    // there, coordinates have digits of 0.5e-6
    std::vector<double> xy;
    for (int k = 0; k < n; k++) {
      if (kind % 3 == 0) {    // star
        const double r = 50.0 + 30.0 * uniform(random), a = 2.0 * M_PI * k / n;
        xy.insert(xy.end(), {r * std::cos(a), r * std::sin(a)});
      } else if (kind % 3 == 1) {    // comb, upright
        xy.insert(xy.end(), {k / 10.0, k == 0 || k == n - 1 ? 0.0 : k % 2 ? 90.0 : 10.0});
      } else {    // winding road
        const int half = n / 2, i = k < half ? k : n - 1 - k;
        const double side = k < half ? -0.1 : 0.1;
        xy.insert(xy.end(), {0.1 * i, 20.0 * std::sin(0.02 * i) + side});
      }
    }
    for (double &value : xy) value += far;
    const Polygon p(xy, {n});
    int inside = 0;
    for (int k = 0; k < 20000; k++) {
      const double x = p.xlo + (p.xhi - p.xlo) * uniform(random);
      const double y = k % 4 ? p.ylo + (p.yhi - p.ylo) * uniform(random) : xy[(2 * k + 1) % (2 * n)];
      ASSERT_EQ(p.inside(x, y), plain_inside(p, x, y)) << kind << " " << x << " " << y;
      inside += p.inside(x, y);
    }
    EXPECT_GT(inside, 50);
    double doubled = 0.0;
    for (int k = 0; k < n; k++) {
      const double *a = &xy[2 * k], *b = &xy[2 * ((k + 1) % n)];
      doubled += (a[0] - far) * (b[1] - far) - (b[0] - far) * (a[1] - far);
    }
    EXPECT_NEAR(p.area(), 0.5 * std::fabs(doubled), 1e-7 * p.area()) << kind;
  }
}

// ten thousand vertices: the times are printed, not asserted
TEST_F(PolygonFile, Large)
{
  auto now = [] { return std::chrono::steady_clock::now(); };
  auto since = [&](std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(now() - t).count();
  };
  const int n = 10000;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const std::string kind : {"circle", "star", "comb"}) {
    std::string text;
    for (int k = 0; k < n; k++) {
      char line[80];
      const double a = 2.0 * M_PI * k / n;
      const double r = kind == "circle" ? 100.0 : 20.0 + 80.0 * uniform(random);
      if (kind == "comb")
        snprintf(line, sizeof(line), "%.17g,%.17g\n", 0.01 * k,
                 k == 0 || k == n - 1 ? 0.0 : k % 2 ? 90.0 : 10.0);
      else
        snprintf(line, sizeof(line), "%.17g,%.17g\n", r * std::cos(a), r * std::sin(a));
      text += line;
    }
    auto start = now();
    const Polygon p = read(text);
    const double reading = since(start);
    std::vector<double> at(400000);
    for (size_t k = 0; k < at.size(); k += 2) {
      at[k] = p.xlo + (p.xhi - p.xlo) * uniform(random);
      at[k + 1] = p.ylo + (p.yhi - p.ylo) * uniform(random);
    }
    start = now();
    int inside = 0;
    for (size_t k = 0; k < at.size(); k += 2) inside += p.inside(at[k], at[k + 1]);
    printf("%s of %d vertices: read and checked in %.3f s, 200000 points in %.3f s\n", kind.c_str(),
           n, reading, since(start));
    const double share = p.area() / ((p.xhi - p.xlo) * (p.yhi - p.ylo));
    EXPECT_NEAR(inside / 200000.0, share, 0.01);
  }
}

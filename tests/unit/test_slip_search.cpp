/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The search finds nothing worse than a plain lattice of its own does, keeps to its limits, and its files hold what it found. */

#include "embankment.h"
#include "slip_body.h"
#include "slip_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

using namespace Slope;
using namespace embankment;

namespace {

constexpr int CELLS = 40;
constexpr double CELL = 3.0;

// 40 x 40 cells of 3 m, higher than the edges in the middle
ElevationGrid hill()
{
  ElevationGrid grid(CELLS, CELLS, 0.0, 0.0, CELL, 0.0);
  for (int j = 0; j < CELLS; j++)
    for (int i = 0; i < CELLS; i++) {
      const double x = CELL * i - 52.0, y = CELL * j - 66.0;
      grid.at(i, j) = 40.0 * std::exp(-(x * x / 800.0 + y * y / 1500.0)) + 0.03 * i;
    }
  return grid;
}

// a slope down to the south-west with a spur and a gully
ElevationGrid valley()
{
  ElevationGrid grid(CELLS, CELLS, 0.0, 0.0, CELL, 0.0);
  for (int j = 0; j < CELLS; j++)
    for (int i = 0; i < CELLS; i++) {
      const double across = 1.2 * i - 0.9 * j, along = 0.9 * i + 1.2 * j;
      grid.at(i, j) = 12.0 + 18.0 * std::tanh((along - 40.0) / 14.0) + 3.0 * std::sin(across / 6.0);
    }
  return grid;
}

struct Case {
  ElevationGrid ground;
  SlipSoil soil = SlipSoil(strength(8.0, 25.0, 18.0));
  std::vector<char> allowed;
  SlipTask task;
  SlipBodyMaker maker;
  SlipLimits limits;
  std::vector<std::string> stages;

  explicit Case(const ElevationGrid &_ground) : ground(_ground), maker(ground, soil, allowed, task)
  {
    limits.volume_lo = 1500.0;
    limits.volume_hi = 10000.0;
  }

  bool within(const SlipBody &b) const
  {
    return b.volume >= limits.volume_lo && b.volume <= limits.volume_hi &&
        b.depth >= limits.depth_lo && b.depth <= limits.depth_hi;
  }

  SlipSearch search()
  {
    const SlipRanks alone = {0, 1,
                             [](double *, size_t) {
                             },
                             [this](const char *stage, double share) {
                               EXPECT_TRUE(share >= 0.0 && share <= 1.0);
                               if (share == 0.0) stages.push_back(stage);
                             }};
    return SlipSearch(ground, limits, alone, maker);
  }

  // the least exact factor among the best of a plain lattice, which knows nothing of the search
  double brute_force()
  {
    struct Tried {
      double factor;
      SlipSurface surface;
    };
    std::vector<Tried> all;
    SlipBody body;
    for (double x = 3.0; x < 120.0; x += 6.0)
      for (double y = 3.0; y < 120.0; y += 6.0)
        for (double up = 15.0; up < 90.0; up *= 1.35)
          for (double r = 0.7 * up; r < 1.5 * up; r += 2.0) {
            const double z = ground.at(static_cast<int>(x / CELL), static_cast<int>(y / CELL)) + up;
            if (maker.coarse({x, y, z, r}, 1, body, 1e-4) && within(body))
              all.push_back({body.factor, body.surface});
          }
    EXPECT_GT(all.size(), 500u);
    std::sort(all.begin(), all.end(), [](const Tried &a, const Tried &b) {
      return a.factor < b.factor;
    });
    double least = HUGE_VAL;
    for (size_t k = 0; k < std::min<size_t>(all.size(), 30); k++)
      if (maker.exact(all[k].surface, body).empty() && within(body))
        least = std::min(least, body.factor);
    return least;
  }
};

std::string text_of(const std::string &path)
{
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

}    // namespace

TEST(SlipSearch, NotAboveAPlainLattice)
{
  for (const ElevationGrid &ground : {hill(), valley()}) {
    Case c(ground);
    const double plain = c.brute_force();
    const std::vector<SlipBody> found = c.search().run();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT(plain, 3.0);
    EXPECT_LE(found[0].factor, plain);
    EXPECT_GT(found[0].factor, 0.8 * plain);
    EXPECT_TRUE(c.within(found[0]));
  }
}

TEST(SlipSearch, EllipsoidsAreNotAboveSpheres)
{
  double gain = 1.0;
  for (const ElevationGrid &ground : {hill(), valley()}) {
    Case c(ground);
    const double sphere = c.search().run().front().factor;
    c.limits.ellipsoids = true;
    const SlipBody wide = c.search().run().front();
    EXPECT_LE(wide.factor, sphere);
    gain = std::min(gain, wide.factor / sphere);
    EXPECT_LE(wide.surface.across, double(SlipSearch::WIDEST));
    EXPECT_GE(wide.surface.across * SlipSearch::WIDEST, 1.0);
    EXPECT_TRUE(c.within(wide));
    EXPECT_EQ(c.stages.back(), "ellipsoids");
  }
  EXPECT_LT(gain, 0.999);    // on one of them at least
}

TEST(SlipSearch, KeepsBodiesThatDifferInOrder)
{
  Case c(valley());
  c.limits.keep = 4;
  const std::vector<SlipBody> found = c.search().run();
  ASSERT_GE(found.size(), 2u);    // one on each flank
  std::vector<ElevationGrid> bases;
  for (const SlipBody &body : found) {
    EXPECT_TRUE(c.within(body));
    bases.push_back(c.maker.base(body.surface));
  }
  for (size_t a = 0; a < found.size(); a++)
    for (size_t b = 0; b < a; b++) {
      EXPECT_LE(found[b].factor, found[a].factor);
      double common = 0.0, of_a = 0.0, of_b = 0.0;
      for (size_t k = 0; k < bases[a].z.size(); k++) {
        const bool in_a = !std::isnan(bases[a].z[k]), in_b = !std::isnan(bases[b].z[k]);
        common += in_a && in_b;
        of_a += in_a;
        of_b += in_b;
      }
      EXPECT_LE(common, SlipSearch::SHARED * std::min(of_a, of_b));
    }
  ASSERT_EQ(c.stages.size(), 5u);
  EXPECT_EQ(c.stages[0], "lattice");
}

TEST(SlipSearch, LimitsThatBind)
{
  Case c(valley());
  c.limits.volume_lo = 500.0;
  c.limits.depth_hi = 2.5;
  const std::vector<SlipBody> found = c.search().run();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(c.within(found[0]));
  EXPECT_GT(found[0].depth, 2.3);
}

TEST(SlipSearch, StaysWithinANarrowPolygon)
{
  Case c(hill());
  c.allowed.assign(CELLS * CELLS, 0);
  for (int j = 18; j < 28; j++)
    for (int i = 0; i < CELLS; i++) c.allowed[CELLS * j + i] = 1;
  const std::vector<SlipBody> found = c.search().run();
  ASSERT_EQ(found.size(), 1u);
  const ElevationGrid base = c.maker.base(found[0].surface);
  for (size_t k = 0; k < base.z.size(); k++)
    if (!std::isnan(base.z[k])) EXPECT_TRUE(c.allowed[k]);
}

TEST(SlipSearch, NothingWithinImpossibleLimits)
{
  Case c(hill());
  c.limits.volume_lo = 1e7;
  c.limits.volume_hi = 1e8;
  EXPECT_TRUE(c.search().run().empty());
}

TEST(SlipWriter, FilesHoldTheBodies)
{
  char folder[] = "/tmp/slip_writer_XXXXXX";
  ASSERT_TRUE(mkdtemp(folder));
  const std::string prefix = std::string(folder) + "/crit";
  Case c(of_10_m());
  SlipBody one, two;
  SlipSurface deep = sphere_10_m();
  deep.radius += 1.0;
  ASSERT_EQ(c.maker.exact(sphere_10_m(), one), "");
  ASSERT_EQ(c.maker.exact(deep, two), "");
  one.yield = two.yield = 0.25;
  ElevationGrid least(102, 101, 0.0, 0.0, 0.5, std::nan(""));
  least.at(50, 50) = 0.5;    // the lattice had a lower one there
  SlipWriter::probe(prefix, 2);
  SlipWriter::write(prefix, least, {one, two}, c.maker);

  std::istringstream lines(text_of(prefix + ".slips.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "rank,x,y,z,radius,direction,factor,yield,volume,area,depth,along,across,straight");
  std::getline(lines, line);
  EXPECT_EQ(line.rfind("1,10.25,25.25,54,28.9617,180,", 0), 0u) << line;
  EXPECT_EQ(line.substr(line.size() - 6), ",1,1,0") << line;
  std::getline(lines, line);
  EXPECT_EQ(line.rfind("2,10.25,25.25,54,29.9617,180,", 0), 0u) << line;
  EXPECT_NE(line.find(",0.25,"), std::string::npos);

  const ElevationGrid factor = ElevationGrid::read(prefix + ".factor.asc");
  const ElevationGrid bases[] = {ElevationGrid::read(prefix + ".1.base.asc"),
                                 ElevationGrid::read(prefix + ".2.base.asc")};
  int shallow = 0, only_deep = 0;
  for (int j = 0; j < 101; j++)
    for (int i = 0; i < 102; i++) {
      const double f = factor.at(i, j);
      if (i == 50 && j == 50)
        EXPECT_NEAR(f, 0.5, 1e-6);
      else if (!std::isnan(bases[0].at(i, j))) {
        EXPECT_NEAR(f, std::min(one.factor, two.factor), 1e-6);
        const double u = 0.5 * i + 0.25 - 10.25, v = 0.5 * j + 0.25 - 25.25;
        EXPECT_NEAR(bases[0].at(i, j), 54.0 - std::sqrt(28.9617 * 28.9617 - u * u - v * v), 1e-6);
        shallow++;
      } else if (!std::isnan(bases[1].at(i, j))) {
        EXPECT_NEAR(f, two.factor, 1e-6);
        only_deep++;
      } else
        EXPECT_TRUE(std::isnan(f));
    }
  EXPECT_GT(shallow, 1000);
  EXPECT_GT(only_deep, 100);

  // columns: the whole plan, and the slopes of the sphere

  std::istringstream columns(text_of(prefix + ".2.columns.csv"));
  std::getline(columns, line);
  EXPECT_EQ(line,
            "dx_m,dy_m,depth_m,area_m2,slope_x,slope_y,weight_n,weight_depth_m,pressure_pa");
  double v[9], area = 0.0;
  size_t number = 0;
  for (; std::getline(columns, line); number++) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    for (double &value : v) words >> value;
    ASSERT_TRUE(words && words.eof()) << line;
    EXPECT_NEAR(v[4], v[0] / v[2], 1e-6);
    EXPECT_NEAR(v[5], v[1] / v[2], 1e-6);
    area += v[3];
  }
  EXPECT_GT(number, 5000u);
  EXPECT_NEAR(area, two.area, 1e-7 * two.area);

  for (const char *end : {".slips.csv", ".factor.asc", ".1.base.asc", ".2.base.asc",
                          ".1.columns.csv", ".2.columns.csv"})
    EXPECT_EQ(std::remove((prefix + end).c_str()), 0);
  EXPECT_EQ(std::remove(folder), 0);    // nothing else was left
}

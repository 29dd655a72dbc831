// What a region takes of vertical lines, against what LAMMPS says of points on them

#include "deck.h"
#include "domain.h"
#include "lammps_compat.h"
#include "region_columns.h"

#include <random>

using namespace LAMMPS_NS;

static const RegionColumns::Search SEARCH = {0.0, 10.0, 0.05};

struct Regions {
  Deck deck;

  Regions()
  {
    for (const char *line : {"ball sphere 5 5 5 3", "hole sphere 5 5 5 2 side out", "brick block 2 8 3 7 1 6",
                             "slope plane 5 5 4 0.3 -0.2 -1", "pipe cylinder z 4 5 2.5 1 9",
                             "log cylinder x 5 4 2.5 1 9", "pole cylinder y 5 4 2.5 1 9",
                             "tip cone z 5 5 3 1 1 9", "shell intersect 2 ball hole", "both union 2 brick pipe",
                             "rest union 2 ball log side out", "cut intersect 3 slope brick tip"})
      deck.one(std::string("region ") + line);
  }

  Region *region(const char *id) { return compat::find_region(deck.lmp.get(), id); }
  std::unique_ptr<RegionColumns> columns(const char *id) { return RegionColumns::of(deck.lmp.get(), region(id), SEARCH); }
};

static bool has(const Slope::Intervals &found, double z)
{
  for (size_t k = 0; k < found.size(); k++)
    if (z > found[k].lo && z < found[k].hi) return true;
  return false;
}

class Columns : public ::testing::TestWithParam<const char *> {};

TEST_P(Columns, AsLammpsHasThem)
{
  Regions r;
  Region *region = r.region(GetParam());
  const auto columns = r.columns(GetParam());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(0.0, 10.0);
  Slope::Intervals found;
  int inside = 0;
  for (int k = 0; k < 500; k++) {
    const double x = in(random), y = in(random);
    columns->column(x, y, found);
    for (int n = 0; n < 20; n++) {
      const double z = in(random);
      const bool there = region->match(x, y, z) != 0;
      ASSERT_EQ(has(found, z), there) << x << " " << y << " " << z;
      inside += there;
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_LT(inside, 9900);
}

INSTANTIATE_TEST_SUITE_P(Region, Columns,
                         ::testing::Values("ball", "hole", "brick", "slope", "pipe", "log", "pole", "tip", "shell",
                                           "both", "rest", "cut"),
                         [](const ::testing::TestParamInfo<const char *> &info) { return info.param; });

// the ends are exact, those of a searched cone as well: radius 3 at z = 1, 1 at z = 9
TEST(RegionColumns, Ends)
{
  Regions r;
  Slope::Intervals found;
  r.columns("shell")->column(5.0, 5.0, found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].lo, 2.0);
  EXPECT_EQ(found[0].hi, 3.0);
  EXPECT_EQ(found[1].lo, 7.0);
  EXPECT_EQ(found[1].hi, 8.0);
  r.columns("tip")->column(7.0, 5.0, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].lo, 1.0, 1e-12);
  EXPECT_NEAR(found[0].hi, 5.0, 1e-12);
  r.columns("hole")->column(5.0, 5.0, found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].lo, -HUGE_VAL);
  EXPECT_EQ(found[1].hi, HUGE_VAL);
}

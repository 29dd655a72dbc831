/* Sets of heights: algebra against sets of points of a fine grid, columns of shapes against their equations. */

#include "intervals.h"

#include <gtest/gtest.h>

#include <random>

using namespace Slope;

namespace {

// heights k + 0.5; ends of intervals are whole numbers

constexpr int N = 24;
typedef std::vector<bool> Points;

Points points(const Intervals &set)
{
  Points found(N, false);
  for (size_t k = 0; k < set.size(); k++)
    for (int z = 0; z < N; z++)
      if (set[k].lo < z + 0.5 && z + 0.5 < set[k].hi) found[z] = true;
  return found;
}

Intervals random_set(std::mt19937 &random)
{
  Intervals set, part;
  std::uniform_int_distribution<int> height(0, N), length(-1, 6), count(0, 4);
  for (int k = count(random); k > 0; k--) {
    const int lo = height(random);
    part.set({1.0 * lo, 1.0 * lo + length(random)});    // some are empty
    set.unite(part);
  }
  return set;
}

void expect_in_order(const Intervals &set)
{
  for (size_t k = 0; k < set.size(); k++) {
    EXPECT_LT(set[k].lo, set[k].hi);
    if (k > 0) {
      EXPECT_LT(set[k - 1].hi, set[k].lo);
    }
  }
}

}    // namespace

TEST(Intervals, algebra_is_that_of_sets)
{
  std::mt19937 random(1);
  int several = 0;
  for (int trial = 0; trial < 5000; trial++) {
    const Intervals a = random_set(random), b = random_set(random);
    const Points pa = points(a), pb = points(b);
    several += a.size() > 1 && b.size() > 1;

    Intervals both = a, any = a, out = a;
    both.intersect(b);
    any.unite(b);
    out.complement();
    const Points in_both = points(both), in_any = points(any), in_out = points(out);
    for (int z = 0; z < N; z++) {
      ASSERT_EQ(in_both[z], pa[z] && pb[z]);
      ASSERT_EQ(in_any[z], pa[z] || pb[z]);
      ASSERT_EQ(in_out[z], !pa[z]);
    }
    expect_in_order(both);
    expect_in_order(any);
    expect_in_order(out);

    Intervals nothing = a;
    nothing.intersect(out);
    EXPECT_TRUE(nothing.empty());
    out.unite(a);
    ASSERT_EQ(out.size(), 1u);
    EXPECT_EQ(out[0].lo, -HUGE_VAL);
    EXPECT_EQ(out[0].hi, HUGE_VAL);
    out.complement();
    EXPECT_TRUE(out.empty());
  }
  EXPECT_GT(several, 500);
}

TEST(Intervals, what_is_thin_is_ignored)
{
  Intervals set, part;
  for (const Interval &i : {Interval{0.0, 1.0}, Interval{1.001, 2.0}, Interval{3.0, 3.001},
                            Interval{4.0, 4.1}}) {
    part.set(i);
    set.unite(part);
  }
  ASSERT_EQ(set.size(), 4u);
  set.ignore(0.002);
  ASSERT_EQ(set.size(), 2u);
  EXPECT_EQ(set[0].lo, 0.0);
  EXPECT_EQ(set[0].hi, 2.0);
  EXPECT_EQ(set[1].lo, 4.0);
}

TEST(Intervals, a_height_that_is_no_number_is_nothing)
{
  Intervals set;
  set.set({0.0, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_TRUE(set.empty());
  set.set({0.0, 1.0});
  set.intersect(Interval::none());
  EXPECT_TRUE(set.empty());
}

TEST(Intervals, sphere)
{
  const Interval c = column_of_sphere(3.0, -4.0, 10.0, 13.0);
  EXPECT_DOUBLE_EQ(c.lo, -2.0);
  EXPECT_DOUBLE_EQ(c.hi, 22.0);
  EXPECT_TRUE(column_of_sphere(5.0, 12.0, 10.0, 13.0).empty());
  EXPECT_TRUE(column_of_sphere(50.0, 12.0, 10.0, 13.0).empty());
}

TEST(Intervals, half_space)
{
  const Interval up = column_of_half_space(2.0, 1.0, 5.0, 1.0, 0.0, 1.0);
  EXPECT_DOUBLE_EQ(up.lo, 3.0);
  EXPECT_EQ(up.hi, HUGE_VAL);
  const Interval down = column_of_half_space(2.0, 1.0, 5.0, 1.0, 0.0, -2.0);
  EXPECT_DOUBLE_EQ(down.hi, 6.0);
  EXPECT_EQ(down.lo, -HUGE_VAL);
  EXPECT_FALSE(column_of_half_space(2.0, 1.0, 5.0, 1.0, 0.0, 0.0).empty());
  EXPECT_TRUE(column_of_half_space(-2.0, 1.0, 5.0, 1.0, 0.0, 0.0).empty());
}

// Styles are found whatever suffix LAMMPS has put behind their names

#include "style_name.h"

#include <gtest/gtest.h>

using Slope::is_style;
using Slope::plain_style;

TEST(StyleName, EverySuffixOfLammpsAndOurs)
{
  for (const char *name : {"freeze", "freeze/kk", "freeze/kk/device", "freeze/kk/host", "freeze/gpu",
                           "freeze/intel", "freeze/omp", "freeze/opt", "freeze/slope"}) {
    EXPECT_EQ(plain_style(name), "freeze") << name;
    EXPECT_TRUE(is_style(name, "freeze")) << name;
    EXPECT_FALSE(is_style(name, "gravity")) << name;
  }
  EXPECT_TRUE(is_style("nve/sphere/omp", "nve/sphere"));
  EXPECT_TRUE(is_style("wall/gran/balls", "wall/gran/balls"));
}

// a name that only begins or ends like another one is another style
TEST(StyleName, NothingElse)
{
  EXPECT_FALSE(is_style("nve/sphere", "nve"));
  EXPECT_FALSE(is_style("nve/omp", "nve/sphere"));
  EXPECT_FALSE(is_style("gravity/variable", "gravity"));
  EXPECT_FALSE(is_style("adapt/fep", "adapt"));
  EXPECT_FALSE(is_style("freezekk", "freeze"));
  EXPECT_FALSE(is_style("freeze/omp/more", "freeze"));
  EXPECT_EQ(plain_style("/omp"), "/omp");    // nothing would be left
  EXPECT_EQ(plain_style("kk"), "kk");
  EXPECT_EQ(plain_style(""), "");
}

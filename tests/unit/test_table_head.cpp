// Tables that are read by position: what a comment above them says of columns and units, and what a number is

#include "decimal_number.h"
#include "number_rows.h"

#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <stdexcept>

using Slope::TableColumns;
using Slope::contradicts;

static const TableColumns PLAN = {"xy", "x,y", true, 1.0}, BALLS = {"xyz", "x y z", true, 1.0};

static TableColumns motion(double scale = 1.0)
{
  return {"txyz", "t ax ay az", true, scale};
}

TEST(TableHead, PointsInPlan)
{
  for (const char *head :
       {"x,y", " x y", "X;Y", "x (m), y (m)", "x_m,y_m", "easting,northing", "E N", "POINT_X,POINT_Y",
        "columns: x y, in metres", "unit: m", "x\xef\xbc\x88m\xef\xbc\x89 y", "x, y of the road's axis",
        "", "a road with an island in it", "the road, 12 ft wide", "y is north", "N", "S", "g", "E-W road",
        "x,", "1995: drawn by hand", "y: north, x: east", "min 3 points", "min"})
    EXPECT_FALSE(contradicts(head, PLAN)) << head;
  for (const char *head :
       {"y,x", "y x\r", "Y (m), X (m)", "north,east", "northing_m,easting_m", "lon,lat", "lat/lon",
        "longitude (deg) latitude (deg)", "x,y,z", "x [ft], y [ft]", "x_ft y_ft", "x,y in km",
        "x (\xc2\xb0), y (\xc2\xb0)", "unit: ft", "feet", "y, x of the road's axis", "columns: y x", "xcoord,xcoord"})
    EXPECT_TRUE(contradicts(head, PLAN)) << head;
}

TEST(TableHead, PointsInSpace)
{
  EXPECT_FALSE(contradicts("x y z", BALLS));
  EXPECT_FALSE(contradicts("east north height", BALLS));
  EXPECT_FALSE(contradicts("Fix wall/gran/balls w: 3 fixed balls of diameter 2, units si", BALLS));
  EXPECT_TRUE(contradicts("x z y", BALLS));
  EXPECT_TRUE(contradicts("x y", BALLS));
  EXPECT_TRUE(contradicts("x y z (mm)", BALLS));
}

TEST(TableHead, Motion)
{
  for (const char *head :
       {"acceleration of the ground for fix ground/motion: t ax ay az (s, m/s2)", "t ax ay az", "time,acc_x,acc_y,acc_z",
        "t[s] a_x[m/s^2] a_y[m/s^2] a_z[m/s^2]", "t(s) EW NS UD (m/s**2)", "t x y z in s and m/s\xc2\xb2",
        "t (s) ax (m s-2) ay (m s-2) az (m s-2)", "t ax ay az (m/sec/sec), Kobe", "unit: m/s2",
        "JMA Kobe, 818 gal", "dt = 0.01 s"})
    EXPECT_FALSE(contradicts(head, motion())) << head;
  for (const char *head :
       {"t ay ax az", "t ax ay az (gal)", "t, ax, ay, az [cm/s2]", "t(s) NS EW UD", "ax ay az t", "t ax ay az in gal, Kobe",
        "t_ms ax ay az", "t (ms) ax ay az", "time acc_x acc_y acc_z (g)", "unit: gal", "s, cm/sec**2", "x y z", "t ay",
        "t x y z (m)", "t x y z (kine)", "Kobe: t ay ax az", "t\xef\xbc\x88ms\xef\xbc\x89 ax ay az"})
    EXPECT_TRUE(contradicts(head, motion())) << head;
}

// scale may make m/s2 of what the file has, and more or less of it beside
TEST(TableHead, ScaleCounts)
{
  EXPECT_FALSE(contradicts("t ax ay az (gal)", motion(0.01)));
  EXPECT_FALSE(contradicts("t ax ay az (gal)", motion(-0.015)));
  EXPECT_TRUE(contradicts("t ax ay az (gal)", motion(2.0)));
  EXPECT_FALSE(contradicts("t ax ay az (g)", motion(9.80665)));
  EXPECT_TRUE(contradicts("t ax ay az (g)", motion(0.01)));
  EXPECT_FALSE(contradicts("t ax ay az (m/s2)", motion(0.01)));
  EXPECT_TRUE(contradicts("t (ms) ax ay az (gal)", motion(0.01)));
}

// in a deck of other units, names count alone
TEST(TableHead, OtherUnits)
{
  TableColumns cgs = motion();
  cgs.si = false;
  EXPECT_FALSE(contradicts("t ax ay az (gal)", cgs));
  EXPECT_TRUE(contradicts("t ay ax az (gal)", cgs));
  EXPECT_EQ(cgs.rule(), "columns must be t ax ay az");
  EXPECT_EQ(motion().rule(), "columns must be t ax ay az in s and m/s2");
  EXPECT_EQ(PLAN.rule(), "columns must be x,y in m");
}

static std::string rows_of(const std::string &text)
{
  // a file of each test: ctest runs several at a time
  const std::string path = std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".txt";
  std::ofstream(path, std::ios::binary) << text;
  std::string found;
  try {
    Slope::read_number_rows(path, PLAN, [&](const Slope::NumberRow &row) {
      found += std::to_string(row.line) + (row.apart ? "|" : ":") + std::to_string(row.values[1]) + " ";
    });
  } catch (std::runtime_error &e) {
    found = e.what();
  }
  std::remove(path.c_str());
  return found;
}

TEST(NumberRows, AHeadThatContradictsIsRefused)
{
  EXPECT_EQ(rows_of("# y,x\n1,2\n"), "AHeadThatContradictsIsRefused.txt, line 1: columns must be x,y in m, got y,x");
  EXPECT_EQ(rows_of("\n# a road\n#  x (ft), y (ft) \r\n1,2\n"),
            "AHeadThatContradictsIsRefused.txt, line 3: columns must be x,y in m, got x (ft), y (ft)");
  EXPECT_EQ(rows_of("# x,y\n1,2\n# y,x: of a ring\n3,4\n# y,x\n\n5,6 # y,x\n"), "2:2.000000 4:4.000000 7|6.000000 ");
}

TEST(NumberRows, OnlyDecimalNumbers)
{
  EXPECT_EQ(rows_of("-1,+.5\n1e-3\t2.\n"), "1:0.500000 2:2.000000 ");
  for (const char *word : {"0x1p3", "0x10", "inf", "nan", "infinity", "1e999", "1.0.0", "1e", "30-", ".", "1_5", "1d3",
                           "2m", "1;2", "--1"})
    EXPECT_EQ(rows_of(std::string("0,0\n1,") + word + "\n"),
              std::string("OnlyDecimalNumbers.txt, line 2: must be 2 numbers, x,y, got 1,") + word);
  for (const char *line : {"1,2,", ",1,2", "1,,2", "1,2,,"})
    EXPECT_EQ(rows_of(line), std::string("OnlyDecimalNumbers.txt, line 1: must be 2 numbers, x,y, got ") + line);
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// The ESRI ASCII grid: what is read is what was written, a plane is a plane up to the raster's
// edge, and a bad file is one clear line.

#include "atomic_file.h"
#include "elevation_grid.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

using Slope::ElevationGrid;

static const double NaN = std::nan("");

class Grid : public testing::Test {
 protected:
  std::string folder;

  void SetUp() override
  {
    char name[] = "/tmp/test_elevation_grid.XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder = name;
  }

  void TearDown() override
  {
    // also shows that no write left anything beside
    for (const char *name : {"a.asc", "b.asc"}) remove(path(name).c_str());
    EXPECT_EQ(rmdir(folder.c_str()), 0) << folder << " is not empty";
  }

  std::string path(const std::string &name) const { return folder + "/" + name; }

  void write(const ElevationGrid &grid, const std::string &name, int digits = 9) const
  {
    Slope::AtomicFile file(path(name));
    grid.write(file, digits);
    file.commit();
  }

  ElevationGrid read(const std::string &text) const
  {
    std::ofstream(path("a.asc")) << text;
    return ElevationGrid::read(path("a.asc"));
  }

  // the one line of the error, without the folder
  std::string error(const std::string &text) const
  {
    try {
      read(text);
    } catch (std::runtime_error &e) {
      const std::string line = e.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      const size_t at = line.find(folder);
      EXPECT_NE(at, std::string::npos) << line;
      return line.substr(0, at) + line.substr(at + folder.size() + 1);
    }
    return "no error";
  }
};

static const char *HEADER = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\n";

/* ---- reading ---- */

TEST_F(Grid, ReadsRowsFromTheNorth)
{
  const ElevationGrid g = read(std::string(HEADER) + "NODATA_value -1\n1 2 3\n4 -1 6\n");
  EXPECT_EQ(g.nx, 3);
  EXPECT_EQ(g.ny, 2);
  EXPECT_EQ(g.at(0, 1), 1.0);
  EXPECT_EQ(g.at(2, 0), 6.0);
  EXPECT_TRUE(std::isnan(g.at(1, 0)));
  EXPECT_EQ(g.count_nodata(), 1);
  EXPECT_EQ(g.zmin(), 1.0);
  EXPECT_EQ(g.zmax(), 6.0);
  EXPECT_EQ(g.xlo, 10.0);
  EXPECT_EQ(g.xhi(), 16.0);
  EXPECT_EQ(g.yhi(), 24.0);
}

TEST_F(Grid, TakesAMarkOfUtf8)
{
  const std::string text = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n";
  EXPECT_EQ(read("\xef\xbb\xbf" + text).at(1, 0), 2.0);
  EXPECT_EQ(error("\xef\xbb\xbf"), "a.asc is empty");
}

TEST_F(Grid, CornerAndCenterHeadersAreTheSamePlace)
{
  const ElevationGrid corner = read(std::string(HEADER) + "1 2 3 4 5 6");
  const ElevationGrid center =
      read("NROWS 2\r\nCELLSIZE 2\r\nNODATA_VALUE -9999\r\nXLLCENTER 11\r\nYllCenter 21\r\n"
           "NCols 3\r\n1 2 3\r\n4 5 6\r\n");
  EXPECT_EQ(corner.xlo, center.xlo);
  EXPECT_EQ(corner.ylo, center.ylo);
  EXPECT_EQ(corner.z, center.z);
}

TEST_F(Grid, NodataDefaultAndOddNodataValues)
{
  EXPECT_EQ(read(std::string(HEADER) + "1 2 3 4 -9999 6").count_nodata(), 1);
  EXPECT_EQ(read(std::string(HEADER) + "NODATA_value nan\n1 2 3 4 nan 6").count_nodata(), 1);
  EXPECT_EQ(read(std::string(HEADER) +
                 "NODATA_value -3.4028234663852886e+38\n1 2 3 4 -3.40282e+38 6")
                .count_nodata(),
            1);
  EXPECT_EQ(read(std::string(HEADER) + "NODATA_value 0\n1 2 3 4 0 1e-30").count_nodata(), 1);
}

TEST_F(Grid, BadFiles)
{
  const std::string h = HEADER;
  EXPECT_EQ(error(""), "a.asc is empty");
  EXPECT_EQ(error(" \n\n"), "a.asc is empty");
  EXPECT_EQ(error(h + "1 2 3\n4 5\n"),
            "a.asc, line 7: only 5 of 6 values (2 rows x 3 columns)");
  EXPECT_EQ(error(h), "a.asc, line 5: only 0 of 6 values (2 rows x 3 columns)");
  EXPECT_EQ(error(h + "1 2 3\n4 5 6\n7\n"),
            "a.asc, line 8: more than 6 values (2 rows x 3 columns), next is 7");
  EXPECT_EQ(error(h + "1 2 3\n4 5,5 6\n"), "a.asc, line 7: height must be a number, got 5,5");
  EXPECT_EQ(error(h + "1 2 3\n4 nan 6\n"), "a.asc, line 7: height must be finite, got nan");
  EXPECT_EQ(error(h + "1 2 3\n4 inf 6\n"), "a.asc, line 7: height must be finite, got inf");
  EXPECT_EQ(error(h + "1 2 3\n4 1e999 6\n"), "a.asc, line 7: height must be finite, got inf");
  EXPECT_EQ(error(h + "-9999 -9999 -9999\n-9999 -9999 -9999\n"),
            "a.asc: all 6 values are NODATA");
  EXPECT_EQ(error("ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\n1 2 3 4 5 6"),
            "a.asc, line 4: header key cellsize is missing");
  EXPECT_EQ(error("ncols 3\nnrows 2\ncellsize 2\nyllcorner 20\n1 2 3 4 5 6"),
            "a.asc, line 4: header key xllcorner (or xllcenter) is missing");
  EXPECT_EQ(error(h + "nrows 2\n1 2 3 4 5 6"),
            "a.asc, line 6: header key nrows is given twice");
  EXPECT_EQ(error(h + "xllcenter 11\n1 2 3 4 5 6"),
            "a.asc, line 6: xllcorner and xllcenter are both given");
  EXPECT_EQ(error("ncols three\n"), "a.asc, line 1: ncols must be a number, got three");
  EXPECT_EQ(error("ncols 3\nnrows"),
            "a.asc, line 2: nrows must be a number, got the end of the file");
  EXPECT_EQ(error("ncols 2.5\n"), "a.asc, line 1: ncols must be a whole number >= 1, got 2.5");
  EXPECT_EQ(error("ncols 3\nnrows 0\n"),
            "a.asc, line 2: nrows must be a whole number >= 1, got 0");
  EXPECT_EQ(error("cellsize -2\n"), "a.asc, line 1: cellsize must be > 0, got -2");
  EXPECT_EQ(error("xllcorner inf\n"), "a.asc, line 1: xllcorner must be finite, got inf");
  EXPECT_EQ(error("\x89PNG\r\n\x1a\n1234567890"),
            "a.asc, line 1: must be a header key of an ESRI ASCII grid or a number, got ?PNG");
  EXPECT_EQ(error("ncols 1000000\nnrows 1000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2"),
            "a.asc, line 5: 1000000 x 1000000 cells would need 8000 GB of memory, at most "
            "2147483647 cells are possible");
}

TEST_F(Grid, MissingFileAndFolder)
{
  try {
    ElevationGrid::read(path("none.asc"));
    FAIL();
  } catch (std::runtime_error &e) {
    EXPECT_EQ(e.what(), "cannot read " + path("none.asc") + ": No such file or directory");
  }
  EXPECT_THROW(ElevationGrid::read(folder), std::runtime_error);
}

// every spelling of a number is what strtod makes of it
TEST_F(Grid, Numbers)
{
  for (const char *text :
       {"0", "-0.0", "1", "-1", "+1", "1.", ".5", "-.5", "0.1", "-123.456", "007", "1e3", "-1.5E-3",
        "123456789012345", "1234567890123456", "12345678901234567890123", "0.123456789012345",
        "0.1234567890123456", "999999999999999", "9007199254740993", "1234.56789012345678901",
        "532.2471", "0.30000000000000004", "1e-320"})
    EXPECT_EQ(read("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n" +
                   std::string(text))
                  .z[0],
              strtod(text, nullptr))
        << text;
  for (const char *text : {".", "-", "+", "1.2.3", "1-2", "--1", "1e", "12a", "1,5", "0x10", "-0x10",
                           "+0X1p3", "00x1"})
    EXPECT_EQ(error(std::string(HEADER) + "1 " + text + " 3 4 5 6"),
              std::string("a.asc, line 6: height must be a number, got ") + text);
}

/* ---- heights ---- */

TEST_F(Grid, PlaneIsExactUpToTheEdge)
{
  auto plane = [](double x, double y) { return 100.0 + 0.7 * x - 1.3 * y; };
  ElevationGrid g(7, 5, -3.0, 4.0, 2.5, 0.0);
  for (int j = 0; j < g.ny; j++)
    for (int i = 0; i < g.nx; i++)
      g.at(i, j) = plane(g.xlo + (i + 0.5) * g.cell, g.ylo + (j + 0.5) * g.cell);

  for (double x = g.xlo; x <= g.xhi(); x += 0.125)
    for (double y = g.ylo; y <= g.yhi(); y += 0.125)
      ASSERT_NEAR(g.height(x, y), plane(x, y), 1e-12) << x << " " << y;

  EXPECT_TRUE(std::isnan(g.height(g.xlo - 1e-9, 5.0)));
  EXPECT_TRUE(std::isnan(g.height(g.xhi() + 1e-9, 5.0)));
  EXPECT_TRUE(std::isnan(g.height(0.0, g.ylo - 1e-9)));
  EXPECT_TRUE(std::isnan(g.height(0.0, g.yhi() + 1e-9)));
  EXPECT_TRUE(std::isnan(g.height(NaN, 5.0)));
}

TEST_F(Grid, NodataSpoilsOnlyWhereItHasAWeight)
{
  ElevationGrid g(5, 5, 0.0, 0.0, 1.0, 1.0);
  g.at(2, 2) = NaN;    // centre 2.5 2.5
  EXPECT_TRUE(std::isnan(g.height(2.5, 2.5)));
  EXPECT_TRUE(std::isnan(g.height(1.51, 2.5)));
  EXPECT_TRUE(std::isnan(g.height(3.49, 3.49)));
  EXPECT_EQ(g.height(1.5, 2.5), 1.0);
  EXPECT_EQ(g.height(3.5, 3.5), 1.0);
  EXPECT_EQ(g.height(1.5, 1.7), 1.0);

  EXPECT_FALSE(g.nodata_within(1.0, 2.5, 0.49));
  EXPECT_TRUE(g.nodata_within(1.0, 2.5, 0.51));
  EXPECT_FALSE(g.nodata_within(1.0, 1.0, 0.70));    // sqrt(0.5) = 0.707 to the corner
  EXPECT_TRUE(g.nodata_within(1.0, 1.0, 0.71));
  EXPECT_TRUE(g.nodata_within(2.5, 2.5, 1e-6));
  EXPECT_FALSE(g.nodata_within(-50.0, 2.5, 1.0));
}

TEST_F(Grid, NodataNextToTheRimSpoilsTheRim)
{
  ElevationGrid g(5, 5, 0.0, 0.0, 1.0, 1.0);
  g.at(1, 2) = NaN;
  EXPECT_TRUE(std::isnan(g.height(0.1, 2.5)));
  EXPECT_TRUE(g.nodata_within(0.1, 2.5, 1e-6));
  EXPECT_EQ(g.height(0.1, 1.4), 1.0);
}

TEST_F(Grid, NodataWithinAgreesWithHeights)
{
  ElevationGrid g(6, 4, 1.0, -2.0, 0.5, 3.0);
  g.at(4, 1) = g.at(1, 3) = NaN;
  const double r = 0.4;
  for (double x = 1.03; x < 4.0; x += 0.1)
    for (double y = -1.97; y < 0.0; y += 0.1) {
      bool near = false;
      for (double dx = -r; dx <= r; dx += 0.01)
        for (double dy = -r; dy <= r; dy += 0.01) {
          const double px = x + dx, py = y + dy;
          if (dx * dx + dy * dy < (r - 0.01) * (r - 0.01) && px > g.xlo && px < g.xhi() &&
              py > g.ylo && py < g.yhi() && std::isnan(g.height(px, py)))
            near = true;
        }
      if (near)
        EXPECT_TRUE(g.nodata_within(x, y, r)) << x << " " << y;
      else
        EXPECT_FALSE(g.nodata_within(x, y, r - 0.03)) << x << " " << y;
    }
}

TEST_F(Grid, OneRow)
{
  ElevationGrid g(2, 1, 0.0, 0.0, 1.0, 4.0);
  g.at(1, 0) = 6.0;
  EXPECT_DOUBLE_EQ(g.height(1.0, 0.1), 5.0);
  EXPECT_DOUBLE_EQ(g.height(2.0, 0.9), 7.0);
  EXPECT_EQ(ElevationGrid(1, 1, 0.0, 0.0, 1.0, 4.0).height(0.2, 0.9), 4.0);
}

/* ---- writing ---- */

TEST_F(Grid, WhatIsWrittenIsRead)
{
  ElevationGrid g(5, 4, 272768.92290525451, -1.0 / 3.0, 0.1, 0.0);
  for (size_t k = 0; k < g.z.size(); k++) g.z[k] = std::exp(3.0 * k) / 7.0;
  g.at(3, 2) = NaN;
  g.at(0, 0) = 0.0;
  write(g, "b.asc", 17);
  const ElevationGrid h = ElevationGrid::read(path("b.asc"));
  EXPECT_EQ(g.xlo, h.xlo);
  EXPECT_EQ(g.ylo, h.ylo);
  EXPECT_EQ(g.cell, h.cell);
  ASSERT_EQ(g.z.size(), h.z.size());
  for (size_t k = 0; k < g.z.size(); k++)
    EXPECT_TRUE(g.z[k] == h.z[k] || (std::isnan(g.z[k]) && std::isnan(h.z[k]))) << k;
}

// numbers are rounded to so many significant digits, whatever their size and sign
TEST_F(Grid, Digits)
{
  std::vector<double> values;
  for (double v = 1.23456789012345e-7; v < 1e17; v *= 7.7)
    for (double sign : {1.0, -1.0}) {
      values.push_back(sign * v);
      values.push_back(std::round(sign * v));
    }
  for (double v :
       {9.9999999999, 999999.9999996, 1e8, 1.0, 10.0, 100.0, 0.1, 999999999.7, 1e9, 1e15})
    values.push_back(v);
  for (int digits : {6, 9, 12, 15}) {
    ElevationGrid g(values.size(), 1, 0.0, 0.0, 1.0, 0.0);
    g.z = values;
    write(g, "b.asc", digits);
    const ElevationGrid h = ElevationGrid::read(path("b.asc"));
    for (size_t k = 0; k < values.size(); k++)
      EXPECT_NEAR(h.z[k], values[k], 0.5001 * std::pow(10.0, 1 - digits) * std::fabs(values[k]))
          << digits;
  }
}

TEST_F(Grid, Format)
{
  ElevationGrid g(2, 2, 0.5, 10.0, 0.1, 1.0 / 3.0);
  g.at(0, 1) = NaN;
  g.at(1, 0) = 0.0;
  write(g, "b.asc", 4);
  std::ifstream in(path("b.asc"));
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str(),
            "ncols 2\nnrows 2\nxllcorner 0.5\nyllcorner 10\ncellsize 0.1\nNODATA_value -9999\n"
            "-9999 0.3333\n0.3333 0\n");
}

TEST_F(Grid, WriteErrorsLeaveNothingBehind)
{
  ElevationGrid g(300, 300, 0.0, 0.0, 1.0, 1.0 / 3.0);
  try {
    write(g, "none/b.asc");
    FAIL();
  } catch (std::runtime_error &e) {
    EXPECT_EQ(e.what(), "cannot write " + path("none/b.asc") + ": No such file or directory");
  }

  // a full disk, played by a limit on the size of files: the older file survives

  write(ElevationGrid(1, 1, 0.0, 0.0, 1.0, 5.0), "b.asc");
  signal(SIGXFSZ, SIG_IGN);
  struct rlimit before, small;
  getrlimit(RLIMIT_FSIZE, &before);
  small = before;
  small.rlim_cur = 100000;
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write(g, "b.asc"), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(ElevationGrid::read(path("b.asc")).z, std::vector<double>{5.0});
}

// 16 million values: read in a few seconds. The time is printed, not asserted.
TEST_F(Grid, LargeRaster)
{
  const int n = 4000;
  ElevationGrid g(n, n, 0.0, 0.0, 1.0, 0.0);
  for (size_t k = 0; k < g.z.size(); k++) g.z[k] = 1000.0 + 0.001 * (k % 99991);
  auto now = [] { return std::chrono::steady_clock::now(); };
  auto since = [&](std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(now() - t).count();
  };
  auto start = now();
  write(g, "b.asc");
  printf("4000 x 4000 written in %.2f s\n", since(start));
  start = now();
  const ElevationGrid h = ElevationGrid::read(path("b.asc"));
  printf("4000 x 4000 read in %.2f s\n", since(start));
  double worst = 0.0;
  for (size_t k = 0; k < g.z.size(); k++) worst = std::max(worst, std::fabs(g.z[k] - h.z[k]));
  EXPECT_LT(worst, 1e-8);
}

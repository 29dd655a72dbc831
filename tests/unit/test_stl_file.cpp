/* STL files, text and binary, told apart, and everything that can be wrong with them. */

#include "stl_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

using namespace Slope;

// of this process alone: ctest runs tests side by side
static const std::string PATH = "test_stl_file." + std::to_string(getpid()) + ".stl";
static const struct Cleaner {
  ~Cleaner() { std::remove(PATH.c_str()); }
} cleaner;

static const std::string ONE =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 2 0 0\n  vertex 0 4 0\n endloop\nendfacet\n";

static void write(const std::string &bytes)
{
  std::ofstream(PATH, std::ios::binary) << bytes;
}

static std::string number(uint32_t n)
{
  std::string s;
  for (int k = 0; k < 4; k++) s += static_cast<char>(n >> (8 * k) & 0xff);
  return s;
}

static std::string record(const float *v)
{
  std::string s(12, '\0');
  for (int k = 0; k < 9; k++) {
    uint32_t bits;
    memcpy(&bits, &v[k], 4);
    s += number(bits);
  }
  return s + std::string(2, '\7');    // attributes
}

static std::string binary(int n, const std::string &header = "solid of another program")
{
  const float v[9] = {0, 0, 0, 2, 0, 0, 0, 4, 0.5f};
  std::string s = header;
  s.resize(80, ' ');
  s += number(n);
  for (int k = 0; k < n; k++) s += record(v);
  return s;
}

// the message of what read() throws
static std::string problem(const std::string &bytes)
{
  write(bytes);
  try {
    StlFile::read(PATH);
  } catch (std::exception &e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
  return "none";
}

#define EXPECT_SAYS(bytes, text) \
  EXPECT_NE(problem(bytes).find(text), std::string::npos) << problem(bytes)

TEST(StlFile, ReadsText)
{
  write("solid a name of several words\n" + ONE + ONE + "endsolid a name\n");
  const StlFile f = StlFile::read(PATH);
  EXPECT_EQ(f.rounding, 0.0);
  ASSERT_EQ(f.triangles.size(), 2u);
  EXPECT_EQ(f.skipped, 0);
  EXPECT_EQ(f.triangles[1].c.y, 4.0);
}

TEST(StlFile, ReadsTextOfOtherPrograms)
{
  std::string text = "\xef\xbb\xbfSOLID\n" + ONE + "ENDSOLID\nsolid second\n" + ONE + "endsolid second";
  const size_t at = text.find("normal 0 0 1");
  text.replace(at, 12, "normal nan -nan(ind) nan");
  text.replace(text.find("vertex 2 0 0"), 12, "VERTEX\t+2.0E+00 -0. 0e5");
  size_t line = 0;
  while ((line = text.find('\n', line)) != std::string::npos) {
    text.insert(line, "\r");
    line += 2;
  }
  write(text);
  const StlFile f = StlFile::read(PATH);
  ASSERT_EQ(f.triangles.size(), 2u);
  EXPECT_EQ(f.triangles[0].b.x, 2.0);
}

TEST(StlFile, ReadsBinaryWhateverItsHeader)
{
  for (const char *header : {"solid of another program", "", "solid"}) {
    write(binary(3, header));
    const StlFile f = StlFile::read(PATH);
    EXPECT_GT(f.rounding, 0.0);    // not read as text
    ASSERT_EQ(f.triangles.size(), 3u);
    EXPECT_EQ(f.triangles[2].c.z, 0.5);
  }
  write(binary(3) + "more");    // what some programs append
  EXPECT_EQ(StlFile::read(PATH).triangles.size(), 3u);
  EXPECT_EQ(StlFile::read(PATH).surplus, 4.0);
}

TEST(StlFile, KnowsHowABinaryFileRounds)
{
  float corners[9] = {0.0f, 0.0f, 0.0f, 2.0f, 0.0f, 0.0f, 0.0f, 3954321.25f, 0.0f};
  write(std::string(80, ' ') + number(1) + record(corners));
  EXPECT_EQ(StlFile::read(PATH).rounding, 0.125);
  EXPECT_EQ(StlFile::read(PATH, 0.001, {1.0, 2.0, 3.0}).rounding, 0.000125);
  write("solid a\n" + ONE + "endsolid a\n");
  EXPECT_EQ(StlFile::read(PATH).rounding, 0.0);
}

TEST(StlFile, ScalesThenMoves)
{
  write(binary(1));
  const StlFile f = StlFile::read(PATH, 0.5, {10.0, 20.0, 30.0});
  EXPECT_EQ(f.triangles[0].c.y, 22.0);
  EXPECT_EQ(f.triangles[0].c.z, 30.25);
}

TEST(StlFile, SkipsTrianglesWithoutArea)
{
  const float same[9] = {1, 1, 1, 1, 1, 1, 5, 5, 5}, line[9] = {0, 0, 0, 1, 1, 1, 3, 3, 3};
  std::string bytes = binary(1);
  bytes.replace(80, 4, number(3));
  write(bytes + record(same) + record(line));
  const StlFile f = StlFile::read(PATH);
  EXPECT_EQ(f.triangles.size(), 1u);
  EXPECT_EQ(f.skipped, 2);
  bytes = binary(0);
  bytes.replace(80, 4, number(1));
  EXPECT_SAYS(bytes + record(line), "must be a triangle with an area, got 1 without");
}

TEST(StlFile, SliversHaveAnArea)
{
  const float sliver[9] = {0, 0, 0, 10, 0, 0, 5, 0.001f, 0};
  std::string bytes = binary(0);
  bytes.replace(80, 4, number(1));
  write(bytes + record(sliver));
  EXPECT_EQ(StlFile::read(PATH).skipped, 0);
}

TEST(StlFile, SaysWhatIsWrongWithText)
{
  EXPECT_SAYS("solid x\n" + ONE, "line 9: the file is cut short: it ends where facet or endsolid");
  for (const size_t n : {10, 40, 60, 91})
    EXPECT_SAYS("solid x\n" + ONE.substr(0, n), "the file is cut short");
  EXPECT_SAYS("solid x\nendsolid x\n", "must be a triangle with an area, got no triangles");
  EXPECT_SAYS("solid\n" + ONE + "vertex 1 1 1\nendsolid", "line 9: facet or endsolid is expected here, got vertex");
  std::string text = "solid x\n" + ONE + "endsolid x\n";
  text.replace(text.find("2 0 0"), 5, "2 x 0");
  EXPECT_SAYS(text, "line 5: a coordinate must be a finite number, got x");
  text = "solid x\n" + ONE + "endsolid x\n";
  text.replace(text.find("2 0 0"), 1, "inf");
  EXPECT_SAYS(text, "line 5: a coordinate must be a finite number, got inf");
  text.replace(text.find("inf"), 3, "0x2");
  EXPECT_SAYS(text, "line 5: a coordinate must be a finite number, got 0x2");
  text = "solid x\n" + ONE + "endsolid x\n";
  text.replace(text.find(" endloop"), 8, "  vertex 1 1 1\n endloop");
  EXPECT_SAYS(text, "line 7: endloop is expected here, got vertex");
}

TEST(StlFile, SaysWhatIsWrongWithBinary)
{
  const std::string whole = binary(4, "made by hand");
  EXPECT_SAYS(whole.substr(0, whole.size() - 1), "cut short, or no STL: 4 triangles need 284 bytes, got 283");
  EXPECT_SAYS(binary(4).substr(0, 100), "cut short");    // begins with solid, but holds zeros
  EXPECT_SAYS(whole.substr(0, 40), "at least 84 bytes, got 40");
  EXPECT_SAYS("", "at least 84 bytes, got 0");
  EXPECT_SAYS(binary(0), "got no triangles");
  EXPECT_SAYS(std::string(80, 'x') + number(4000000000u), "4000000000 triangles need 200000000084 bytes, got 84");
  const float bad[9] = {0, 0, 0, 1, 0, HUGE_VALF, 0, 1, 0};
  std::string bytes = binary(1);
  bytes.replace(80, 4, number(2));
  EXPECT_SAYS(bytes + record(bad), "triangle 2: coordinates must be finite numbers, got inf");
}

TEST(StlFile, SaysWhatCannotBeRead)
{
  try {
    StlFile::read("no/such/file.stl");
    FAIL();
  } catch (std::exception &e) {
    EXPECT_EQ(std::string(e.what()), "cannot read no/such/file.stl: No such file or directory");
  }
  remove(PATH.c_str());
}

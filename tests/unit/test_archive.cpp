// Members of a restart file: what was written is read, by name; another version and damaged bytes are refused with one line

#include "archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

using Slope::Archive;

struct Members {
  double length = 0.1;
  int64_t step = 7;
  bool on = false;
  double kick[3] = {0.0, -0.0, 3.0};
  std::vector<double> marks;
  std::vector<std::string> said;

  void archive(Archive &a)
  {
    a.number("length", length);
    a.number("step", step);
    a.number("on", on);
    a.same("numbers_of_a_contact", 10);
    a.numbers("kick", kick, 3);
    a.lines("said", said);
    a.list("marks", marks);
  }
};

static std::string written()
{
  Members m;
  m.length = 1.0 / 3.0;
  m.step = int64_t(1) << 50;
  m.on = true;
  m.marks = {1.0, 2.0, 1e300};
  m.said = {"", "25 \u00b0"};
  Archive to("wall", 5);
  m.archive(to);
  return to.bytes();
}

// what is said when these bytes are read; empty if nothing
static std::string problem(const std::string &bytes, int version = 5, const std::string &style = "wall")
{
  Members m;
  try {
    Archive from(style, version, bytes.data());
    m.archive(from);
  } catch (const std::runtime_error &e) {
    return e.what();
  }
  return "";
}

static bool has(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

// bytes with another number at this place
static std::string with(std::string bytes, size_t at, double value)
{
  return bytes.replace(at, sizeof(value), reinterpret_cast<const char *>(&value), sizeof(value));
}

TEST(Archive, WhatIsReadIsWhatWasWritten)
{
  const std::string bytes = written();
  Members m;
  Archive from("wall", 5, bytes.data());
  m.archive(from);
  EXPECT_EQ(m.length, 1.0 / 3.0);
  EXPECT_EQ(m.step, int64_t(1) << 50);
  EXPECT_TRUE(m.on);
  EXPECT_EQ(m.kick[2], 3.0);
  EXPECT_TRUE(std::signbit(m.kick[1]));
  EXPECT_EQ(m.marks, (std::vector<double>{1.0, 2.0, 1e300}));
  EXPECT_EQ(m.said, (std::vector<std::string>{"", "25 \u00b0"}));
  EXPECT_EQ(from.rest(), bytes.data() + bytes.size());
  EXPECT_EQ(Archive::length(bytes.data()), bytes.size());
}

TEST(Archive, AnotherVersionOrNone)
{
  EXPECT_TRUE(has(problem(written(), 6), "data of version 6, got 5: start again, or continue with the version"));
  const double list[3] = {4.0, 12.0, 0.5};    // as written before there were archives
  const std::string old(reinterpret_cast<const char *>(list), sizeof(list));
  EXPECT_EQ(Archive::length(old.data()), 0u);
  EXPECT_TRUE(has(problem(old), "data of version 5, got none, or those of an earlier version: start again"));
}

TEST(Archive, BytesThatAreNone)
{
  const std::string bytes = written();
  for (const double byte : {1e300, -129.0, 128.0, static_cast<double>(NAN)})
    EXPECT_TRUE(has(problem(with(bytes, bytes.find("said") + 24 + 16, byte)), "must have bytes in said, got ")) << byte;
}

// a number that the reader must have as well: of another layout
TEST(Archive, AnotherLayout)
{
  const std::string bytes = written();
  const size_t at = bytes.find("numbers_of_a_contact") + 24 + 16;
  EXPECT_TRUE(has(problem(with(bytes, at, 9.0)), "with numbers_of_a_contact 9 in place of 10"));
}

// marks of what a file belongs to: those of the file and mine in words, NaN being NaN
TEST(Archive, AnotherLine)
{
  auto line = [](Archive &a, double points, double height) {
    a.same("line", {{"points", points}, {"height", height}},
           [](const double *k) { return std::to_string((int) k[0]) + " points"; }, ": new ID");
  };
  Archive to("line", 1);
  line(to, 3.0, NAN);
  const std::string bytes = to.bytes();
  auto said = [&](double points, double height) -> std::string {
    Archive from("line", 1, bytes.data());
    try {
      line(from, points, height);
    } catch (const std::runtime_error &e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(said(3.0, NAN), "");
  EXPECT_EQ(said(4.0, NAN), "the line must be that of the restart file, 3 points; got 4 points: new ID");
  EXPECT_TRUE(has(said(3.0, 1.0), "that of the restart file, 3 points"));
}

TEST(Archive, Damaged)
{
  const std::string bytes = written();
  EXPECT_TRUE(has(problem(bytes, 5, "line"), "the member line here, got another one: the file is damaged"));
  std::string other = bytes;
  other[other.find("kick")] = 'p';
  EXPECT_TRUE(has(problem(other), "the member kick here"));
  for (const size_t word : {8, 16})    // the length of all
    for (const double value : {1e300, -7.0, 0.5, 20.0, double(NAN)})
      EXPECT_TRUE(has(problem(with(bytes, word, value)), "number of bytes, there twice")) << value;
  for (const size_t word : {24, 32})    // of a list
    for (const double value : {1e300, -7.0, 0.5, 2.0, double(NAN)})
      EXPECT_TRUE(has(problem(with(bytes, bytes.find("marks") + word, value)), "whole number of values in marks"))
          << value;

  // both words alike, beyond the end
  const size_t at = bytes.find("marks") + 24;
  EXPECT_TRUE(has(problem(with(with(bytes, at, 4.0), at + 8, -5.0)), "values in marks, from 0 to 3"));
  EXPECT_TRUE(has(problem(with(with(bytes, 8, 100.0), 16, -101.0)), "all of its members, got fewer bytes"));
  const size_t three = bytes.find("kick") + 24;
  EXPECT_TRUE(has(problem(with(with(bytes, three, 2.0), three + 8, -3.0)), "3 values in kick, got 2"));
}

struct Event {
  double time, place[2];
};

TEST(Archive, RecordsAndWhatFollows)
{
  std::vector<Event> events = {{1.0, {2.0, 3.0}}, {4.0, {5.0, 6.0}}}, found(1);
  Archive to("line", 3);
  to.records("crossings", events);
  to.count("cells", 2, 9.0);
  const std::string bytes = to.bytes() + "more";
  Archive from("line", 3, bytes.data());
  from.records("crossings", found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].place[1], 6.0);
  EXPECT_EQ(from.count("cells", 0, 9.0), 2u);
  EXPECT_STREQ(from.rest(), "more");
  Archive fewer("line", 3, bytes.data());
  fewer.records("crossings", found);
  EXPECT_THROW(fewer.count("cells", 0, 1.0), std::runtime_error);
}

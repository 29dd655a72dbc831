// Sums, quantiles and files of a control line

#include "crossing_log.h"

#include <cmath>
#include <gtest/gtest.h>

using Slope::CrossingLog;

namespace {

CrossingLog::Event event(double step, double tag, int direction, double value)
{
  CrossingLog::Event e = CrossingLog::Event();
  e.time = 0.1 * step;
  e.step = step;
  e.tag = tag;
  e.direction = direction;
  e.speed = value;
  e.height = 10.0 * value;
  e.energy = 100.0 * value;
  e.volume = 2.0;
  e.diameter = 1.25;
  return e;
}

CrossingLog twenty()
{
  CrossingLog log;
  for (int k = 20; k >= 1; k--) log.events.push_back(event(k, k, 1, k));
  log.events.push_back(event(30, 4, -1, 1000.0));
  log.events.push_back(event(31, 4, 1, 0.5));
  log.sort();
  return log;
}

}    // namespace

TEST(CrossingLog, VolumesByDirection)
{
  const CrossingLog log = twenty();
  EXPECT_EQ(log.way(1).crossings, 21.0);
  EXPECT_EQ(log.way(1).balls, 20.0);
  EXPECT_EQ(log.way(1).volume, 42.0);
  EXPECT_EQ(log.way(-1).crossings, 1.0);
  EXPECT_EQ(log.way(-1).volume, 2.0);
}

TEST(CrossingLog, QuantilesAreOfTheForwardCrossings)
{
  CrossingLog log = twenty();
  EXPECT_EQ(log.quantile(1.0).speed, 20.0);
  log.events.pop_back();    // without 0.5: 1 to 20
  EXPECT_EQ(log.quantile(0.5).speed, 10.0);
  EXPECT_EQ(log.quantile(0.9).height, 180.0);
  EXPECT_EQ(log.quantile(0.95).energy, 1900.0);    // 19 of 20, whatever 0.95 * 20 rounds to
  EXPECT_EQ(log.quantile(0.99).speed, 20.0);
}

TEST(CrossingLog, AHeightThatIsNotKnownDoesNotCount)
{
  CrossingLog log;
  log.events = {event(1, 1, 1, 3.0), event(2, 2, 1, 4.0)};
  log.events[1].height = NAN;
  EXPECT_EQ(log.quantile(1.0).height, 30.0);
  EXPECT_EQ(log.quantile(1.0).speed, 4.0);
  EXPECT_NE(log.csv().find("0.2,2,2,1,0,0,0,0,,0,0,0,4,400,2,1.25\n"), std::string::npos) << log.csv();
}

TEST(CrossingLog, OrderDoesNotDependOnWhoSawWhat)
{
  CrossingLog one = twenty(), other = twenty();
  std::swap(other.events.front(), other.events.back());
  std::swap(other.events[3], other.events[11]);
  other.sort();
  EXPECT_EQ(one.csv(), other.csv());
  EXPECT_EQ(one.csv().substr(0, 30), "time,step,ball,direction,along");
}

TEST(CrossingLog, TheWayThatMoreVolumeWentCounts)
{
  CrossingLog log;
  EXPECT_EQ(log.main_direction(), 1);
  log.events = {event(1, 1, -1, 3.0), event(2, 2, -1, 4.0), event(3, 3, 1, 5.0)};
  EXPECT_EQ(log.main_direction(), -1);
  EXPECT_EQ(log.quantile(1.0).speed, 4.0);
  EXPECT_NE(log.yaml().find("direction: back\n"), std::string::npos) << log.yaml();
}

// reset_timestep between two runs
TEST(CrossingLog, OrderIsThatOfTimeThoughStepsAreCountedAnew)
{
  CrossingLog log;
  log.events = {event(7, 1, 1, 1.0), event(2, 2, 1, 1.0)};
  log.events[1].time = 0.9;
  log.sort();
  EXPECT_EQ(log.events[0].step, 7.0);
}

TEST(CrossingLog, NothingCrossed)
{
  const CrossingLog log;
  EXPECT_EQ(log.quantile(0.5).speed, 0.0);
  EXPECT_NE(log.yaml().find("forward: {crossings: 0, balls: 0, volume: 0.0}\n"), std::string::npos);
  EXPECT_NE(log.yaml().find("first_time: null\n"), std::string::npos);
  EXPECT_NE(log.yaml().find("quantiles: []\n"), std::string::npos);
}

TEST(CrossingLog, SummaryHasTheNumbers)
{
  const std::string text = twenty().yaml();
  EXPECT_NE(text.find("forward: {crossings: 21, balls: 20, volume: 42.0}\n"), std::string::npos) << text;
  EXPECT_NE(text.find("net_volume: 40.0\n"), std::string::npos);
  EXPECT_NE(text.find("last_time: 3.1\n"), std::string::npos);
  EXPECT_NE(text.find("largest: {speed: 20.0, height: 200.0, energy: 2000.0}\n"), std::string::npos);
  EXPECT_NE(text.find("  - {share: 0.9, speed: 18.0, height: 180.0, energy: 1800.0}\n"), std::string::npos) << text;
}

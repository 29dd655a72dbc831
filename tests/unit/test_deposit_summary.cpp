/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// What is called at rest, and how the summary's text says what it says; that it is YAML is tested on
// the summaries of decks.

#include "deposit_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

using Slope::DepositSummary;

static DepositSummary halted(double fast)
{
  DepositSummary s = DepositSummary();
  s.reason = "halted";
  s.motion.fast_share = fast;
  s.rest_share = 0.01;
  return s;
}

static bool has(const std::string &text, const std::string &line)
{
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

TEST(DepositSummary, AtRest)
{
  EXPECT_TRUE(halted(0.0).at_rest());
  EXPECT_TRUE(halted(0.0099).at_rest());
  EXPECT_FALSE(halted(0.01).at_rest());
  DepositSummary wider = halted(0.02);
  wider.rest_share = 0.03;
  EXPECT_TRUE(wider.at_rest());
  EXPECT_NE(wider.text().find("  rest_share: 0.03  #"), std::string::npos);
  for (const char *reason : {"run completed", "time limit", "running"}) {
    DepositSummary s = halted(0.0);
    s.reason = reason;
    EXPECT_FALSE(s.at_rest()) << reason;    // cut: whatever moves
  }
}

TEST(DepositSummary, Release)
{
  DepositSummary s = halted(0.0);
  s.bulk_factor = 6.0 / 3.14159265358979323846;
  EXPECT_TRUE(has(s.text(), "  region: null"));
  EXPECT_TRUE(has(s.text(), "  body_volume: null"));
  s.released = {{12.0, 6.25, 0.0, 0.0, {}}, 10.0, 10.0, 4.5, 0.0, 2.0e4};
  s.region = "it's";
  s.bulk_factor = 1.6;
  EXPECT_NEAR(s.from_cubic(), 1.6 / 1.9098593171027440 - 1.0, 1e-15);
  for (const char *line : {"  region: 'it''s'", "  body_volume: 10.0", "  ball_volume: 6.25",
                           "  balls: 12", "  bulk_factor: 1.6", "bulk_factor: 1.6"})
    EXPECT_TRUE(has(s.text(), line)) << line;
}

TEST(DepositSummary, Travel)
{
  DepositSummary s = halted(0.0);
  s.released.front = 4.0;
  s.released.mass = {1.0, 1.0, 0.0, 0.0, {1.0, 2.5, 3e-7}};
  s.travel = {5.0, {60.0, 17.5}, {{0.5, {30.0, 33.0}}, {0.95, {55.0, 18.25}}}};
  s.travel.quantiles.push_back({0.99, {HUGE_VAL, HUGE_VAL}});
  for (const char *line :
       {"  top: [1.0, 2.5, 3.0e-07]", "  front: 60.0", "  reach_angle: 17.5",
        "  farthest: {distance: 60.0, reach_angle: 17.5}", "  front_at_release: 4.0",
        "    - {share: 0.5, distance: 30.0, reach_angle: 33.0}",
        "    - {share: 0.95, distance: 55.0, reach_angle: 18.25}",
        "    - {share: 0.99, distance: null, reach_angle: null}"})
    EXPECT_TRUE(has(s.text(), line)) << line;
}

TEST(DepositSummary, Motion)
{
  DepositSummary s = halted(0.0);
  s.motion = {0.1, 4.5, 0.001, 0.1001, 700.0, 0.0625, 10.0};
  EXPECT_TRUE(has(s.text(), "moving: true"));
  EXPECT_TRUE(has(s.text(), "  fast_volume: 700.0"));
  EXPECT_TRUE(has(s.text(), "  fast_speed: 4.5"));
  EXPECT_NE(s.text().find("fast: than 10.0\n"), std::string::npos);
  EXPECT_NE(s.text().find("  fast_share: 0.0625  #"), std::string::npos);
  EXPECT_NE(s.text().find("\nat_rest: false  #"), std::string::npos);
  s.motion = {0.1, 4.5, 0.001, 0.1, 7.0, 0.000625, 10.0};
  EXPECT_TRUE(has(s.text(), "moving: false"));
  EXPECT_NE(s.text().find("\nat_rest: true  #"), std::string::npos);
}

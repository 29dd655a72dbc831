/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// What left the box is counted once, whichever way it went, and the first balls get a line.

#include "mass_ledger.h"

#include <gtest/gtest.h>

using Slope::MassLedger;

static MassLedger::Mass mass(double number, double volume)
{
  MassLedger::Mass found;
  found.number = number;
  found.volume = volume;
  return found;
}

TEST(MassLedger, LossesOfRanks)
{
  MassLedger ledger;
  ledger.lose(mass(2, 3.5));
  ledger.lose(mass(1, 0.5));
  EXPECT_EQ(ledger.lost_here().number, 3);
  EXPECT_EQ(ledger.lost_here().volume, 4.0);
  ledger.take_here(mass(5, 10.0));    // this rank's and others'
  EXPECT_EQ(ledger.lost_here().number, 0);
  ledger.take_here(mass(1, 1.0));
  EXPECT_EQ(ledger.lost.number, 6);
  EXPECT_EQ(ledger.lost.volume, 11.0);
  EXPECT_EQ(ledger.residual(100.0, 80.0, 8.0), 1.0);
}

// balls outside of the box when a command begins are lost if they are gone at its end
TEST(MassLedger, LossesInACommand)
{
  MassLedger ledger;
  EXPECT_FALSE(ledger.in_command());
  ledger.begin_command(mass(4, 8.0));
  EXPECT_TRUE(ledger.in_command());
  ledger.end_command(mass(1, 2.0));
  EXPECT_FALSE(ledger.in_command());
  EXPECT_EQ(ledger.lost_here().number, 3);
  EXPECT_EQ(ledger.lost_here().volume, 6.0);
}

TEST(MassLedger, TheFirstFiveGetALine)
{
  MassLedger ledger;
  for (int k = 0; k < 9; k++) ledger.note({100.0 - k, {1.5, 2.0, -3.25}, 40.0 + k / 3});
  std::vector<MassLedger::Loss> notes = ledger.take_notes();
  EXPECT_EQ(notes.size(), 5u);
  EXPECT_TRUE(ledger.take_notes().empty());

  // by step, then by ball, wherever they are from
  notes.push_back({7.0, {0.0, 0.0, 0.0}, 39.0});
  const auto lines = ledger.lines(notes, 12.0);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0], "ball 7 left the box at 0 0 0, step 39, lost so far: 13");
  EXPECT_EQ(lines[1], "ball 98 left the box at 1.5 2 -3.25, step 40, lost so far: 14");
  EXPECT_EQ(lines[3], "ball 100 left the box at 1.5 2 -3.25, step 40, lost so far: 16");
  EXPECT_EQ(lines[4],
            "ball 96 left the box at 1.5 2 -3.25, step 41, lost so far: 17, more are only counted");
  EXPECT_FALSE(ledger.must_log());
  EXPECT_TRUE(ledger.lines(notes, 17.0).empty());
}

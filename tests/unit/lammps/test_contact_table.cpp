// Laws from the words of pair_style and pair_coeff, and from the balls of all ranks what can touch, how near and in
// which step

#include "archive.h"
#include "contact_table.h"
#include "deck.h"
#include "lammps_compat.h"

#include <cstring>

using namespace LAMMPS_NS;

struct Table {
  Deck deck{4};
  ContactTable table{deck.lmp.get()};
  static constexpr double DENSITY = 2650.0;

  Table()
  {
    table.allocate();
    deck.add_ball(1, 1.0, 0.2, DENSITY);
    deck.add_ball(1, 9.0, 0.4, DENSITY);
    deck.add_ball(2, 5.0, 0.3, DENSITY);
    deck.add_ball(3, 9.5, 0.6, DENSITY);    // held
    deck.one("group held type 3");
  }

  void settings(std::vector<std::string> words)
  {
    std::vector<char *> arg;
    for (std::string &word : words) arg.push_back(&word[0]);
    ContactSettings its;
    its.read(deck.lmp.get(), static_cast<int>(arg.size()), arg.data());
    table.set(its);
  }

  void coeff(int i, int j, std::vector<std::string> words)
  {
    std::vector<char *> arg;
    for (std::string &word : words) arg.push_back(&word[0]);
    ContactCoeffs c;
    c.read(deck.lmp.get(), "test", static_cast<int>(arg.size()), arg.data());
    table.set(i, j, c);
  }

  void find_ranges() { table.find_ranges(compat::group_bit(deck.lmp.get(), "held")); }
};

// dashpots that give the restitution: e = exp(-pi zeta/sqrt(1 - zeta^2)), c = 2 zeta sqrt(k m)
TEST(ContactTable, Laws)
{
  Table t;
  t.coeff(1, 2, {"stiffness", "2e6", "1e6", "restitution", "0.3", "friction", "30", "rolling", "0.05"});
  const double log_e = std::log(0.3), zeta = -log_e / std::hypot(std::acos(-1.0), log_e);
  const Slope::ContactLaw &law = t.table.law(2, 1);    // in both orders
  EXPECT_DOUBLE_EQ(law.kn, 2e6);
  EXPECT_NEAR(law.normal(7.0).c, 2.0 * zeta * std::sqrt(2e6 * 7.0), 1e-3 * law.normal(7.0).c);
  EXPECT_NEAR(law.friction, std::tan(std::acos(-1.0) / 6.0), 1e-12);
  EXPECT_DOUBLE_EQ(law.rolling, 0.05);
  EXPECT_TRUE(t.table.is_exact());
  EXPECT_FALSE(t.table.is_set(1, 1));
}

TEST(ContactTable, Settings)
{
  Table t;
  t.coeff(1, 1, {"stiffness", "2e6", "1e6", "damping", "100", "50"});
  t.settings({"mass", "ball", "scheme", "plain", "rolling_radius", "reduced", "limit_damping", "yes"});
  const Slope::ContactLaw &law = t.table.law(1, 1);
  EXPECT_FALSE(t.table.is_exact());
  EXPECT_EQ(law.mass_factor, 2.0);
  EXPECT_EQ(law.rolling_factor, 1.0);
  EXPECT_EQ(law.fn_least, 0.0);
  EXPECT_EQ(law.exact, 0.0);
  EXPECT_DOUBLE_EQ(law.normal(7.0).c, 100.0);
  t.settings({});    // back to what is without words
  EXPECT_TRUE(t.table.is_exact());
  EXPECT_EQ(t.table.law(1, 1).mass_factor, 1.0);
}

// balls of any rank count; frozen ones do not touch one another, and a wall only what moves
TEST(ContactTable, WhatCanTouch)
{
  Table t;
  for (int i = 1; i <= 4; i++)
    for (int j = i; j <= 4; j++) t.coeff(i, j, {"stiffness", "2e6", "1e6", "restitution", "0.3"});
  t.find_ranges();
  EXPECT_TRUE(t.table.can_touch(1, 2));
  EXPECT_TRUE(t.table.can_touch(3, 1));
  EXPECT_FALSE(t.table.can_touch(3, 3));
  EXPECT_FALSE(t.table.balls_can_touch(3, 3));
  EXPECT_FALSE(t.table.can_touch(1, 4));
  t.table.add_wall(4, 1, "test");
  EXPECT_TRUE(t.table.can_touch(1, 4));
  EXPECT_FALSE(t.table.can_touch(3, 4));
  EXPECT_FALSE(t.table.balls_can_touch(1, 4));
  EXPECT_NEAR(t.table.cutoff(1, 2), 0.2 + 0.15, 1e-12);
  EXPECT_NEAR(t.table.cutoff(1, 3), 0.2 + 0.3, 1e-12);
  EXPECT_EQ(t.table.cutoff(3, 3), 0.3);    // no frozen with frozen
  EXPECT_EQ(t.table.cutoff(4, 4), 0.0);
}

// the step of the lightest moving ball: sqrt(m/kn)/4, and with scheme plain 0.15 m/cn
TEST(ContactTable, Step)
{
  Table t;
  t.coeff(1, 2, {"stiffness", "2e6", "1e6", "damping", "500", "50"});
  t.coeff(1, 3, {"stiffness", "8e6", "1e6", "restitution", "1"});
  t.find_ranges();
  const double light = Deck::mass(0.2, Table::DENSITY);
  EXPECT_NEAR(t.table.lightest(1, 2), light, 1e-9 * light);
  EXPECT_NEAR(t.table.bound_on_step(1, 2), 0.25 * std::sqrt(light / 2e6), 1e-12);
  EXPECT_NEAR(t.table.bound_on_step(1, 3), 0.25 * std::sqrt(light / 8e6), 1e-12);
  t.settings({"scheme", "plain"});
  EXPECT_NEAR(t.table.dashpot_bound(1, 2), 0.15 * light / 500.0, 1e-12);
  EXPECT_EQ(t.table.dashpot_bound(1, 3), HUGE_VAL);
}

// the laws of a table that a restart file has are those of the one that wrote it, to the bit
TEST(ContactTable, Restart)
{
  Table t, other;
  t.coeff(1, 2, {"stiffness", "2e6", "1e6", "restitution", "0.3", "friction", "30", "rolling", "0.05"});
  t.coeff(2, 2, {"stiffness", "3e6", "0", "damping", "500", "0", "rolling_spring", "1e4", "7"});
  t.settings({"mass", "ball", "scheme", "plain"});
  Slope::Archive settings("pair_style", 1), coeffs("pair_coeff", 1);
  t.table.archive_settings(settings);
  t.table.archive_coeffs(coeffs);
  Slope::Archive from("pair_style", 1, settings.bytes().data()), more("pair_coeff", 1, coeffs.bytes().data());
  other.table.archive_settings(from);
  other.table.archive_coeffs(more);
  EXPECT_FALSE(other.table.is_exact());
  EXPECT_FALSE(other.table.is_set(1, 1));
  for (const int i : {1, 2})
    EXPECT_EQ(memcmp(&t.table.law(i, 2), &other.table.law(i, 2), sizeof(Slope::ContactLaw)), 0) << i;
  EXPECT_EQ(other.table.law(2, 2).kr, 1e4);
  for (const char *name : {"mass", "limit_damping", "rolling_radius", "scheme"})
    EXPECT_NE(settings.bytes().find(name), std::string::npos) << name;
  for (const char *name : {"kn", "kt", "restitution", "cn", "ct", "friction", "rolling", "kr", "cr"})
    EXPECT_NE(coeffs.bytes().find(name), std::string::npos) << name;
}

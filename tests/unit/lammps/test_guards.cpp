// What the guards of contacts and of energy find in a run, on all ranks

#include "contact_guards.h"
#include "contact_table.h"
#include "deck.h"
#include "energy_guard.h"
#include "lammps_compat.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;

static constexpr double DENSITY = 2000.0;

struct Guarded {
  Deck deck{2};
  ContactTable table{deck.lmp.get()};
  ContactGuards guards{deck.lmp.get(), table};

  Guarded()
  {
    deck.add_ball(1, 1.0, 0.2, DENSITY);
    deck.add_ball(1, 9.0, 0.2, DENSITY);
    table.allocate();
    set({"stiffness", "2e6", "1e6", "restitution", "0.3"});
    table.find_ranges(0);
    deck.one("neigh_modify delay 0 every 1 check yes");
    deck.one("fix move all nve/sphere");
    deck.lmp->neighbor->ndanger = 0;    // as before a run
    deck.lmp->update->dt = 0.99 * table.bound_on_step(1, 1);
  }

  void set(std::vector<std::string> words)
  {
    std::vector<char *> arg;
    for (std::string &word : words) arg.push_back(&word[0]);
    ContactCoeffs c;
    c.read(deck.lmp.get(), "1 1", static_cast<int>(arg.size()), arg.data());
    table.set(1, 1, c);
  }

  // warnings are on rank 0 alone
  void expect(const std::vector<std::string> &parts)
  {
    const size_t wanted = deck.me() == 0 ? parts.size() : 0;
    ASSERT_EQ(guards.warnings.size(), wanted);
    for (size_t k = 0; k < wanted; k++) EXPECT_NE(guards.warnings[k].find(parts[k]), std::string::npos) << guards.warnings[k];
  }
};

TEST(ContactGuards, Start)
{
  Guarded g;
  g.deck.lmp->update->dt = 2.0 * g.table.bound_on_step(1, 1);
  g.deck.one("neigh_modify delay 5");
  g.deck.one("unfix move");
  g.deck.one("group one id 1");
  g.deck.one("fix move one nve/sphere");
  g.guards.start(0);
  g.guards.start(0);    // each is noted once
  g.expect({"2 times the rule's", "delay 5"});
}

// seen on any rank: the deepest, how many are deeper than a tenth of the radius
TEST(ContactGuards, Overlaps)
{
  Guarded g;
  g.guards.start(0);
  int i;
  for (int n = 0; n < 3; n++)
    if (g.deck.with(1, i)) g.guards.record_overlap(i, 0.012, 0.1);
  if (g.deck.with(2, i)) g.guards.record_overlap(i, 0.03, 0.1);
  if (g.deck.with(2, i)) g.guards.record_overlap(i, 0.009, 0.1);
  const ContactGuards::Found found = g.guards.found();
  EXPECT_EQ(found.deep, 4);
  EXPECT_DOUBLE_EQ(found.deepest, 0.3);
  g.guards.report();
  g.expect({"4 contacts were seen deeper than 10 % of the smaller radius, the deepest 30 % (ball 2"});
  g.guards.start(0);    // of a new run
  EXPECT_EQ(g.guards.found().deep, 0);
}

// --- energy ---

struct Energy {
  Deck deck;
  EnergyGuard guard{deck.lmp.get()};
  const double m = Deck::mass(0.2, DENSITY);

  Energy()
  {
    deck.add_ball(1, 1.0, 0.2, DENSITY);
    deck.add_ball(1, 9.0, 0.2, DENSITY);
    deck.one("fix move all nve/sphere");
  }

  void speeds(double v)    // of both balls
  {
    for (int k = 0; k < deck.lmp->atom->nlocal; k++) deck.lmp->atom->v[k][1] = v;
  }
};

// kinetic energy of both and springs of all ranks; warned of once, when more than 4 % of the largest
TEST(EnergyGuard, Growth)
{
  Energy e;
  e.guard.start();
  e.speeds(10.0);
  EXPECT_FALSE(e.guard.check(0.0));
  e.speeds(10.1);    // 2 % more
  EXPECT_FALSE(e.guard.check(0.0));
  EXPECT_NEAR(e.guard.growth(), 1.0 - 1.0 / (1.01 * 1.01), 1e-9);
  EXPECT_EQ(e.guard.seen(), 0);
  e.speeds(10.0);
  const double spring = 0.1 * e.m * 100.0;    // 10 % of the kinetic energy of two balls
  EXPECT_TRUE(e.guard.check(e.deck.me() == 0 ? spring : 0.0));
  EXPECT_NEAR(e.guard.growth(), 0.1 / 1.1, 1e-9);
  EXPECT_FALSE(e.guard.check(e.deck.me() == 0 ? spring : 0.0));
  EXPECT_EQ(e.guard.seen(), 2);
}

// a ball that turns at w has 0.2 m r^2 w^2
TEST(EnergyGuard, Spin)
{
  Energy e;
  e.guard.start();
  e.speeds(10.0);
  EXPECT_FALSE(e.guard.check(0.0));
  int i;
  if (e.deck.with(2, i)) e.deck.lmp->atom->omega[i][2] = 100.0;
  const double spin = 0.2 * e.m * 0.01 * 1e4, moving = e.m * 100.0;
  EXPECT_TRUE(e.guard.check(0.0));
  EXPECT_NEAR(e.guard.growth(), spin / (moving + spin), 1e-9);
}

// what falls gains no energy, only speed: it has lost height
TEST(EnergyGuard, Fall)
{
  Energy e;
  e.deck.one("fix fall all gravity 10 vector 0 0 -1");
  compat::fix_by_id(e.deck.lmp.get(), "fall")->init();
  e.guard.start();
  e.speeds(0.0);
  EXPECT_FALSE(e.guard.check(0.0));
  for (int k = 0; k < e.deck.lmp->atom->nlocal; k++) {
    e.deck.lmp->atom->x[k][2] -= 0.2;
    e.deck.lmp->atom->v[k][2] = -2.0;    // sqrt(2 g h)
  }
  EXPECT_FALSE(e.guard.check(0.0));
  EXPECT_LT(e.guard.growth(), 1e-9);
  for (int k = 0; k < e.deck.lmp->atom->nlocal; k++) e.deck.lmp->atom->v[k][2] = -3.0;
  EXPECT_TRUE(e.guard.check(0.0));
}

// What the springs of a contact can give back, and this rank's share of it

#include "contact_energy.h"
#include "one_contact.h"

#include <gtest/gtest.h>

using namespace OneContact;

namespace {

const double OVERLAP = 1e-4, FRICTION = 0.5;
const double NORMAL = 0.5 * KN * OVERLAP * OVERLAP;
const double LIMIT = FRICTION * KN * OVERLAP;

struct Sliding {
  ContactLaw law;
  Contact contact;
  double history[HISTORY];

  explicit Sliding(double zeta) : law(law_of_ratio(zeta, false)), contact(still_contact(OVERLAP)), history()
  {
    law.friction = FRICTION;
  }
  double energy() const { return elastic_energy(on_fixed(law, 1e-5), contact, history); }    // plain: the law itself
};

}    // namespace

TEST(ContactEnergy, NormalAndTangentialSprings)
{
  Sliding ball(0.1);
  EXPECT_NEAR(ball.energy() / NORMAL, 1.0, 1e-12);
  ball.history[0] = 2e-5;
  EXPECT_NEAR(ball.energy() / (NORMAL + 0.5 * KN * 4e-10), 1.0, 1e-12);
}

TEST(ContactEnergy, NoMoreThanFrictionLetsThrough)
{
  Sliding ball(0.1);
  ball.history[0] = -9e-4;
  EXPECT_NEAR(ball.energy() / (NORMAL + 0.5 * LIMIT * LIMIT / KN), 1.0, 1e-12);
}

// at F = k s + c u on the limit, with a dashpot that alone is beyond it, s points against u
TEST(ContactEnergy, NothingInASpringThatBalancesItsDashpot)
{
  Sliding ball(8.0);
  const double c = ball.law.ct_root * std::sqrt(MASS), u = 3.0 * LIMIT / c;
  ball.contact.v[0] = u;
  ball.history[0] = (LIMIT - c * u) / KN;
  ASSERT_LT(ball.history[0], 0.0);
  EXPECT_NEAR(ball.energy() / NORMAL, 1.0, 1e-12);

  // slower, the spring points with the motion, and holds energy again
  const double slow = 0.3 * LIMIT / c;
  ball.contact.v[0] = slow;
  ball.history[0] = (LIMIT - c * slow) / KN;
  EXPECT_NEAR(ball.energy() / (NORMAL + 0.5 * 0.49 * LIMIT * LIMIT / KN), 1.0, 1e-9);
}

// a spring that unloads without sliding points against the motion, too, but gives its energy back
TEST(ContactEnergy, AllOfASpringThatUnloads)
{
  Sliding ball(0.1);
  ball.history[0] = -2e-5;
  ball.contact.v[0] = 2.0 * KN * 2e-5 / (ball.law.ct_root * std::sqrt(MASS));
  EXPECT_NEAR(ball.energy() / (NORMAL + 0.5 * KN * 4e-10), 1.0, 1e-12);
}

TEST(ContactEnergy, RollingSpring)
{
  Sliding ball(0.1);
  ball.law.rolling = 0.2;
  ball.history[3] = 1e-5;
  EXPECT_NEAR(ball.energy() / (NORMAL + 0.5 * KN * 1e-10), 1.0, 1e-12);
  ball.history[3] = 1.0;
  EXPECT_NEAR(ball.energy() / (NORMAL + 0.5 * 0.04 * KN * OVERLAP * OVERLAP), 1.0, 1e-12);
}

// two contacts of a list, one of them shared with another rank, and a pair that does not touch
TEST(ContactEnergy, ShareOfThisRank)
{
  const double apart = touching(0.1, 0.1) - OVERLAP;
  std::vector<Vector> x = {{0.0, 0.0, 0.0}, {0.0, 0.0, apart}, {apart, 0.0, 0.0}, {0.0, 0.5, 0.0}};
  std::vector<Vector> still(4, {0.0, 0.0, 0.0});
  std::vector<double> radius(4, RADIUS), mass(4, MASS);
  std::vector<unsigned char> counts(4, 0);
  const MovingBalls balls = {x.data(),     still.data(), still.data(), radius.data(), mass.data(),
                             still.data(), still.data(), still.data(), counts.data(), nullptr};
  double history[3][HISTORY] = {};
  ContactList list;
  for (int j = 1; j < 4; j++) list.add(0, j, history[j - 1], false, RADIUS, RADIUS, MASS, MASS);
  list.find(false, balls, MovingPartners{balls, 2});
  int seen = 0;
  auto see = [&](const ContactList::Entry &, double overlap) {
    EXPECT_NEAR(overlap, OVERLAP, 1e-15);
    seen++;
  };
  const double energy = elastic_energy(list, law_of(0.5), 1e-5, balls, MovingPartners{balls, 2}, see);
  EXPECT_NEAR(energy / NORMAL, 1.5, 1e-9);
  EXPECT_EQ(seen, 2);
}

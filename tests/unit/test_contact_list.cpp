// The list of contacts against one contact at a time: who touches, how many contacts each ball has,
// and the forces, of contacts alone and in company

#include "contact_list.h"
#include "one_contact.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

using namespace OneContact;

// every test with each kernel that this processor can run
class ContactLists : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override
  {
    if (!ContactKernels::all()[GetParam()].runs_here)
      GTEST_SKIP() << "not on this processor: " << ContactKernels::all()[GetParam()].name;
    ContactKernels::set_current(GetParam());
  }
};

INSTANTIATE_TEST_SUITE_P(Kernel, ContactLists, ::testing::Range<int>(0, ContactKernels::all().size()),
                         [](const ::testing::TestParamInfo<int> &info) {
                           std::string name = ContactKernels::all()[info.param].name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// groups of a ball and three partners, some of which touch it now or did a step ago
struct Cloud {
  static constexpr int PARTNERS = 3;

  std::vector<Vector> x, v, omega, f, torque;
  std::vector<double> radius, mass;
  std::vector<unsigned char> count, count_before, estimated;
  std::vector<std::array<double, HISTORY>> history;
  ContactList list;

  // of eight groups, in turns
  static bool near(int k) { return "111110100000010000001101"[k % 24] == '1'; }
  static bool touched(int k) { return "101110100010011100000111"[k % 24] == '1'; }

  explicit Cloud(int groups, bool different)
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    auto add_ball = [&](Vector at) {
      const double size = different ? 0.1 + 0.02 * u(random) : 0.1;
      x.push_back(at);
      v.push_back({u(random), u(random), u(random)});
      omega.push_back({10.0 * u(random), 10.0 * u(random), 10.0 * u(random)});
      radius.push_back(size);
      mass.push_back(MASS * std::pow(size / 0.1, 3));
    };
    for (int g = 0; g < groups; g++) {
      add_ball({10.0 * g, 0.0, 0.0});
      const int i = static_cast<int>(x.size()) - 1;
      for (int p = 0; p < PARTNERS; p++) {
        const double a = PI * u(random), b = PI * u(random);
        add_ball({0.0, 0.0, 0.0});
        const double r = (radius[i] + radius.back()) * (near(g * PARTNERS + p) ? 0.999 : 1.01);
        x.back() = {x[i].x + r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b), r * std::cos(a)};
      }
    }
    const int contacts = groups * PARTNERS;
    history.resize(contacts);
    for (auto &h : history) {
      for (double &value : h) value = 1e-5 * u(random);
      h[PHASE] = 3.0;    // an impact
    }
    f.assign(x.size(), {0.0, 0.0, 0.0});
    torque = f;
    count.assign(x.size(), 0);
    count_before = estimated = count;
    list.clear();
    for (int k = 0; k < contacts; k++)
      list.add(i_of(k), j_of(k), history[k].data(), touched(k), radius[i_of(k)], radius[j_of(k)], mass[i_of(k)],
               mass[j_of(k)]);
  }

  static int i_of(int k) { return (k / PARTNERS) * (PARTNERS + 1); }
  static int j_of(int k) { return i_of(k) + 1 + k % PARTNERS; }

  MovingBalls balls()
  {
    return {x.data(), v.data(), omega.data(), radius.data(), mass.data(), f.data(), torque.data(), count.data(),
            count_before.data(), estimated.data()};
  }

  void forget_forces() { torque = f = std::vector<Vector>(x.size(), {0.0, 0.0, 0.0}); }
  void next_step()
  {
    count_before.swap(count);
    std::fill(count.begin(), count.end(), 0);
    forget_forces();
  }
};

// what one contact gives, by the functions of the law
struct Reference {
  std::vector<Vector> f, torque;
  std::vector<std::array<double, HISTORY>> history;
  std::vector<int> count, before;
  int lone, crowded, ended;

  Reference(Cloud &cloud, const ContactLaw &law, double dt) :
      f(cloud.x.size(), {0.0, 0.0, 0.0}), torque(f), history(cloud.history), count(f.size(), 0), before(f.size(), 0),
      lone(0), crowded(0), ended(0)
  {
    const int contacts = static_cast<int>(history.size());
    for (int k = 0; k < contacts; k++)
      for (int ball : {Cloud::i_of(k), Cloud::j_of(k)}) {
        count[ball] += Cloud::near(k);
        before[ball] += Cloud::touched(k);
      }
    for (int k = 0; k < contacts; k++) one(k, cloud, law, dt);
  }

  void one(int k, Cloud &cloud, const ContactLaw &law, double dt)
  {
    const int i = Cloud::i_of(k), j = Cloud::j_of(k);
    const bool now = Cloud::near(k), was = Cloud::touched(k), exact = law.exact > 0.0;
    const int company = std::max(count[i], count[j]) - now, old = std::max(before[i], before[j]) - was;
    double *h = history[k].data();
    if (!now && !(exact && was && company == 0 && old == 0)) return;

    const double ri = cloud.radius[i], rj = cloud.radius[j], mi = cloud.mass[i], mj = cloud.mass[j];
    const double inverse = 1.0 / mi + 1.0 / mj, rr = 2.0 * ri * rj / (ri + rj);
    const double turning = 2.5 * rr * rr * (1.0 / (mi * ri * ri) + 1.0 / (mj * rj * rj));
    const ContactStep step = contact_step(law, inverse, 1.0 / inverse, turning, dt, false);
    const LoneContact alone = lone_contact(law, inverse, 1.0 / inverse, turning,
                                           2.5 * rr * (1.0 / (mi * ri) - 1.0 / (mj * rj)), dt);
    Contact c;
    const double *xi = &cloud.x[i].x, *xj = &cloud.x[j].x, *vi = &cloud.v[i].x, *vj = &cloud.v[j].x;
    const double *wi = &cloud.omega[i].x, *wj = &cloud.omega[j].x;
    double rsq = 0.0;
    for (int d = 0; d < 3; d++) rsq += (xi[d] - xj[d]) * (xi[d] - xj[d]);
    c.overlap = ri + rj - std::sqrt(rsq);
    c.rolling_radius = rr;
    for (int d = 0; d < 3; d++) {
      c.n[d] = (xi[d] - xj[d]) / std::sqrt(rsq);
      c.v[d] = vi[d] - vj[d];
      c.rw[d] = ri * wi[d] + rj * wj[d];
      c.w[d] = wi[d] - wj[d];
    }
    if (now && !was) history[k].fill(0.0);
    const Life life = !now ? ENDS : was ? LASTS : BEGINS;
    ContactForce out;
    if (exact && company == 0 && (life == LASTS || old == 0)) {
      if (law.rolling > 0.0) lone_contact_force<true>(step, alone, life, false, c, h, out);
      else lone_contact_force<false>(step, alone, life, false, c, h, out);
      (life == ENDS ? ended : lone)++;
    } else {
      if (law.rolling > 0.0) contact_force<true>(step, c, static_cast<double>(company), h, out);
      else contact_force<false>(step, c, static_cast<double>(company), h, out);
      if (!was) h[PHASE] = BEGAN_IN_CROWD;
      crowded++;
    }
    double *fi = &f[i].x, *fj = &f[j].x, *ti = &torque[i].x, *tj = &torque[j].x;
    for (int d = 0; d < 3; d++) {
      fi[d] += out.f[d];
      fj[d] -= out.f[d];
      ti[d] += out.m[d] - ri * out.t[d];
      tj[d] += -out.m[d] - rj * out.t[d];
    }
  }
};

TEST_P(ContactLists, SameAsOneContactAtATime)
{
  const int groups = 70, contacts = 3 * groups;    // four blocks, the last not full
  const double dt = 1e-4;
  for (bool exact : {false, true})
    for (double rolling : {0.0, 0.1})
      for (bool different : {false, true}) {
        ContactLaw law = law_of(0.48, exact);
        law.friction = 0.3;
        law.rolling = rolling;
        Cloud cloud(groups, different);
        const Reference expected(cloud, law, dt);
        const MovingBalls balls = cloud.balls();
        const MovingPartners partners = {balls, static_cast<int>(cloud.x.size())};
        int tallied = 0;
        cloud.list.find(false, true, balls, partners);
        Vector sum = {0.0, 0.0, 0.0};
        auto visit = [&](int, int, const Vector &f, const Vector &) {
          tallied++;
          for (int d = 0; d < 3; d++) (&sum.x)[d] += (&f.x)[d];
        };
        ContactTally tally = tally_of(visit);
        cloud.list.apply(law, dt, false, balls, partners, &tally);
        for (int d = 0; d < 3; d++) EXPECT_EQ((&tally.force.x)[d], (&sum.x)[d]);
        EXPECT_EQ(cloud.list.equal, !different);
        EXPECT_EQ(tallied, expected.lone + expected.crowded + expected.ended);
        EXPECT_GT(expected.crowded, 40);
        if (exact) {
          EXPECT_GT(expected.lone, 5);
          EXPECT_GT(expected.ended, 1);
        }
        const double small = 1e-9 * KN * 1e-4;
        for (size_t b = 0; b < cloud.x.size(); b++)
          for (int d = 0; d < 3; d++) {
            EXPECT_NEAR((&cloud.f[b].x)[d], (&expected.f[b].x)[d], small) << b;
            EXPECT_NEAR((&cloud.torque[b].x)[d], (&expected.torque[b].x)[d], small) << b;
          }
        for (int k = 0; k < contacts; k++) {
          if (!Cloud::near(k)) continue;
          for (int h = 0; h < (rolling > 0.0 ? 6 : 3); h++)
            EXPECT_NEAR(cloud.history[k][h], expected.history[k][h], 1e-13) << k;
          EXPECT_EQ(cloud.history[k][PHASE], expected.history[k][PHASE]) << k;
        }
      }
}

TEST_P(ContactLists, CountsContactsOfEachBall)
{
  const ContactLaw law = law_of(0.48);
  Cloud cloud(20, true);
  const Reference expected(cloud, law, 1e-4);
  const int n = static_cast<int>(cloud.x.size());
  for (int own : {n, 41}) {    // partners from own on are those of another rank, and count there
    Cloud c(20, true);
    const MovingBalls balls = c.balls();
    const MovingPartners partners = {balls, own};
    c.list.find(false, true, balls, partners);
    for (int b = 0; b < n; b++) {
      const bool elsewhere = b % 4 != 0 && b >= own;
      EXPECT_EQ(c.count[b], elsewhere ? 0 : expected.count[b]) << b;
      EXPECT_EQ(c.count_before[b], elsewhere ? 0 : expected.before[b]) << b;
    }
    for (int k = 0; k < 60; k++) EXPECT_EQ(c.list.touches(k), Cloud::near(k));

    // the list is as before: the counts of the step before are kept, not found again
    c.next_step();
    c.list.find(false, false, c.balls(), MovingPartners{c.balls(), own});
    for (int b = 0; b < n; b++) EXPECT_EQ(c.count[b], c.count_before[b]) << b;
  }
}

TEST_P(ContactLists, CountsEndAt255)
{
  ContactList list;
  Cloud cloud(1, false);
  std::vector<std::array<double, HISTORY>> histories(300);
  for (auto &h : histories) list.add(0, 1, h.data(), true, 0.1, 0.1, MASS, MASS);
  const MovingBalls balls = cloud.balls();
  cloud.x[1] = {cloud.x[0].x, 0.0, 0.19};
  list.find(false, true, balls, MovingPartners{balls, 4});
  EXPECT_EQ(cloud.count[0], 255);
  EXPECT_EQ(cloud.count[1], 255);
}

// two balls of the paper, and a third that may touch the first
struct Trio {
  Vector x[3], v[3], omega[3], f[3], torque[3];
  double radius[3] = {0.1, 0.1, 0.1}, mass[3] = {MASS, MASS, MASS};
  unsigned char count[3] = {0, 0, 0}, before[3] = {0, 0, 0}, estimated[3] = {0, 0, 0};
  double history[2][HISTORY] = {{0.0}, {0.0}};
  ContactList list;
  ContactLaw law;
  double dt;
  bool first = true;

  explicit Trio(double friction) : law(law_of(0.48)), dt(rule_step())
  {
    law.friction = friction;
    for (int b = 0; b < 3; b++) v[b] = omega[b] = f[b] = torque[b] = {0.0, 0.0, 0.0};
    x[0] = {0.0, 0.0, 0.0};
    x[1] = {0.0, 0.0, 0.2 + 0.3 * dt};
    x[2] = {10.0, 0.0, 0.0};
    v[1] = {0.2, 0.0, -1.0};
    list.add(0, 1, history[0], false, 0.1, 0.1, MASS, MASS);
    list.add(0, 2, history[1], false, 0.1, 0.1, MASS, MASS);
  }

  MovingBalls balls() { return {x, v, omega, radius, mass, f, torque, count, before, estimated}; }

  void half_kick()
  {
    for (int b = 0; b < 3; b++)
      for (int d = 0; d < 3; d++) {
        (&v[b].x)[d] += 0.5 * dt * (&f[b].x)[d] / mass[b];
        (&omega[b].x)[d] += 0.5 * dt * (&torque[b].x)[d] / (0.4 * mass[b] * 0.01);
      }
  }

  void forces(bool again)
  {
    const MovingBalls all = balls();
    for (int b = 0; b < 3; b++) {
      if (!again) before[b] = count[b];
      count[b] = 0;
      f[b] = torque[b] = {0.0, 0.0, 0.0};
    }
    list.find(again, first && !again, all, MovingPartners{all, 3});
    first = false;
    list.apply(law, dt, again, all, MovingPartners{all, 3});
  }

  void step()
  {
    half_kick();
    for (int b = 0; b < 3; b++)
      for (int d = 0; d < 3; d++) (&x[b].x)[d] += dt * (&v[b].x)[d];
    forces(false);
  }
};

TEST_P(ContactLists, LifeOfALoneContact)
{
  Trio trio(10.0);
  EXPECT_FALSE(trio.list.has_history(0));
  int touching = 0, ended = 0;
  for (int k = 0; k < 40; k++) {
    const bool before = trio.list.touches(0);
    trio.step();
    const double phase = trio.history[0][PHASE];
    if (trio.list.touches(0)) {
      EXPECT_TRUE(trio.list.has_history(0));
      if (!before) {
        EXPECT_TRUE(is_new_impact(phase)) << phase;
      } else {
        EXPECT_EQ(std::floor(phase), touching + 1);
        EXPECT_TRUE(!has_slid(phase) || touching > 5) << touching;
      }
      EXPECT_EQ(trio.count[0], 1);
      touching++;
    } else if (before) {
      EXPECT_EQ(phase, ENDED);
      EXPECT_TRUE(trio.list.has_history(0));
      EXPECT_NE(trio.f[0].z, 0.0);

      // a list made now takes the history for one that has ended
      ContactList other;
      other.add(0, 1, trio.history[0], true, 0.1, 0.1, MASS, MASS);
      EXPECT_FALSE(other.touches(0));
      EXPECT_TRUE(other.has_history(0));
      ended++;
    } else {
      EXPECT_FALSE(trio.list.has_history(0));
      EXPECT_EQ(trio.f[0].z, 0.0);
    }
    trio.half_kick();
  }
  EXPECT_EQ(touching, 8);
  EXPECT_EQ(ended, 1);
  EXPECT_NEAR(trio.v[1].z - trio.v[0].z, 0.48, 1e-3);
}

// the forces of the step that has just ended once more, from what it left; what slid is flagged
TEST_P(ContactLists, AgainGivesTheForcesOfTheStep)
{
  for (double friction : {10.0, 0.05}) {
    Trio trio(friction);
    int same = 0, flagged = 0;
    for (int k = 0; k < 20; k++) {
      trio.step();
      const Vector f = trio.f[1];
      const double phase = trio.history[0][PHASE];
      const bool has = trio.list.has_history(0);
      for (unsigned char &e : trio.estimated) e = 0;
      trio.forces(true);
      if (trio.estimated[0]) {
        EXPECT_TRUE(trio.estimated[1] && !trio.estimated[2]);
        EXPECT_TRUE(has_slid(phase) || phase == ENDED);
        flagged++;
      } else if (has && !has_slid(phase) && phase != ENDED) {
        EXPECT_NEAR(trio.f[1].z, f.z, 1e-9 * std::fabs(f.z)) << k;
        EXPECT_NEAR(trio.f[1].x, f.x, 1e-9 * std::fabs(f.z)) << k;
        same++;
      }
      trio.f[1] = f;    // go on with those of the step
      trio.f[0] = {-f.x, -f.y, -f.z};
      trio.half_kick();
    }
    EXPECT_GT(friction > 1.0 ? same : flagged, 3);
  }
}

// a third ball that touches one of the two: the dashpots share what they take
TEST_P(ContactLists, CompanyCountsTheLargerOfTheTwo)
{
  for (bool company : {false, true}) {
    Trio trio(0.5);
    trio.x[1].z = 0.2 - 1e-5;
    trio.x[2] = {company ? 0.2 - 1e-5 : 0.3, 0.0, 0.0};
    trio.forces(false);
    EXPECT_EQ(trio.count[0], company ? 2 : 1);
    EXPECT_EQ(trio.count[1], 1);
    EXPECT_EQ(trio.count[2], company ? 1 : 0);
    Contact c = still_contact(1e-5);
    c.v[0] = 0.2;
    c.v[2] = -1.0;
    const ContactStep step = contact_step(trio.law, 2.0 / MASS, 0.5 * MASS, 5.0 / MASS, trio.dt, false);
    double history[HISTORY] = {0.0};
    ContactForce out;
    if (company) contact_force(step, c, 1.0, history, out);
    else lone_contact_force(step, lone_contact(trio.law, 2.0 / MASS, 0.5 * MASS, 5.0 / MASS, 0.0, trio.dt), BEGINS,
                            false, c, history, out);
    EXPECT_NEAR(trio.f[1].z, out.f[2], 1e-7 * out.f[2]);
    EXPECT_NEAR(trio.f[1].x, out.f[0], 1e-7 * out.f[2]);
    EXPECT_EQ(trio.history[0][PHASE], company ? BEGAN_IN_CROWD : 1.0);
  }
}

// balls that overlap before the first step have begun already, and are counted so
TEST_P(ContactLists, StartTakesOverlapsForOldContacts)
{
  Trio trio(0.5);
  trio.x[1].z = 0.2 - 1e-5;
  trio.history[0][0] = 7.0;
  const MovingBalls balls = trio.balls();
  int visits = 0;
  trio.list.adopt_overlaps(balls, MovingPartners{balls, 3}, [&](const ContactList::Entry &e, double overlap) {
    EXPECT_EQ(e.j, 1);
    EXPECT_NEAR(overlap, 1e-5, 1e-15);
    visits++;
  });
  EXPECT_EQ(visits, 1);
  EXPECT_TRUE(trio.list.touches(0));
  EXPECT_FALSE(trio.list.touches(1));
  EXPECT_EQ(trio.history[0][0], 0.0);
  trio.forces(false);
  EXPECT_EQ(trio.before[0], 1);
  EXPECT_EQ(trio.before[2], 0);
}

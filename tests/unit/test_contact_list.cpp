// The list of contacts against one contact at a time: who touches, how many contacts each ball has, and the
// forces, of contacts that last, begin and end

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

  std::vector<Vector> x, v, omega, ahead, f, torque;
  std::vector<double> radius, mass;
  std::vector<unsigned char> count;
  std::vector<FixedContacts> fixed;
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
      ahead.push_back({u(random), u(random), u(random)});
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
      h[AGE] = u(random) > 0.0 ? OLD : 0.6;    // of those that touched: it began a step ago
    }
    f.assign(x.size(), {0.0, 0.0, 0.0});
    torque = f;
    count.assign(x.size(), 0);
    fixed.resize(x.size());
    fill_list(touched);
  }

  template <class Has> void fill_list(Has has_history)
  {
    list.clear();
    for (int k = 0; k < static_cast<int>(history.size()); k++)
      list.add(i_of(k), j_of(k), history[k].data(), has_history(k), radius[i_of(k)], radius[j_of(k)], mass[i_of(k)],
               mass[j_of(k)]);
  }

  void list_again()    // as with a new neighbor list
  {
    std::vector<bool> had;
    for (size_t k = 0; k < history.size(); k++) had.push_back(list.has_history(k));
    fill_list([&](int k) { return had[k]; });
  }

  void evaluate(const ContactLaw &law, double dt)
  {
    forget_forces();
    std::fill(count.begin(), count.end(), 0);
    const MovingBalls all = balls();
    const MovingPartners partners = {all, static_cast<int>(x.size())};
    list.find(false, all, partners);
    list.apply(law, dt, false, all, partners);
  }

  static int i_of(int k) { return (k / PARTNERS) * (PARTNERS + 1); }
  static int j_of(int k) { return i_of(k) + 1 + k % PARTNERS; }

  MovingBalls balls()
  {
    return {x.data(), v.data(), omega.data(), radius.data(), mass.data(), f.data(), torque.data(), ahead.data(),
            count.data(), fixed.data()};
  }

  void forget_forces() { torque = f = std::vector<Vector>(x.size(), {0.0, 0.0, 0.0}); }
};

// what one contact gives, by the functions of the law
struct Reference {
  std::vector<Vector> f, torque;
  std::vector<std::array<double, HISTORY>> history;
  std::vector<int> count;
  int began = 0, lasted = 0, ended = 0;

  Reference(Cloud &cloud, const ContactLaw &law, double dt) :
      f(cloud.x.size(), {0.0, 0.0, 0.0}), torque(f), history(cloud.history), count(f.size(), 0)
  {
    const int contacts = static_cast<int>(history.size());
    for (int k = 0; k < contacts; k++)
      for (int ball : {Cloud::i_of(k), Cloud::j_of(k)}) count[ball] += Cloud::near(k);
    for (int k = 0; k < contacts; k++) one(k, cloud, law, dt);
  }

  static Contact contact_of(const Cloud &cloud, int i, int j, double &was, double dt)
  {
    Contact c;
    const double ri = cloud.radius[i], rj = cloud.radius[j];
    const double *xi = &cloud.x[i].x, *xj = &cloud.x[j].x, *vi = &cloud.v[i].x, *vj = &cloud.v[j].x;
    const double *wi = &cloud.omega[i].x, *wj = &cloud.omega[j].x;
    const double *ai = &cloud.ahead[i].x, *aj = &cloud.ahead[j].x;
    double rsq = 0.0, before = 0.0;
    for (int d = 0; d < 3; d++) {
      rsq += std::pow(xi[d] - xj[d], 2);
      before += std::pow(xi[d] - xj[d] - dt * (vi[d] - vj[d]), 2);
    }
    c.overlap = touching(ri, rj) - std::sqrt(rsq);
    was = touching(ri, rj) - std::sqrt(before);
    c.rolling_radius = 2.0 * ri * rj / (ri + rj);
    c.follow_whole_step();
    c.ahead = 0.0;
    for (int d = 0; d < 3; d++) {
      c.n[d] = (xi[d] - xj[d]) / std::sqrt(rsq);
      c.v[d] = vi[d] - vj[d];
      c.rw[d] = ri * wi[d] + rj * wj[d];
      c.w[d] = wi[d] - wj[d];
      c.ahead += (ai[d] - aj[d]) * c.n[d];
    }
    return c;
  }

  void one(int k, Cloud &cloud, const ContactLaw &law, double dt)
  {
    const int i = Cloud::i_of(k), j = Cloud::j_of(k);
    const bool now = Cloud::near(k), was = Cloud::touched(k), exact = law.exact > 0.0;
    double *h = history[k].data();
    if (!now && !(exact && was)) return;

    const double ri = cloud.radius[i], rj = cloud.radius[j], mi = cloud.mass[i], mj = cloud.mass[j];
    const double inverse = 1.0 / mi + 1.0 / mj, rr = 2.0 * ri * rj / (ri + rj);
    const double turning = 2.5 * rr * rr * (1.0 / (mi * ri * ri) + 1.0 / (mj * rj * rj));
    const ContactStep step = contact_step(law, 1.0 / mi, 1.0 / mj, 1.0 / inverse, turning, dt, false);
    double before;
    Contact c = contact_of(cloud, i, j, before, dt);
    const double age = h[AGE];
    if (now && !was) history[k].fill(0.0);
    if (exact && now != was) {
      const double vn = normal_velocity(c), r = touching(ri, rj) - c.overlap;
      const double across = c.v[0] * c.v[0] + c.v[1] * c.v[1] + c.v[2] * c.v[2] - vn * vn;
      const bool real = now ? before < 0.0 : before > 0.0;    // or the partner was put in place or taken away
      const double part = now ? (real ? c.overlap / (c.overlap - before) : 1.0)
                              : (real ? before / (before - c.overlap) : 0.0);
      const double late = real ? part - 0.5 : 0.0;
      c.weight = now ? (real ? part + 0.5 : 1.0) : real ? std::max(part, 1.0 - age) - 0.5 : 0.0;
      c.beyond = 0.5 * late * late * std::fabs(c.overlap - before);
      c.turn = real ? 0.5 * (now ? 0.5 - part : part - 1.5) * dt / r * across : 0.0;
      c.touches = now ? 1.0 : 0.0;
      c.first = now && real ? 1.0 : 0.0;
      c.grown = now ? part : 0.0;
      c.early = now ? 0.5 * dt * late * late : 0.0;
      h[AGE] = now ? (real ? part : OLD) : -age;
    } else if (exact) {
      h[AGE] = OLD;
    }
    (!now ? ended : was ? lasted : began)++;
    const double contacts = mean_contacts(step, 1.0 * count[i], 1.0 * count[j]);
    c.along = along_moving(contacts);
    if (exact && now != was) hold_beginning(step, c);
    ContactForce out;
    if (law.rolling > 0.0) contact_force<true>(step, c, contacts, h, out);
    else contact_force<false>(step, c, contacts, h, out);
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
        cloud.list.find(false, balls, partners);
        Vector sum = {0.0, 0.0, 0.0};
        auto visit = [&](int, int, const Vector &f, const Vector &) {
          tallied++;
          for (int d = 0; d < 3; d++) (&sum.x)[d] += (&f.x)[d];
        };
        ContactTally tally = tally_of(visit);
        cloud.list.apply(law, dt, false, balls, partners, &tally);
        for (int d = 0; d < 3; d++) EXPECT_EQ((&tally.force.x)[d], (&sum.x)[d]);
        EXPECT_EQ(cloud.list.equal, !different);
        EXPECT_EQ(tallied, expected.began + expected.lasted + expected.ended);
        EXPECT_GT(expected.began, 10);
        EXPECT_GT(expected.lasted, 40);
        EXPECT_TRUE(!exact || expected.ended > 10);
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
          if (exact) EXPECT_NEAR(cloud.history[k][AGE], expected.history[k][AGE], 1e-9) << k;
        }
      }
}

// What unequal balls make of the law is kept while a list lasts: as contacts come and go, the step changes
// and, where that is announced, masses do
TEST_P(ContactLists, WhatIsKeptOfUnequalBallsIsTheirs)
{
  ContactLaw law = law_of(0.48);
  law.friction = 0.3;
  law.rolling = 0.1;
  Cloud kept(70, true), anew(70, true);
  int ended = 0;
  for (int step = 0; step < 6; step++) {
    const bool masses_change = step == 5;
    const double dt = step < 3 ? 1e-4 : 2e-4;
    if (masses_change) {
      kept.list_again();
      kept.list.let_vary();
      kept.evaluate(law, dt);
      anew.list_again();
      anew.evaluate(law, dt);
    }
    for (Cloud *cloud : {&kept, &anew}) {
      for (size_t b = 0; b < cloud->x.size(); b++) {
        const double by = b % 4 == 0 || (b + step) % 5 ? 0.0 : step % 2 ? 0.001 : -0.001;
        cloud->x[b].x += by;
        cloud->v[b].x = by / dt;
        if (masses_change) cloud->mass[b] *= 1.0 + 0.1 * (b % 3);
      }
    }
    anew.list_again();
    anew.evaluate(law, dt);
    kept.evaluate(law, dt);
    int touching = 0;
    for (size_t k = 0; k < kept.history.size(); k++) {
      touching += kept.list.touches(k);
      ended += kept.list.has_history(k) && !kept.list.touches(k);
    }
    EXPECT_GT(touching, 40);
    for (size_t b = 0; b < kept.x.size(); b++)
      for (int d = 0; d < 3; d++) {
        EXPECT_EQ((&kept.f[b].x)[d], (&anew.f[b].x)[d]) << step << " " << b;
        EXPECT_EQ((&kept.torque[b].x)[d], (&anew.torque[b].x)[d]) << step << " " << b;
      }
  }
  EXPECT_GT(ended, 10);
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
    c.list.find(false, balls, partners);
    for (int b = 0; b < n; b++) {
      const bool elsewhere = b % 4 != 0 && b >= own;
      EXPECT_EQ(c.count[b], elsewhere ? 0 : expected.count[b]) << b;
    }
    for (int k = 0; k < 60; k++) EXPECT_EQ(c.list.touches(k), Cloud::near(k));
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
  list.find(false, balls, MovingPartners{balls, 4});
  EXPECT_EQ(cloud.count[0], 255);
  EXPECT_EQ(cloud.count[1], 255);
}

// of a ball on four fixed ones, walls' or held atoms of either side; the ball's dashpots know how they lie
TEST_P(ContactLists, FixedContactsOfABall)
{
  const double high = 0.14, out = std::sqrt(0.19 * 0.19 - high * high);
  std::vector<Vector> x = {{0.0, 0.0, high}}, still(5, {0.0, 0.0, 0.0}), v = still;
  for (int k = 0; k < 4; k++) x.push_back({out * std::cos(k * PI / 2.0), out * std::sin(k * PI / 2.0), 0.0});
  v[0].z = -1.0;
  const std::vector<double> radius(5, 0.1), mass(5, MASS);
  double up[3];
  for (int way = 0; way < 3; way++) {    // the ball first, last, on a wall
    std::vector<Vector> f = still, torque = still;
    std::vector<unsigned char> count(5, 0);
    std::vector<FixedContacts> fixed(5);
    const MovingBalls balls = {x.data(), v.data(), still.data(), radius.data(), mass.data(), f.data(),
                               torque.data(), v.data(), count.data(), fixed.data()};
    double histories[5][HISTORY] = {};
    ContactList list;
    list.clear(way != 1, way == 1);
    for (int k = 1; k < 5; k++)
      list.add(way == 1 ? k : 0, way == 1 ? 0 : k, histories[k], true, 0.1, 0.1, MASS, MASS);
    const FixedPartners wall(x.data(), radius.data(), FixedPartners::ONE);
    if (way == 2) {
      list.find(false, balls, wall);
      list.apply(law_of(0.1), 1.5 * rule_step(), false, balls, wall);
    } else {
      const MovingPartners partners = {balls, 5};
      list.find(false, balls, partners);
      list.apply(law_of(0.1), 1.5 * rule_step(), false, balls, partners);
    }
    EXPECT_EQ(fixed[0].number, 4.0);
    EXPECT_NEAR(fixed[0].normals.z, 4.0 * high / 0.2, 1e-12);
    EXPECT_NEAR(fixed[0].normals.x, 0.0, 1e-12);
    up[way] = f[0].z;
  }
  const ContactStep step = on_fixed(law_of(0.1), 1.5 * rule_step());
  const double z = high / 0.19, cn = step.cn * acting_together(step, 4.0 * z * high / 0.2);
  EXPECT_NEAR(up[2], 4.0 * z * (KN * (touching(0.1, 0.1) - 0.19) + cn * z), 1e-6 * up[2]);
  EXPECT_NEAR(up[0], up[2], 1e-9 * up[2]);
  EXPECT_NEAR(up[1], up[2], 1e-9 * up[2]);
}

// A watched list looks at few of its contacts, and sees the same: of balls that creep, fly and jump over dense ground
TEST_P(ContactLists, WatchedSeesWhatAllSee)
{
  for (bool different : {false, true}) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<Vector> ground, x;
    std::vector<double> radius, on_ground;
    for (int k = 0; k < 900; k++) {
      ground.push_back({0.04 * (k % 30) + 0.01 * u(random), 0.04 * (k / 30) + 0.01 * u(random), 0.01 * u(random)});
      on_ground.push_back(different ? 0.1 + 0.01 * u(random) : 0.1);
    }
    for (int b = 0; b < 41; b++) {
      x.push_back({0.6 + 0.5 * u(random), 0.6 + 0.5 * u(random), 0.2 + 0.01 * u(random)});
      radius.push_back(different ? 0.1 + 0.01 * u(random) : 0.1);
    }
    const std::vector<Vector> still(x.size(), {0.0, 0.0, 0.0});
    const std::vector<double> mass(x.size(), MASS);
    std::vector<unsigned char> count(x.size()), watched_count(x.size());
    std::vector<FixedContacts> fixed(x.size()), watched_fixed(x.size());
    const MovingBalls balls = {x.data(), still.data(), still.data(), radius.data(), mass.data(), nullptr, nullptr,
                               still.data(), count.data(), fixed.data()};
    MovingBalls same = balls;
    same.count = watched_count.data();
    same.fixed = watched_fixed.data();
    ContactList list, watched;
    for (int b = 0; b < 41; b++)
      for (int k = 0; k < 900; k++)
        for (ContactList *l : {&list, &watched})
          l->add(b, k, nullptr, false, radius[b], on_ground[k], MASS, 1.0);
    watched.watch(41);

    const FixedPartners wall(ground.data(), on_ground.data(), FixedPartners::EACH);
    int began = 0, ended = 0;
    for (int step = 0; step < 400; step++) {
      const double way = step < 200 ? 2e-5 : 2e-3;    // m, of a step
      for (Vector &at : x) at = {at.x + way * u(random), at.y + way * u(random), at.z + way * u(random)};
      if (step % 50 == 49) x[step % 41].z = 0.2 + 0.02 * u(random);
      std::vector<bool> before;
      for (size_t k = 0; k < list.entries.size(); k++) before.push_back(list.touches(k));
      list.find(false, balls, wall);
      watched.find(false, same, wall);
      for (size_t k = 0; k < list.entries.size(); k++) {
        ASSERT_EQ(watched.touches(k), list.touches(k)) << "contact " << k << " in step " << step;
        began += list.touches(k) && !before[k];
        ended += before[k] && !list.touches(k);
      }
      ASSERT_EQ(watched_count, count);
    }
    EXPECT_GT(began, 1000);
    EXPECT_GT(ended, 1000);
    EXPECT_GT(watched.memory_usage(), list.memory_usage());    // it has noted some
  }
}

// two balls of the paper, and a third that may touch the first
struct Trio {
  Vector x[3], v[3], omega[3], ahead[3], before[3], f[3], torque[3];
  double radius[3] = {0.1, 0.1, 0.1}, mass[3] = {MASS, MASS, MASS};
  unsigned char count[3] = {0, 0, 0};
  double history[2][HISTORY] = {{0.0}, {0.0}};
  ContactList list;
  ContactLaw law;
  double dt;

  explicit Trio(double friction) : law(law_of(0.48)), dt(rule_step())
  {
    law.friction = friction;
    for (int b = 0; b < 3; b++) v[b] = omega[b] = before[b] = f[b] = torque[b] = {0.0, 0.0, 0.0};
    x[0] = {0.0, 0.0, 0.0};
    x[1] = {0.0, 0.0, 0.2 + 0.3 * dt};
    x[2] = {10.0, 0.0, 0.0};
    v[1] = {0.2, 0.0, -1.0};
    list.add(0, 1, history[0], false, 0.1, 0.1, MASS, MASS);
    list.add(0, 2, history[1], false, 0.1, 0.1, MASS, MASS);
  }

  MovingBalls balls() { return {x, v, omega, radius, mass, f, torque, ahead, count, nullptr}; }

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
      count[b] = 0;
      for (int d = 0; d < 3; d++)
        (&ahead[b].x)[d] = (&v[b].x)[d] + AHEAD * dt * (&before[b].x)[d] / mass[b];
      f[b] = torque[b] = {0.0, 0.0, 0.0};
    }
    list.find(again, all, MovingPartners{all, 3});
    list.apply(law, dt, again, all, MovingPartners{all, 3});
  }

  void step()
  {
    std::copy(f, f + 3, before);
    half_kick();
    for (int b = 0; b < 3; b++)
      for (int d = 0; d < 3; d++) (&x[b].x)[d] += dt * (&v[b].x)[d];
    forces(false);
  }
};

TEST_P(ContactLists, LifeOfAContact)
{
  Trio trio(10.0);
  EXPECT_FALSE(trio.list.has_history(0));
  int touching = 0, ended = 0;
  for (int k = 0; k < 40; k++) {
    const bool before = trio.list.touches(0);
    trio.step();
    const double age = trio.history[0][AGE];
    if (trio.list.touches(0)) {
      EXPECT_TRUE(trio.list.has_history(0));
      if (before) EXPECT_EQ(age, OLD);
      else EXPECT_NEAR(age, 0.7, 1e-3);
      EXPECT_EQ(is_new(age), !before);
      EXPECT_EQ(trio.count[0], 1);
      touching++;
    } else if (before) {
      EXPECT_EQ(age, -OLD);
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
  EXPECT_EQ(touching, 9);     // 9.1 steps, of which 0.7 in the first
  EXPECT_EQ(ended, 1);
  EXPECT_NEAR(trio.v[1].z - trio.v[0].z, 0.48, 0.01);
}

// the forces of the step that has just ended once more, from what it left, in a list made anew
TEST_P(ContactLists, AgainGivesTheForcesOfTheStep)
{
  for (double friction : {10.0, 0.05}) {
    Trio trio(friction);
    int same = 0;
    for (int k = 0; k < 20; k++) {
      trio.step();
      const Vector f = trio.f[1];
      ContactList list;
      for (int p = 0; p < 2; p++)
        list.add(0, 1 + p, trio.history[p], trio.list.has_history(p), 0.1, 0.1, MASS, MASS);
      std::swap(list, trio.list);
      trio.forces(true);
      std::swap(list, trio.list);
      EXPECT_NEAR(trio.f[1].z, f.z, 1e-9 * std::fabs(f.z)) << k;
      EXPECT_NEAR(trio.f[1].x, f.x, 1e-9 * std::fabs(f.z)) << k;
      same += f.z != 0.0;
      trio.half_kick();
    }
    EXPECT_EQ(same, 10);
  }
}

// whatever rounding makes of the distance of two neighbours in a lattice
TEST_P(ContactLists, NeighboursInALatticeDoNotTouch)
{
  for (double rounding : {-1e-14, 0.0, 1e-14}) {
    Trio trio(0.5);
    trio.x[1].z = 0.2 * (1.0 + rounding);
    const MovingBalls balls = trio.balls();
    trio.list.adopt_overlaps(balls, MovingPartners{balls, 3},
                             [](const ContactList::Entry &, double) { ADD_FAILURE(); });
    trio.list.find(false, balls, MovingPartners{balls, 3});
    EXPECT_FALSE(trio.list.touches(0)) << rounding;
  }
}

// balls that overlap before the first step have begun already, and are counted so
TEST_P(ContactLists, StartTakesOverlapsForOldContacts)
{
  Trio trio(0.5);
  trio.x[1].z = touching(0.1, 0.1) - 1e-5;
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
  EXPECT_FALSE(is_new(trio.history[0][AGE]));
}

// a mass that differs in its last digit made a whole list one of unequal balls, which takes more time
TEST(ContactList, SizesThatDifferByRoundingAreOne)
{
  double history[HISTORY] = {};
  auto equal = [&](double r, double m) {
    ContactList list;
    list.add(0, 1, history, false, 0.1, 0.1, MASS, MASS);
    list.add(0, 2, history, false, 0.1, r, MASS, m);
    return list.equal;
  };
  EXPECT_TRUE(equal(0.1 * (1.0 + 4e-16), MASS));
  EXPECT_TRUE(equal(0.1, MASS * (1.0 - 4e-16)));
  EXPECT_FALSE(equal(0.1 * (1.0 + 1e-9), MASS));
  EXPECT_FALSE(equal(0.1, MASS * (1.0 + 1e-9)));
}

// How long the contact kernels take, in turn within one process, so that the machine's moods meet all of them alike:
//   cmake --build build --target kernel_times; build/tests/kernel_times [BALLS] [ROUNDS] [unequal]
// Balls of 1 m on a cubic lattice, displaced at random so that about half of the neighbours touch. Prints for each kernel
// that runs here the medians of the processor time of both passes, ns per listed and per touching contact, and
// the median ratio of neighbouring calls of the second pass with its quartiles, to the kernel before it.

#include "contact_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <vector>

using namespace Slope;

static double cpu()    // s, of this thread
{
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

static double quantile(std::vector<double> values, double share)
{
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * (values.size() - 1))];
}

struct Lattice {
  std::vector<Vector> x, v, omega, ahead, f, torque;
  std::vector<double> radius, mass;
  std::vector<unsigned char> count;
  std::vector<std::array<double, HISTORY>> histories;
  ContactList list;

  explicit Lattice(int side)
  {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    auto vector = [&](double size) { return Vector{size * u(random), size * u(random), size * u(random)}; };
    const int n = side * side * side, all = n + 1;    // vectors are read 8 bytes beyond their end
    for (int b = 0; b < all; b++) {
      const Vector shift = vector(0.002);
      x.push_back({b / side / side + shift.x, b / side % side + shift.y, b % side + shift.z});
      v.push_back(vector(0.1));
      omega.push_back(vector(0.1));
    }
    ahead = v;
    f.assign(all, {0.0, 0.0, 0.0});
    torque = f;
    radius.assign(all, 0.5);
    mass.assign(all, 1000.0);
    count.assign(all, 0);
    histories.resize(3 * n);
    size_t next = 0;
    for (int b = 0; b < n; b++) {
      const int at[3] = {b / side / side, b / side % side, b % side}, step[3] = {side * side, side, 1};
      for (int d = 0; d < 3; d++)
        if (at[d] + 1 < side) list.add(b, b + step[d], histories[next++].data(), false, 0.5, 0.5, 1000.0, 1000.0);
    }
  }
};

int main(int argc, char **argv)
{
  const double balls_wanted = argc > 1 ? std::atof(argv[1]) : 21000.0;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 100;
  Lattice lattice(static_cast<int>(std::cbrt(balls_wanted) + 0.5));
  ContactList &list = lattice.list;
  list.equal = argc <= 3;

  ContactLaw law = ContactLaw();
  law.kn = law.kt = law.kr = 1e9;
  law.cn_given = law.ct_given = law.cr_given = 5e5;
  law.friction = 0.577;
  law.rolling = 0.05;
  law.mass_factor = 1.0;
  law.rolling_factor = 2.0;
  law.fn_least = -HUGE_VAL;
  law.exact = 1.0;
  const MovingBalls balls = {lattice.x.data(),      lattice.v.data(),    lattice.omega.data(),
                             lattice.radius.data(), lattice.mass.data(), lattice.f.data(),
                             lattice.torque.data(), lattice.ahead.data(), lattice.count.data(),
                             nullptr};
  const MovingPartners partners = {balls, static_cast<int>(lattice.x.size())};

  const auto &kernels = ContactKernels::all();
  std::vector<std::vector<double>> find(kernels.size()), apply(kernels.size());
  for (int round = -1; round < rounds; round++)    // the first is not counted
    for (size_t k = 0; k < kernels.size(); k++) {
      if (!kernels[k].runs_here) continue;
      ContactKernels::set_current(static_cast<int>(k));
      std::fill(lattice.count.begin(), lattice.count.end(), 0);
      const double start = cpu();
      list.find(false, balls, partners);
      const double found = cpu();
      list.apply(law, 2.5e-4, false, balls, partners);
      const double applied = cpu();
      if (round < 0) continue;
      find[k].push_back(found - start);
      apply[k].push_back(applied - found);
    }

  size_t touching = 0;
  list.for_each_touching([&](size_t) { touching++; });
  std::printf("%zu balls, %zu contacts listed, %zu touch\n", lattice.x.size() - 1, list.entries.size(), touching);
  for (size_t k = 0; k < kernels.size(); k++) {
    if (!kernels[k].runs_here) continue;
    std::printf("%-10s %6.2f ns per listed, %6.2f per touching", kernels[k].name,
                1e9 * quantile(find[k], 0.5) / list.entries.size(), 1e9 * quantile(apply[k], 0.5) / touching);
    if (k > 0) {
      std::vector<double> ratios;
      for (int r = 0; r < rounds; r++) ratios.push_back(apply[k][r] / apply[k - 1][r]);
      std::printf("; %.3f times (%.3f to %.3f)", quantile(ratios, 0.5), quantile(ratios, 0.25), quantile(ratios, 0.75));
    }
    std::printf("\n");
  }
}

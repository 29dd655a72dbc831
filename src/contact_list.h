/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Contacts of one law: what may touch until the next neighbor list, and the forces of what
   does. Per block of listed contacts: the distances say which ones touch; of these, four at a
   time are loaded, their law is evaluated (SIMD), and their forces are handed out.
   Pair gran/restitution and fix wall/gran/balls both use it. No LAMMPS in here. */

#ifndef SLOPE_CONTACT_LIST_H
#define SLOPE_CONTACT_LIST_H

#include "contact_law.h"
#include "simd4.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace Slope {

struct Vector {
  double x, y, z;
};

// all that moves; positions in m, velocities at the middle of the step in m/s and rad/s
struct MovingBalls {
  const Vector *x, *v, *omega;
  const double *radius, *mass;
  Vector *f, *torque;
};

// The partners of the moving balls: other moving balls ...
struct MovingPartners {
  static constexpr bool MOVE = true;
  const MovingBalls &balls;
  int nforce;    // partners below this number get their force

  const Vector &x(int j) const { return balls.x[j]; }
  double share(int j) const { return j < nforce ? 1.0 : 0.5; }    // of the contact that is this rank's
  bool gets_force(int j) const { return j < nforce; }
  void prefetch(int j) const
  {
    __builtin_prefetch(&balls.v[j]);
    __builtin_prefetch(&balls.omega[j]);
    __builtin_prefetch(&balls.f[j], 1);
    __builtin_prefetch(&balls.torque[j], 1);
  }
  const Vector &v(int j) const { return balls.v[j]; }
  const Vector &omega(int j) const { return balls.omega[j]; }
  double radius(int j) const { return balls.radius[j]; }
  double mass(int j) const { return balls.mass[j]; }
};

// ... or fixed ones of one radius (m)
struct FixedPartners {
  static constexpr bool MOVE = false;
  const Vector *position;
  double radius_all;
  Vector still = {0.0, 0.0, 0.0};

  FixedPartners(const Vector *positions, double radius) : position(positions), radius_all(radius) {}

  const Vector &x(int j) const { return position[j]; }
  double share(int) const { return 1.0; }
  bool gets_force(int) const { return false; }
  void prefetch(int) const {}
  const Vector &v(int) const { return still; }
  const Vector &omega(int) const { return still; }
  double radius(int) const { return radius_all; }
  double mass(int) const { return 1.0; }
};

class ContactList {
 public:
  struct Entry {
    int i, j;    // moving ball, partner
  };

  std::vector<Entry> entries;
  std::vector<double *> histories;    // HISTORY values of each
  std::vector<int *> flags;           // where LAMMPS wants to know about touching: store_flags()

  // 1 for a side that moves, 0 for one that is fixed and as good as infinitely heavy
  double move_i, move_j;

  // if so, radii (m) and masses (kg) are these for all contacts; otherwise each looks up its own
  bool equal;
  double radius_i, radius_j, mass_i, mass_j;

  ContactList() { clear(); }

  void clear(bool i_moves = true, bool j_moves = true)
  {
    move_i = i_moves;
    move_j = j_moves;
    radius_i = radius_j = mass_i = mass_j = 1.0;
    entries.clear();
    histories.clear();
    touching.clear();
    flags.clear();
    equal = true;
  }

  void add(int i, int j, double *history, bool touch, double ri, double rj, double mi, double mj)
  {
    if (entries.empty()) {
      radius_i = ri;
      radius_j = rj;
      mass_i = mi;
      mass_j = mj;
    }
    equal = equal && ri == radius_i && rj == radius_j && mi == mass_i && mj == mass_j;
    if (entries.size() % BLOCK == 0) touching.push_back(0);
    entries.push_back({i, j});
    histories.push_back(history);
    if (touch) set_touches(entries.size() - 1);
  }

  // whether contact k touched a step ago
  bool touches(size_t k) const { return touching[k / BLOCK] >> (k % BLOCK) & 1; }
  void set_touches(size_t k) { touching[k / BLOCK] |= std::uint64_t(1) << (k % BLOCK); }

  double memory_usage() const
  {
    return entries.capacity() * sizeof(Entry) + histories.capacity() * sizeof(double *) +
        touching.capacity() * sizeof(std::uint64_t) + flags.capacity() * sizeof(int *);
  }

  // Contacts that overlap although they did not touch a step ago, before the first step:
  // visit(entry, overlap). They count as old ones.
  template <class Partners, class Visit>
  void start(const MovingBalls &balls, const Partners &partners, Visit visit)
  {
    for (size_t k = 0; k < entries.size(); k++) {
      const Entry &e = entries[k];
      const double overlap = balls.radius[e.i] + partners.radius(e.j) - distance(balls, partners, e);
      if (touches(k) || overlap <= 0.0) continue;
      visit(e, overlap);
      set_touches(k);
    }
  }

  // what the springs of the touching contacts hold, J; see(entry, overlap) is told of each
  template <class Partners, class See>
  double elastic_energy(const ContactLaw &law, const MovingBalls &balls, const Partners &partners,
                        See see) const
  {
    double energy = 0.0;
    for (size_t k = 0; k < entries.size(); k++) {
      const Entry &e = entries[k];
      const Vector &a = balls.x[e.i], &b = partners.x(e.j);
      const double n[3] = {a.x - b.x, a.y - b.y, a.z - b.z}, *h = histories[k];
      const double rsq = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
      const double sum = balls.radius[e.i] + partners.radius(e.j);
      if (rsq >= sum * sum) continue;
      const double overlap = sum - std::sqrt(rsq);
      see(e, overlap);
      const double along = h[0] * n[0] + h[1] * n[1] + h[2] * n[2];    // the phase, no spring
      const double sliding = h[0] * h[0] + h[1] * h[1] + h[2] * h[2] - along * along / rsq;
      const double rolling = h[3] * h[3] + h[4] * h[4] + h[5] * h[5];
      energy += partners.share(e.j) * 0.5 *
          (law.kn * overlap * overlap + law.kt * sliding + law.kr * rolling);
    }
    return energy;
  }

  void store_flags() const
  {
    for (size_t k = 0; k < flags.size(); k++) *flags[k] = touches(k);
  }

  // Adds the forces of all contacts to the balls. again: those of the step that has just ended
  // once more (see contact_force). tally(i, j, force on i, vector j -> i) is called for every
  // contact if TALLY.
  template <bool TALLY, class Partners, class Tally>
  void apply(const ContactLaw &law, double dt, bool again, const MovingBalls &balls,
             const Partners &partners, Tally tally)
  {
    if (entries.empty()) return;
    if (law.rolling > 0.0) {
      if (equal) apply<true, double, TALLY>(law, dt, again, balls, partners, tally);
      else apply<true, Four, TALLY>(law, dt, again, balls, partners, tally);
    } else {
      if (equal) apply<false, double, TALLY>(law, dt, again, balls, partners, tally);
      else apply<false, Four, TALLY>(law, dt, again, balls, partners, tally);
    }
  }

 private:
  static constexpr int BLOCK = 64;
  static constexpr int AHEAD = 16;    // contacts found, and fetched from memory, before their turn
  std::vector<std::uint64_t> touching;    // a step ago: a bit of each contact, a number of each block

  template <class Partners>
  static double distance(const MovingBalls &balls, const Partners &partners, const Entry &e)
  {
    const Vector &a = balls.x[e.i], &b = partners.x(e.j);
    const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    return std::sqrt(dx * dx + dy * dy + dz * dz);
  }

  // what depends on the sizes of four contacts: N = double if they are equal, otherwise Four
  template <class N> struct Sizes {
    N radius_i, radius_j;
    ContactStepOf<N> step;
  };

  template <bool ROLLING, class N, bool TALLY, class Partners, class Tally>
  void apply(const ContactLaw &law_in, double dt, bool again, const MovingBalls &balls_in,
             const Partners &partners_in, Tally tally)
  {
    const ContactLaw law = law_in;    // copies: no store below can change them
    const MovingBalls balls = balls_in;
    const Partners partners = partners_in;
    const double mass_factor = move_i * move_j > 0.0 ? law.mass_factor : 1.0;
    const double inverse = move_i / mass_i + move_j / mass_j;
    const Sizes<double> same = {radius_i, radius_j,
                                contact_step(law, inverse, mass_factor / inverse, dt, again)};

    int found[BLOCK + AHEAD + 3], count = 0;
    for (size_t block = 0; block < touching.size(); block++) {
      count = find_touching<N>(block, law, balls, partners, found, count);
      int c = 0;
      for (; c + 4 + AHEAD <= count; c += 4) {
        for (int m = 0; m < 4; m++) prefetch(found[c + AHEAD + m], partners);
        apply_four<ROLLING, N, TALLY>(&found[c], 4, law, same, mass_factor, again, balls, partners,
                                      tally);
      }
      count -= c;
      std::copy(found + c, found + c + count, found);
    }
    for (int c = count; c % 4; c++) found[c] = found[count - 1];    // idle
    for (int c = 0; c < count; c += 4)
      apply_four<ROLLING, N, TALLY>(&found[c], std::min(4, count - c), law, same, mass_factor, again,
                                    balls, partners, tally);
  }

  // adds the contacts of a block that touch to those found; those that begin get a history
  template <class N, class Partners>
  SLOPE_INLINE int find_touching(size_t block, const ContactLaw &law, const MovingBalls &balls,
                                 const Partners &partners, int *found, int count)
  {
    const size_t start = block * BLOCK;
    const int listed = static_cast<int>(std::min<size_t>(BLOCK, entries.size() - start));
    const double sum = radius_i + radius_j;
    std::uint64_t now = 0;
    const Entry *e = &entries[start];
    Entry padded[BLOCK];
    if (listed < BLOCK) {    // the last one stands for those that are missing
      std::fill(std::copy(e, e + listed, padded), padded + BLOCK, e[listed - 1]);
      e = padded;
    }
    const Entry *next = start + 2 * BLOCK <= entries.size() ? e + BLOCK : e;
    for (int k = 0; k < BLOCK; k += 4) {
      for (int m = 0; m < 4; m++) __builtin_prefetch(&partners.x(next[k + m].j));
      N reach = all<N>(sum);
      find_reach(&e[k], balls, partners, reach);
      const Columns d = distances(&e[k], balls, partners);
      const Four rsq = d.x * d.x + d.y * d.y + d.z * d.z;
      now |= static_cast<std::uint64_t>(bits(rsq < reach * reach)) << k;
    }
    if (listed < BLOCK) now &= (std::uint64_t(1) << listed) - 1;

    for (std::uint64_t changed = now ^ touching[block]; changed; changed &= changed - 1) {
      const size_t k = start + __builtin_ctzll(changed);
      double *history = histories[k];
      memset(history, 0, HISTORY * sizeof(double));
      if (touches(k)) continue;
      const Entry &e = entries[k];
      const Vector &a = balls.x[e.i], &b = partners.x(e.j);
      const double ri = balls.radius[e.i], rj = partners.radius(e.j);
      const double mark = new_contact(law.rolling_factor * ri * rj / (ri + rj)) /
          distance(balls, partners, e);
      history[0] = mark * (a.x - b.x);
      history[1] = mark * (a.y - b.y);
      history[2] = mark * (a.z - b.z);
    }
    touching[block] = now;

    for (; now; now &= now - 1) found[count++] = static_cast<int>(start + __builtin_ctzll(now));
    return count;
  }

  template <class Partners> SLOPE_INLINE void prefetch(int k, const Partners &partners) const
  {
    __builtin_prefetch(histories[k], 1);
    __builtin_prefetch(histories[k] + HISTORY - 1, 1);    // may be on the next cache line
    partners.prefetch(entries[k].j);
  }

  template <class Partners>
  static void find_reach(const Entry *, const MovingBalls &, const Partners &, double &) {}
  template <class Partners>
  SLOPE_INLINE static void find_reach(const Entry *e, const MovingBalls &balls, const Partners &partners,
                                      Four &reach)
  {
    for (int m = 0; m < 4; m++) reach[m] = balls.radius[e[m].i] + partners.radius(e[m].j);
  }

  template <class Partners>
  SLOPE_INLINE static Columns distances(const Entry *e, const MovingBalls &balls,
                                        const Partners &partners)
  {
    Four d[4];
    for (int m = 0; m < 4; m++) d[m] = four(&balls.x[e[m].i].x) - four(&partners.x(e[m].j).x);
    return Columns(d[0], d[1], d[2], d[3]);
  }

  // the contacts k of which count, of four, are not idle
  template <bool ROLLING, class N, bool TALLY, class Partners, class Tally>
  SLOPE_INLINE void apply_four(const int *k, int count, const ContactLaw &law,
                               const Sizes<double> &same, double mass_factor, bool again,
                               const MovingBalls &balls, const Partners &partners, Tally tally)
  {
    const Entry e[4] = {entries[k[0]], entries[k[1]], entries[k[2]], entries[k[3]]};
    double *const h[4] = {histories[k[0]], histories[k[1]], histories[k[2]], histories[k[3]]};
    Sizes<N> sizes;
    find_sizes(e, law, same, mass_factor, again, balls, partners, sizes);
    const N ri = sizes.radius_i, rj = sizes.radius_j;

    ContactOf<Four, N> c;
    c.rolling_radius = law.rolling_factor * ri * rj / (ri + rj);

    const Columns delta = distances(e, balls, partners);
    const Four rsq = delta.x * delta.x + delta.y * delta.y + delta.z * delta.z;
    const Four r = root(rsq), rinv = 1.0 / rsq * r;
    c.overlap = ri + rj - r;
    c.n[0] = delta.x * rinv;
    c.n[1] = delta.y * rinv;
    c.n[2] = delta.z * rinv;

    Four v[4], rw[4], w[4];
    for (int m = 0; m < 4; m++) {
      v[m] = four(&balls.v[e[m].i].x);
      w[m] = four(&balls.omega[e[m].i].x);
      rw[m] = one(ri, m) * w[m];
      if (Partners::MOVE) {
        v[m] -= four(&partners.v(e[m].j).x);
        rw[m] += one(rj, m) * four(&partners.omega(e[m].j).x);
        w[m] -= four(&partners.omega(e[m].j).x);
      }
    }
    put(Columns(v[0], v[1], v[2], v[3]), c.v);
    put(Columns(rw[0], rw[1], rw[2], rw[3]), c.rw);
    put(Columns(w[0], w[1], w[2], w[3]), c.w);

    Four history[HISTORY];
    const Columns begin(four(h[0]), four(h[1]), four(h[2]), four(h[3]));
    const Columns end(four(h[0] + 2), four(h[1] + 2), four(h[2] + 2), four(h[3] + 2));
    put(begin, history);
    history[3] = begin.w;
    history[4] = end.z;
    history[5] = end.w;

    ContactForceOf<Four> out;
    contact_force<ROLLING>(sizes.step, c, history, out);

    if (!again) {    // otherwise it is what the step has left
      const Columns rows(history[0], history[1], history[2], history[3]);
      four(h[0]) = rows.x;
      four(h[1]) = rows.y;
      four(h[2]) = rows.z;
      four(h[3]) = rows.w;
      if (ROLLING)
        for (int m = 0; m < 4; m++) {
          h[m][4] = history[4][m];
          h[m][5] = history[5][m];
        }
    }
    const Four none = Four();
    const Columns f(out.f[0], out.f[1], out.f[2], none);
    const Columns ti(out.m[0] - ri * out.t[0], out.m[1] - ri * out.t[1], out.m[2] - ri * out.t[2], none);
    const Columns tj(out.m[0] + rj * out.t[0], out.m[1] + rj * out.t[1], out.m[2] + rj * out.t[2], none);
    give(e[0], f.x, ti.x, tj.x, balls, partners);
    if (count > 1) give(e[1], f.y, ti.y, tj.y, balls, partners);
    if (count > 2) give(e[2], f.z, ti.z, tj.z, balls, partners);
    if (count > 3) give(e[3], f.w, ti.w, tj.w, balls, partners);
    if (TALLY)
      for (int m = 0; m < count; m++)
        tally(e[m].i, e[m].j, Vector{out.f[0][m], out.f[1][m], out.f[2][m]},
              Vector{delta.x[m], delta.y[m], delta.z[m]});
  }

  template <class Partners>
  SLOPE_INLINE void find_sizes(const Entry *, const ContactLaw &, const Sizes<double> &same, double,
                               bool, const MovingBalls &, const Partners &, Sizes<double> &sizes) const
  {
    sizes = same;
  }
  template <class Partners>
  SLOPE_INLINE void find_sizes(const Entry *e, const ContactLaw &law, const Sizes<double> &same,
                               double mass_factor, bool again, const MovingBalls &balls,
                               const Partners &partners, Sizes<Four> &sizes) const
  {
    Four inverse;
    for (int m = 0; m < 4; m++) {
      sizes.radius_i[m] = balls.radius[e[m].i];
      sizes.radius_j[m] = partners.radius(e[m].j);
      inverse[m] = move_i / balls.mass[e[m].i] + move_j / partners.mass(e[m].j);
    }
    sizes.step = contact_step(law, inverse, Four(mass_factor / inverse), same.step.dt, again);
  }

  static double one(double same, int) { return same; }
  SLOPE_INLINE static double one(Four several, int m) { return several[m]; }

  SLOPE_INLINE static void put(const Columns &columns, Four *rows)
  {
    rows[0] = columns.x;
    rows[1] = columns.y;
    rows[2] = columns.z;
  }

  // force f on i, minus f on j; torque ti on i, minus tj on j
  template <class Partners>
  SLOPE_INLINE static void give(const Entry &e, Four f, Four ti, Four tj, const MovingBalls &balls,
                                const Partners &partners)
  {
    add(balls.f[e.i], f);
    add(balls.torque[e.i], ti);
    if (partners.gets_force(e.j)) {
      subtract(balls.f[e.j], f);
      subtract(balls.torque[e.j], tj);
    }
  }

  SLOPE_INLINE static void add(Vector &sum, Four f)
  {
    two(&sum.x) += TwoThere{f[0], f[1]};
    sum.z += f[2];
  }
  SLOPE_INLINE static void subtract(Vector &sum, Four f)
  {
    two(&sum.x) -= TwoThere{f[0], f[1]};
    sum.z -= f[2];
  }
};

}    // namespace Slope

#endif

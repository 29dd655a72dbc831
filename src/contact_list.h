/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Contacts of one law: what may touch until the next neighbor list, and the forces of what
   does. A step has two passes, each over the lists of all styles: find() tells from the distances
   which contacts touch and counts those of each ball; apply() evaluates the law, four contacts at a
   time (SIMD), or one at a time where two balls touch nothing else, and hands out the forces.
   Pair gran/restitution and fix wall/gran/balls both use it. No LAMMPS in here. */

#ifndef SLOPE_CONTACT_LIST_H
#define SLOPE_CONTACT_LIST_H

#include "contact_balls.h"
#include "contact_law.h"
#include "simd4.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace Slope {

class ContactList {
 public:
  struct Entry {
    int i, j;    // moving ball, partner
  };

  std::vector<Entry> entries;
  std::vector<double *> histories;    // HISTORY values of each
  std::vector<int *> flags;           // where LAMMPS wants to know what has a history: store_flags()

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
    before.clear();
    ended.clear();
    flags.clear();
    equal = true;
  }

  // has_history: the contact touched a step ago, or ended in it; then its history is there
  void add(int i, int j, double *history, bool has_history, double ri, double rj, double mi, double mj)
  {
    if (entries.empty()) {
      radius_i = ri;
      radius_j = rj;
      mass_i = mi;
      mass_j = mj;
    }
    equal = equal && ri == radius_i && rj == radius_j && mi == mass_i && mj == mass_j;
    if (entries.size() % BLOCK == 0)
      for (std::vector<std::uint64_t> *bits : {&touching, &before, &ended}) bits->push_back(0);
    entries.push_back({i, j});
    histories.push_back(history);
    if (has_history) set_history(entries.size() - 1);
  }

  // contact k has a history
  void set_history(size_t k) { set(histories[k][PHASE] == ENDED ? ended : touching, k); }

  bool touches(size_t k) const { return is_set(touching, k); }    // in the last step
  bool has_history(size_t k) const { return touches(k) || is_set(ended, k); }

  double memory_usage() const
  {
    return entries.capacity() * sizeof(Entry) + histories.capacity() * sizeof(double *) +
        3 * touching.capacity() * sizeof(std::uint64_t) + flags.capacity() * sizeof(int *);
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
      std::memset(histories[k], 0, HISTORY * sizeof(double));
      set(touching, k);
      ended[k / BLOCK] &= ~bit(k);
    }
  }

  // First pass of a step: what touches. again: what touched in the step that has just ended. first: the
  // list is new. Adds to the balls' numbers of contacts, to those of the step before if the list is new.
  template <class Partners>
  void find(bool again, bool first, const MovingBalls &balls, const Partners &partners)
  {
    for (size_t block = 0; block < touching.size(); block++) {
      if (again) before[block] = touching[block];
      else {
        before[block] = touching[block];
        touching[block] = equal ? look<double>(block, balls, partners) : look<Four>(block, balls, partners);
        ended[block] = 0;
      }
      if (first) count(block, before[block], balls.count_before, partners);
      count(block, touching[block], balls.count, partners);
    }
  }

  void store_flags() const
  {
    for (size_t k = 0; k < flags.size(); k++) *flags[k] = has_history(k);
  }

  // Second pass: adds the forces of all contacts to the balls, whose numbers of contacts are complete.
  // again: those of the step that has just ended once more. tally(i, j, force on i, vector j -> i) is
  // called for every contact if TALLY.
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

  // a bit of each contact, a number of each block
  std::vector<std::uint64_t> touching;    // in the last step
  std::vector<std::uint64_t> before;      // in the one before, in the second pass
  std::vector<std::uint64_t> ended;       // came apart in the last step, and was treated then

  static std::uint64_t bit(size_t k) { return std::uint64_t(1) << (k % BLOCK); }
  static bool is_set(const std::vector<std::uint64_t> &bits, size_t k) { return bits[k / BLOCK] & bit(k); }
  static void set(std::vector<std::uint64_t> &bits, size_t k) { bits[k / BLOCK] |= bit(k); }

  template <class Partners>
  static double rolling_radius(const ContactLaw &law, const MovingBalls &balls, const Partners &partners,
                               const Entry &e)
  {
    const double ri = balls.radius[e.i], rj = partners.radius(e.j);
    return law.rolling_factor * ri * rj / (ri + rj);
  }

  static void add_one(unsigned char &n) { n += n < 255; }

  template <class Partners>
  SLOPE_INLINE void count(size_t block, std::uint64_t bits, unsigned char *counts,
                          const Partners &partners) const
  {
    const Entry *e = &entries[block * BLOCK];
    for (; bits; bits &= bits - 1) {
      const Entry &one = e[__builtin_ctzll(bits)];
      add_one(counts[one.i]);
      if (Partners::MOVE && partners.gets_force(one.j)) add_one(counts[one.j]);
    }
  }

  // the larger number of contacts of the two balls; a fixed one has none
  template <class Partners>
  SLOPE_INLINE int larger_count(const Entry &e, const unsigned char *counts) const
  {
    const int i = move_i > 0.0 ? counts[e.i] : 0;
    return Partners::MOVE && move_j > 0.0 ? std::max<int>(i, counts[e.j]) : i;
  }

  // what depends on the sizes of four contacts: N = double if they are equal, otherwise Four
  template <class N> struct Sizes {
    N radius_i, radius_j;
    ContactStepOf<N> step;
  };

  // the contacts found to be evaluated four at a time, and how many others their balls have
  struct Batch {
    int found[BLOCK + AHEAD + 3];
    double crowd[BLOCK + AHEAD + 3];
    int count;

    void push(int k, int others)
    {
      found[count] = k;
      crowd[count++] = others;
    }
    void drop(int done)
    {
      count -= done;
      std::copy(found + done, found + done + count, found);
      std::copy(crowd + done, crowd + done + count, crowd);
    }
  };

  // 2.5 Rr^2 (1/(m_i R_i^2) + 1/(m_j R_j^2)), 1/kg: how a rolling torque turns two solid spheres
  template <class N>
  SLOPE_INLINE N inverse_rolling(const ContactLaw &law, N ri, N rj, N mi, N mj) const
  {
    const N rr = law.rolling_factor * ri * rj / (ri + rj);
    return 2.5 * rr * rr * (move_i / (mi * ri * ri) + move_j / (mj * rj * rj));
  }

  LoneContact lone_of(const ContactLaw &law, double dt, double ri, double rj, double mi, double mj) const
  {
    const double inverse = move_i / mi + move_j / mj;
    const double rr = law.rolling_factor * ri * rj / (ri + rj);
    return lone_contact(law, inverse, mass_factor(law) / inverse, inverse_rolling(law, ri, rj, mi, mj),
                        2.5 * rr * (move_i / (mi * ri) - move_j / (mj * rj)), dt);
  }

  template <bool ROLLING, class N, bool TALLY, class Partners, class Tally>
  void apply(const ContactLaw &law_in, double dt, bool again, const MovingBalls &balls_in,
             const Partners &partners_in, Tally tally)
  {
    const ContactLaw law = law_in;    // copies: no store below can change them
    const MovingBalls balls = balls_in;
    const Partners partners = partners_in;
    const Sizes<double> same = {radius_i, radius_j,
                                step_of(law, dt, again, radius_i, radius_j, mass_i, mass_j)};
    const LoneContact lone = lone_of(law, dt, radius_i, radius_j, mass_i, mass_j);
    auto one = [&](int k, Life life) {
      apply_lone<ROLLING, TALLY>(k, life, law, same, lone, again, balls, partners, tally);
    };
    Batch batch;
    batch.count = 0;
    for (size_t block = 0; block < touching.size(); block++) {
      if (again) sort_again<Partners>(block, law, balls, batch, one);
      else sort<Partners>(block, law, balls, batch, one);
      int c = 0;
      for (; c + 4 + AHEAD <= batch.count; c += 4) {
        for (int m = 0; m < 4; m++) prefetch(batch.found[c + AHEAD + m], partners);
        apply_four<ROLLING, N, TALLY>(&batch.found[c], &batch.crowd[c], 4, law, same, again, balls, partners,
                                      tally);
      }
      batch.drop(c);
    }
    const int count = batch.count;
    for (int c = count; c % 4; c++) {    // idle
      batch.found[c] = batch.found[count - 1];
      batch.crowd[c] = batch.crowd[count - 1];    // they write the same springs
    }
    for (int c = 0; c < count; c += 4)
      apply_four<ROLLING, N, TALLY>(&batch.found[c], &batch.crowd[c], std::min(4, count - c), law, same,
                                    again, balls, partners, tally);
  }

  // Contacts of a block that touch: those with company go into the batch, the others to one(). A
  // contact begins or ends alone if its balls touch nothing else before and after the step.
  template <class Partners, class One>
  SLOPE_INLINE void sort(size_t block, const ContactLaw &law, const MovingBalls &balls, Batch &batch,
                         One one)
  {
    const bool exact = law.exact > 0.0;
    const int start = static_cast<int>(block) * BLOCK;
    const std::uint64_t now = touching[block], was = before[block];
    for (std::uint64_t bits = now & was; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const int n = larger_count<Partners>(entries[k], balls.count);
      if (n == 1 && exact && is_impact(histories[k][PHASE])) one(k, LASTS);
      else batch.push(k, n - 1);
    }
    for (std::uint64_t bits = now & ~was; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const Entry &e = entries[k];
      const int n = larger_count<Partners>(e, balls.count);
      double *history = histories[k];
      std::memset(history, 0, HISTORY * sizeof(double));
      if (exact && n == 1 && larger_count<Partners>(e, balls.count_before) == 0) {
        one(k, BEGINS);
        continue;
      }
      history[PHASE] = BEGAN_IN_CROWD;
      batch.push(k, n - 1);
    }
    if (!exact) return;
    for (std::uint64_t bits = was & ~now; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const Entry &e = entries[k];
      if (larger_count<Partners>(e, balls.count) == 0 && larger_count<Partners>(e, balls.count_before) == 1) {
        one(k, ENDS);
        set(ended, k);
      }
    }
  }

  // the same for the step that has just ended, from the phases in the histories
  template <class Partners, class One>
  void sort_again(size_t block, const ContactLaw &law, const MovingBalls &balls, Batch &batch, One one)
  {
    const bool exact = law.exact > 0.0;
    const int start = static_cast<int>(block) * BLOCK;
    for (std::uint64_t bits = touching[block]; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const Entry &e = entries[k];
      const double phase = histories[k][PHASE];
      const int n = larger_count<Partners>(e, balls.count);
      if (!exact || n > 1 || !is_impact(phase)) batch.push(k, n - 1);
      else one(k, is_new_impact(phase) ? BEGINS : LASTS);
    }
    for (std::uint64_t bits = ended[block]; bits; bits &= bits - 1)
      one(start + __builtin_ctzll(bits), ENDS);
  }

  // a bit of each contact of a block that touches
  template <class N, class Partners>
  SLOPE_INLINE std::uint64_t look(size_t block, const MovingBalls &balls, const Partners &partners) const
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
    return now;
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
  SLOPE_INLINE void apply_four(const int *k, const double *crowd, int count, const ContactLaw &law,
                               const Sizes<double> &same, bool again, const MovingBalls &balls,
                               const Partners &partners, Tally tally)
  {
    const Entry e[4] = {entries[k[0]], entries[k[1]], entries[k[2]], entries[k[3]]};
    double *const h[4] = {histories[k[0]], histories[k[1]], histories[k[2]], histories[k[3]]};
    Sizes<N> sizes;
    find_sizes(e, law, same, again, balls, partners, sizes);
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

    Four history[6];    // in company no step asks for the phase
    const Columns begin(four(h[0]), four(h[1]), four(h[2]), four(h[3]));
    const Columns end(four(h[0] + 2), four(h[1] + 2), four(h[2] + 2), four(h[3] + 2));
    put(begin, history);
    history[3] = begin.w;
    history[4] = end.z;
    history[5] = end.w;

    ContactForceOf<Four> out;
    contact_force<ROLLING>(sizes.step, c, Four(four(crowd)), history, out);

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
  SLOPE_INLINE void find_sizes(const Entry *, const ContactLaw &, const Sizes<double> &same, bool,
                               const MovingBalls &, const Partners &, Sizes<double> &sizes) const
  {
    sizes = same;
  }
  template <class Partners>
  SLOPE_INLINE void find_sizes(const Entry *e, const ContactLaw &law, const Sizes<double> &same,
                               bool again, const MovingBalls &balls, const Partners &partners,
                               Sizes<Four> &sizes) const
  {
    Four mi, mj;
    for (int m = 0; m < 4; m++) {
      sizes.radius_i[m] = balls.radius[e[m].i];
      sizes.radius_j[m] = partners.radius(e[m].j);
      mi[m] = balls.mass[e[m].i];
      mj[m] = partners.mass(e[m].j);
    }
    const Four inverse = move_i / mi + move_j / mj;
    sizes.step = contact_step(law, inverse, Four(mass_factor(law) / inverse),
                              inverse_rolling(law, sizes.radius_i, sizes.radius_j, mi, mj), same.step.dt, again);
  }

  // a contact whose balls touch nothing else
  template <bool ROLLING, bool TALLY, class Partners, class Tally>
  void apply_lone(int k, Life life, const ContactLaw &law, const Sizes<double> &same,
                  const LoneContact &lone, bool again, const MovingBalls &balls, const Partners &partners,
                  Tally tally)
  {
    const Entry e = entries[k];
    Contact c;
    Vector delta;
    set_contact(law, balls, partners, e, c, delta);
    double history[HISTORY];
    std::memcpy(history, histories[k], sizeof(history));
    ContactForce out;
    double ri = same.radius_i, rj = same.radius_j;
    bool known;
    if (equal) {
      known = lone_contact_force<ROLLING>(same.step, lone, life, again, c, history, out);
    } else {
      ri = balls.radius[e.i];
      rj = partners.radius(e.j);
      const double mi = balls.mass[e.i], mj = partners.mass(e.j);
      known = lone_contact_force<ROLLING>(step_of(law, same.step.dt, again, ri, rj, mi, mj),
                                          lone_of(law, same.step.dt, ri, rj, mi, mj), life, again, c, history, out);
    }
    if (!again) std::memcpy(histories[k], history, sizeof(history));
    else if (!known) {
      balls.estimated[e.i] = 1;
      if (Partners::MOVE) balls.estimated[e.j] = 1;
    }
    Four f, ti, tj;
    for (int d = 0; d < 3; d++) {
      f[d] = out.f[d];
      ti[d] = out.m[d] - ri * out.t[d];
      tj[d] = out.m[d] + rj * out.t[d];
    }
    f[3] = ti[3] = tj[3] = 0.0;
    give(e, f, ti, tj, balls, partners);
    if (TALLY) tally(e.i, e.j, Vector{out.f[0], out.f[1], out.f[2]}, delta);
  }

 public:
  // of the contact's mass, in the dashpots that follow from a restitution
  double mass_factor(const ContactLaw &law) const { return move_i * move_j > 0.0 ? law.mass_factor : 1.0; }

  // the law for two balls of these radii (m) and masses (kg)
  ContactStep step_of(const ContactLaw &law, double dt, bool again, double ri, double rj, double mi,
                      double mj) const
  {
    const double inverse = move_i / mi + move_j / mj;
    return contact_step(law, inverse, mass_factor(law) / inverse, inverse_rolling(law, ri, rj, mi, mj), dt,
                        again);
  }

  template <class Partners>
  static double distance(const MovingBalls &balls, const Partners &partners, const Entry &e)
  {
    const Vector &a = balls.x[e.i], &b = partners.x(e.j);
    const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    return std::sqrt(dx * dx + dy * dy + dz * dz);
  }

  // geometry and velocities of contact e; delta: vector from the partner to the ball, m
  template <class Partners>
  static void set_contact(const ContactLaw &law, const MovingBalls &balls, const Partners &partners,
                          const Entry &e, Contact &c, Vector &delta)
  {
    const double ri = balls.radius[e.i], rj = partners.radius(e.j);
    const double *xi = &balls.x[e.i].x, *xj = &partners.x(e.j).x;
    const double *vi = &balls.v[e.i].x, *vj = &partners.v(e.j).x;
    const double *wi = &balls.omega[e.i].x, *wj = &partners.omega(e.j).x;
    delta = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
    const double r = distance(balls, partners, e);
    c.overlap = ri + rj - r;
    c.rolling_radius = rolling_radius(law, balls, partners, e);
    for (int d = 0; d < 3; d++) {
      c.n[d] = (xi[d] - xj[d]) / r;
      c.v[d] = vi[d] - vj[d];
      c.rw[d] = ri * wi[d] + rj * wj[d];
      c.w[d] = wi[d] - wj[d];
    }
  }

 private:
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

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The two passes over a list of contacts, for one set of instructions: find_contacts() and
   apply_contacts() of ContactKernel. Contacts are evaluated four or eight at a time (SIMD). Included by contact_kernel_*.cpp alone. No
   LAMMPS. */

#ifndef SLOPE_CONTACT_PASSES_H
#define SLOPE_CONTACT_PASSES_H

#include "contact_force.h"
#include "contact_kernel.h"
#include "contact_rows.h"
#include "simd4.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

class ContactPasses : ContactView {
 public:
  SLOPE_INLINE explicit ContactPasses(const ContactView &view) : ContactView(view) {}

  template <class Partners>
  void find(bool repeat, const MovingBalls &balls, const Partners &partners)
  {
    const bool noted = !Partners::MOVE && look == NOTED && !repeat;
    if (noted) {
      if (equal)
        look_at_noted<double>(balls, partners);
      else
        look_at_noted<Four>(balls, partners);
    }
    if (look == NOTE) near->size = 0;
    for (size_t block = 0; block < blocks; block++) {
      if (!repeat && !noted) {
        bits[block].before = bits[block].touching;
        bits[block].touching = equal ? look_at<double>(block, balls, partners)
                                     : look_at<Four>(block, balls, partners);
      }
      count(block, bits[block].touching, balls, partners);
    }
  }

  template <bool TALLY, class Partners>
  void apply(const ContactLaw &law, double dt, bool repeat, const MovingBalls &balls,
             const Partners &partners, ContactTally *tally)
  {
    solve_rows(*this, law, dt, balls, partners);
    if (law.rolling > 0.0) {
      if (equal)
        apply<true, double, TALLY>(law, dt, repeat, balls, partners, tally);
      else
        apply<true, Four, TALLY>(law, dt, repeat, balls, partners, tally);
    } else {
      if (equal)
        apply<false, double, TALLY>(law, dt, repeat, balls, partners, tally);
      else
        apply<false, Four, TALLY>(law, dt, repeat, balls, partners, tally);
    }
  }

 private:
  typedef ContactEntry Entry;
  static constexpr int FETCHED =
      16;    // contacts found, and fetched from memory, before their turn

  SLOPE_INLINE static void add_to(ContactTally &tally, const Entry &e, const Vector &f,
                                  const Vector &delta)
  {
    tally.force.x += f.x;
    tally.force.y += f.y;
    tally.force.z += f.z;
    if (tally.visit) tally.visit(tally.visitor, e.i, e.j, f, delta);
  }

  SLOPE_INLINE static void increase(unsigned char &n) { n += n < 255; }

  template <class Partners>
  SLOPE_INLINE void count(size_t block, std::uint64_t left, const MovingBalls &balls,
                          const Partners &partners) const
  {
    const Entry *e = entries + block * BLOCK;
    for (; left; left &= left - 1) {
      const Entry &contact = e[__builtin_ctzll(left)];
      increase(balls.count[contact.i]);
      const bool both = Partners::MOVE && partners.gets_force(contact.j);
      if (both) increase(balls.count[contact.j]);
      if (moves.j == 0.0)
        add_normal(1.0, contact.i, contact, balls, partners);
      else if (moves.i == 0.0 && both)
        add_normal(-1.0, contact.j, contact, balls, partners);
    }
  }

  // of a ball's contact with a fixed one
  template <class Partners>
  SLOPE_INLINE static void add_normal(double sign, int ball, const Entry &e,
                                      const MovingBalls &balls, const Partners &partners)
  {
    const Vector &x = balls.x[e.i], &from = partners.x(e.j);
    const double scale =
        sign / (balls.radius[e.i] + partners.radius(e.j));    // nearly the distance
    FixedContacts &sum = balls.fixed[ball];
    BallsOnFixed *const noted = balls.on_fixed;
    if (noted && sum.number == 0.0) noted->numbers[noted->size++] = ball;
    sum.normals.x += scale * (x.x - from.x);
    sum.normals.y += scale * (x.y - from.y);
    sum.normals.z += scale * (x.z - from.z);
    sum.number += 1.0;
  }

  // what depends on the sizes of four contacts: N = double if they are equal, otherwise Four
  template <class N> struct Sizes {
    N radius_i, radius_j;
    ContactStepOf<N> step;
    N reach, rolling_radius;

    SLOPE_INLINE void add_up(const ContactLaw &law)
    {
      reach = touching(radius_i, radius_j);
      rolling_radius = law.rolling_factor * radius_i * radius_j / (radius_i + radius_j);
    }
  };

  // of a T
  template <class T> static constexpr int lanes() { return sizeof(T) / sizeof(double); }

  // contacts to be evaluated
  struct Batch {
    int found[2 * BLOCK + FETCHED + 3], count = 0;

    SLOPE_INLINE void drop(int done)
    {
      if (done == 0) return;
      count -= done;
      std::copy(found + done, found + done + count, found);
    }
  };

  template <bool ROLLING, class N, bool TALLY, class Partners>
  void apply(const ContactLaw &law_in, double dt, bool repeat, const MovingBalls &balls_in,
             const Partners &partners_in, ContactTally *tally)
  {
    const ContactLaw law = law_in;    // copies: no store below can change them
    const MovingBalls balls = balls_in;
    const Partners partners = partners_in;
    Sizes<double> same;
    same.radius_i = radius_i;
    same.radius_j = radius_j;
    same.step = step_of(moves, law, dt, repeat, radius_i, radius_j, mass_i, mass_j);
    same.add_up(law);
    fill_companies(same.step);
    Batch lasting, changing;    // the second: those that begin or end in the step
    auto evaluate_four = [&](bool changes, const int *k, int count) {
      if (changes)
        apply_several<Four, true, ROLLING, N, TALLY>(k, count, law, same, repeat, balls, partners,
                                                     tally);
      else
        apply_several<Four, false, ROLLING, N, TALLY>(k, count, law, same, repeat, balls, partners,
                                                      tally);
    };
    // of those that last as many at a time as there are lanes, where the balls are equal

    typedef typename std::conditional<sizeof(N) == sizeof(double), Widest, Four>::type Several;
    constexpr int MANY = lanes<Several>();
    for (size_t block = 0; block < blocks; block++) {
      if (law.exact > 0.0)
        sort(block, repeat, lasting, changing);
      else
        sort_plain(block, repeat, lasting);
      int done = 0;
      for (; done + MANY + FETCHED <= lasting.count; done += MANY) {
        for (int m = 0; m < MANY; m++) prefetch(lasting.found[done + FETCHED + m], partners);
        apply_several<Several, false, ROLLING, N, TALLY>(&lasting.found[done], MANY, law, same,
                                                         repeat, balls, partners, tally);
      }
      lasting.drop(done);
      for (done = 0; done + 4 <= changing.count; done += 4)
        evaluate_four(true, &changing.found[done], 4);
      changing.drop(done);
    }
    for (Batch *batch : {&lasting, &changing})
      for (int done = 0; done < batch->count; done += 4) {
        int *const k = &batch->found[done];
        const int count = std::min(4, batch->count - done);
        std::fill(k + count, k + 4, k[count - 1]);    // idle
        evaluate_four(batch == &changing, k, count);
      }
  }

  SLOPE_INLINE static void push(Batch &batch, size_t block, std::uint64_t left)
  {
    for (; left; left &= left - 1)
      batch.found[batch.count++] = static_cast<int>(block) * BLOCK + __builtin_ctzll(left);
  }

  // contacts of a block that have a force: those that touch, and those that touched a step ago
  SLOPE_INLINE void sort(size_t block, bool repeat, Batch &lasting, Batch &changing)
  {
    ContactBits &b = bits[block];
    const std::uint64_t now = b.touching, was = b.before;
    if (repeat) {
      push(lasting, block, now & ~b.fresh);
      push(changing, block, (now & b.fresh) | b.ended);
      return;
    }
    for (std::uint64_t left = now & was & b.fresh; left; left &= left - 1)
      histories[block * BLOCK + __builtin_ctzll(left)][AGE] = OLD;
    push(lasting, block, now & was);
    b.fresh = now & ~was;
    b.ended = was & ~now;
    clear_histories(block, b.fresh);
    push(changing, block, b.fresh | b.ended);
  }

  SLOPE_INLINE void sort_plain(size_t block, bool repeat, Batch &batch)
  {
    const ContactBits &b = bits[block];
    if (!repeat) clear_histories(block, b.touching & ~b.before);
    push(batch, block, b.touching);
  }

  SLOPE_INLINE void clear_histories(size_t block, std::uint64_t left)
  {
    for (; left; left &= left - 1)
      std::memset(histories[block * BLOCK + __builtin_ctzll(left)], 0, HISTORY * sizeof(double));
  }

  template <class N, class Partners>
  SLOPE_INLINE std::uint64_t look_at(size_t block, const MovingBalls &balls,
                                     const Partners &partners) const
  {
    if (!Partners::MOVE && look == NOTE) return touching_bits<N, true>(block, balls, partners);
    return touching_bits<N, false>(block, balls, partners);
  }

  // of the contacts that were near, sets the bits of those that touch
  template <class N, class Partners>
  SLOPE_INLINE void look_at_noted(const MovingBalls &balls, const Partners &partners)
  {
    for (size_t block = 0; block < blocks; block++) {
      bits[block].before = bits[block].touching;
      bits[block].touching = 0;
    }
    const double same = touching(radius_i, radius_j);
    const size_t size = near->size;
    for (size_t k = size; k < size + 3; k++) near->entries[k] = near->entries[size ? size - 1 : 0];
    for (size_t start = 0; start < size; start += 4) {
      const Entry *e = near->entries + start;
      N reach = all<N>(same);
      find_reach(e, balls, partners, reach);
      Four d[3];
      find_distances(e, balls, partners, d);
      const Four rsq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      unsigned found = static_cast<unsigned>(Slope::bits(rsq < reach * reach));
      if (start + 4 > size) found &= (1u << (size - start)) - 1;
      for (; found; found &= found - 1) {
        const int k = near->numbers[start + __builtin_ctz(found)];
        bits[k / BLOCK].touching |= std::uint64_t(1) << (k % BLOCK);
      }
    }
  }

  // a bit of each contact of a block that touches; those that are near are noted
  template <class N, bool NOTED_TOO, class Partners>
  SLOPE_INLINE std::uint64_t touching_bits(size_t block, const MovingBalls &balls,
                                           const Partners &partners) const
  {
    const size_t start = block * BLOCK;
    const int listed = static_cast<int>(std::min<size_t>(BLOCK, size - start));
    const double same = touching(radius_i, radius_j);
    std::uint64_t now = 0, close = 0;
    const Entry *e = &entries[start];
    Entry padded[BLOCK];
    if (listed < BLOCK) {    // the last one stands for those that are missing
      std::fill(std::copy(e, e + listed, padded), padded + BLOCK, e[listed - 1]);
      e = padded;
    }
    const Entry *next = start + 2 * BLOCK <= size ? e + BLOCK : e;
    for (int k = 0; k < BLOCK; k += 4) {
      for (int m = 0; m < 4; m++) __builtin_prefetch(&partners.x(next[k + m].j));
      N reach = all<N>(same);
      find_reach(&e[k], balls, partners, reach);
      Four d[3];
      find_distances(&e[k], balls, partners, d);
      const Four rsq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      now |= static_cast<std::uint64_t>(Slope::bits(rsq < reach * reach)) << k;
      if (!NOTED_TOO) continue;
      const N wide = reach + room;
      close |= static_cast<std::uint64_t>(Slope::bits(rsq < wide * wide)) << k;
    }
    const std::uint64_t there = listed < BLOCK ? (std::uint64_t(1) << listed) - 1
                                               : ~std::uint64_t(0);
    for (std::uint64_t left = close & there; left; left &= left - 1) {
      const int k = __builtin_ctzll(left);
      near->numbers[near->size] = static_cast<int>(start) + k;
      near->entries[near->size++] = e[k];
    }
    return now & there;
  }

  template <class Partners> SLOPE_INLINE void prefetch(int k, const Partners &partners) const
  {
    __builtin_prefetch(histories[k], 1);
    __builtin_prefetch(histories[k] + HISTORY - 1, 1);    // may be on the next cache line
    partners.prefetch(entries[k].j);
  }

  template <class Partners>
  static void find_reach(const Entry *, const MovingBalls &, const Partners &, double &)
  {
  }
  template <class Partners>
  SLOPE_INLINE static void find_reach(const Entry *e, const MovingBalls &balls,
                                      const Partners &partners, Four &reach)
  {
    Four ri, rj;
    for (int m = 0; m < 4; m++) {
      ri[m] = balls.radius[e[m].i];
      rj[m] = partners.radius(e[m].j);
    }
    reach = touching(ri, rj);
  }

  // vectors row(m), of several contacts m, by component
  template <class T, class Row> SLOPE_INLINE static void gather(Row row, T *components)
  {
    Four rows[lanes<T>()];
    for (int m = 0; m < lanes<T>(); m++) rows[m] = row(m);
    const ColumnsOf<T> c(rows);
    components[0] = c.x;
    components[1] = c.y;
    components[2] = c.z;
  }

  template <class T, class Partners>
  SLOPE_INLINE static void find_distances(const Entry *e, const MovingBalls &balls,
                                          const Partners &partners, T *delta)
  {
    gather(
        [&](int m) -> Four {
          return four(&balls.x[e[m].i].x) - four(&partners.x(e[m].j).x);
        },
        delta);
  }

  // The contacts k of which count, of four or eight (T), are not idle; CHANGES: they begin or end in the step
  template <class T, bool CHANGES, bool ROLLING, class N, bool TALLY, class Partners>
  SLOPE_INLINE void apply_several(const int *k, int count, const ContactLaw &law,
                                  const Sizes<double> &same, bool repeat, const MovingBalls &balls,
                                  const Partners &partners, ContactTally *tally)
  {
    Entry e[lanes<T>()];
    double *h[lanes<T>()];
    for (int m = 0; m < lanes<T>(); m++) {
      e[m] = entries[k[m]];
      h[m] = histories[k[m]];
    }
    Sizes<N> sizes;
    find_sizes(k, e, law, same, balls, partners, sizes);
    const N ri = sizes.radius_i, rj = sizes.radius_j;

    ContactOf<T, N> c;
    c.rolling_radius = sizes.rolling_radius;

    T delta[3];
    find_distances(e, balls, partners, delta);
    const T rsq = delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2];
    const T rinv = over_root(all<T>(1.0), rsq), r = root_by(rsq, rinv);
    const N reach = sizes.reach;
    c.overlap = reach - r;
    for (int d = 0; d < 3; d++) c.n[d] = delta[d] * rinv;
    find_velocities(e, ri, rj, balls, partners, c);
    c.follow_whole_step();
    CompanyOf<T> company;
    if (!Partners::MOVE || sizeof(N) != sizeof(double) || !tabled(same.step)) {
      const T many = contacts<T>(e, sizes.step, balls, partners);
      c.along = moves.i * moves.j > 0.0 ? along_moving(many) : beside_fixed(e, balls, c.n, many);
      company = company_of(sizes.step, c.along, many);
    } else {
      look_up(e, balls, c.along, company);
    }
    if (CHANGES) {
      find_times(k, repeat, delta, rinv, T(reach + T()), same.step.dt, c);
      hold_beginning(sizes.step, c);
    }

    T history[6];
    load(h, history);
    ContactForceOf<T> out;
    contact_force<ROLLING, !CHANGES>(sizes.step, c, company, history, out);
    if (!repeat) store<ROLLING>(h, history);    // otherwise it is what the step has left

    T ti[3], tj[3];
    for (int d = 0; d < 3; d++) {
      ti[d] = out.m[d] - ri * out.t[d];
      tj[d] = out.m[d] + rj * out.t[d];
    }
    const VectorsOf<T> f(out.f), on_i(ti), on_j(tj);
    for (int m = 0; m < lanes<T>(); m++)
      if (m == 0 || m < count) give(m, e[m], f, on_i, on_j, balls, partners);
    if (TALLY)
      for (int m = 0; m < count; m++)
        add_to(*tally, e[m], Vector{out.f[0][m], out.f[1][m], out.f[2][m]},
               Vector{delta[0][m], delta[1][m], delta[2][m]});
  }

  // the vectors of several contacts from their components
  template <class T> struct VectorsOf {
    PairsOf<T> xy;
    T z;

    SLOPE_INLINE explicit VectorsOf(const T *components) :
        xy(components[0], components[1]), z(components[2])
    {
    }
  };

  template <class T, class N, class Partners>
  SLOPE_INLINE static void find_velocities(const Entry *e, const N &ri, const N &rj,
                                           const MovingBalls &balls, const Partners &partners,
                                           ContactOf<T, N> &c)
  {
    gather(
        [&](int m) -> Four {
          Four v = four(&balls.v[e[m].i].x);
          if (Partners::MOVE) v -= four(&partners.v(e[m].j).x);
          return v;
        },
        c.v);
    gather(
        [&](int m) -> Four {
          Four rw = lane(ri, m) * four(&balls.omega[e[m].i].x);
          if (Partners::MOVE) rw += lane(rj, m) * four(&partners.omega(e[m].j).x);
          return rw;
        },
        c.rw);
    gather(
        [&](int m) -> Four {
          Four w = four(&balls.omega[e[m].i].x);
          if (Partners::MOVE) w -= four(&partners.omega(e[m].j).x);
          return w;
        },
        c.w);
    T ahead[3];
    gather(
        [&](int m) -> Four {
          Four v = four(&balls.ahead[e[m].i].x);
          if (Partners::MOVE) v -= four(&partners.ahead(e[m].j).x);
          return v;
        },
        ahead);
    c.ahead = ahead[0] * c.n[0] + ahead[1] * c.n[1] + ahead[2] * c.n[2];
  }

  // of two balls that move, and of one mass, the sum of their contacts tells
  SLOPE_INLINE bool tabled(const ContactStep &step) const
  {
    return equal && moves.i * moves.j > 0.0 && step.share_i == 0.5;
  }

  void fill_companies(const ContactStep &step) const
  {
    if (!tabled(step) || std::memcmp(of_step, &step, sizeof(step)) == 0) return;
    for (int sum = 0; sum < COMPANIES; sum++) {
      const double many = 0.5 * sum, along = along_moving(many);
      const CompanyOf<double> company = company_of(step, along, many);
      four(companies + 4 * sum) = Four{along, company.normal, company.sliding, company.rolling};
    }
    *of_step = step;
  }

  template <class T>
  SLOPE_INLINE void look_up(const Entry *e, const MovingBalls &balls, T &along,
                            CompanyOf<T> &company) const
  {
    Four rows[lanes<T>()];
    for (int m = 0; m < lanes<T>(); m++)
      rows[m] = four(companies + 4 * (balls.count[e[m].i] + balls.count[e[m].j]));
    const ColumnsOf<T> c(rows);
    along = c.x;
    company.normal = c.y;
    company.sliding = c.z;
    company.rolling = c.w;
  }

  template <class T, class N, class Partners>
  SLOPE_INLINE T contacts(const Entry *e, const ContactStepOf<N> &step, const MovingBalls &balls,
                          const Partners &partners) const
  {
    T ni, nj = T();
    for (int m = 0; m < lanes<T>(); m++) {
      ni[m] = balls.count[e[m].i];
      if (Partners::MOVE) nj[m] = balls.count[e[m].j];
    }
    return mean_contacts(step, ni, nj);
  }

  template <class T>
  SLOPE_INLINE T beside_fixed(const Entry *e, const MovingBalls &balls, const T *n, T many) const
  {
    const FixedContacts *of[lanes<T>()];
    T normals[3], number;
    for (int m = 0; m < lanes<T>(); m++) {
      of[m] = &balls.fixed[moves.i > 0.0 ? e[m].i : e[m].j];
      number[m] = of[m]->number;
    }
    gather(
        [&](int m) -> Four {
          return four(&of[m]->normals.x);
        },
        normals);
    const double sign = moves.i > 0.0 ? 1.0 : -1.0;
    const T towards[3] = {sign * n[0], sign * n[1], sign * n[2]};
    return along_fixed(towards, normals, number, many);
  }

  // Contacts that begin or end in the step. A force acts from the middle of a step to the middle of the
  // next. A contact that touches for the part f of its first step has dashpots for f + 1/2 of a step, one
  // that touched for the part g of its last step for g, of which the force before gave 1/2. Contacts
  // shorter than a step are found in that part of the cases only, and count for a whole one. A spring that
  // is stretched at a rate V then has V (f - 1/2)^2/2, V (g - 1/2)^2/2 more than the overlaps say.
  // f and g are those of the overlaps now and a step ago; delta: vector of the centres.
  template <class T, class N>
  SLOPE_INLINE void find_times(const int *k, bool repeat, const T *delta, T rinv, T reach,
                               double dt, ContactOf<T, N> &c) const
  {
    const T zero = T(), one = all<T>(1.0), vn = normal_velocity(c);
    typedef decltype(T() < T()) Flags;
    T lasted;      // as a step ago; < 0 if it ends
    Flags ends;    // as find() saw it
    for (int m = 0; m < lanes<T>(); m++) {
      lasted[m] = histories[k[m]][AGE];
      ends[m] = bits[k[m] / BLOCK].touching >> (k[m] % BLOCK) & 1 ? 0 : -1;
    }
    const T x = delta[0] - dt * c.v[0], y = delta[1] - dt * c.v[1], z = delta[2] - dt * c.v[2];
    const T was = reach - root(T(x * x + y * y + z * z));
    const T f = choose(was < zero, c.overlap / (c.overlap - was), one);
    const T g = choose(was > zero, was / (was - c.overlap), zero);
    // a partner of which the overlaps say something else has been put in place, or taken away

    const T real = choose(ends, choose(was > zero, one, zero), choose(was < zero, one, zero));
    const T late = real * (choose(ends, g, f) - 0.5);
    const T before = repeat ? T(-lasted) : lasted;
    c.weight = choose(ends, real * (larger(g, T(one - before)) - 0.5), one + real * (f - 0.5));
    c.beyond = 0.5 * late * late *
        choose(real > zero, larger(T(c.overlap - was), T(was - c.overlap)), zero);

    // the normal turns: vn in the middle of these times

    const T across = c.v[0] * c.v[0] + c.v[1] * c.v[1] + c.v[2] * c.v[2] - vn * vn;
    c.turn = 0.5 * real * choose(ends, g - 1.5, 0.5 - f) * dt * rinv * across;
    c.touches = choose(ends, zero, one);
    c.first = c.touches * real;
    c.grown = choose(ends, zero, f);
    c.early = choose(ends, zero, 0.5 * dt * late * late);
    if (repeat) return;
    const T age = choose(ends, -before, choose(real > zero, f, all<T>(OLD)));
    for (int m = 0; m < lanes<T>(); m++) histories[k[m]][AGE] = age[m];
  }

  template <class T> SLOPE_INLINE static void load(double *const *h, T *springs)
  {
    gather(
        [&](int m) -> Four {
          return four(h[m]);
        },
        springs);
    gather(
        [&](int m) -> Four {
          return four(h[m] + 3);
        },
        springs + 3);
  }

  template <bool ROLLING, class T>
  SLOPE_INLINE static void store(double *const *h, const T *springs)
  {
    scatter(springs, h);
    if (!ROLLING) return;
    const PairsOf<T> last(springs[4], springs[5]);
    for (int m = 0; m < lanes<T>(); m++) two_at(h[m] + 4) = last.pair(m);
  }

  template <class Partners>
  SLOPE_INLINE void find_sizes(const int *, const Entry *, const ContactLaw &,
                               const Sizes<double> &same, const MovingBalls &, const Partners &,
                               Sizes<double> &sizes) const
  {
    sizes = same;
  }
  template <class Partners>
  SLOPE_INLINE void find_sizes(const int *k, const Entry *e, const ContactLaw &law,
                               const Sizes<double> &same, const MovingBalls &balls,
                               const Partners &partners, Sizes<Four> &sizes) const
  {
    sizes.radius_i = sizes.radius_j = Four();
    for (int m = 0; m < 4; m++) {
      sizes.radius_i[m] = balls.radius[e[m].i];
      sizes.radius_j[m] = partners.radius(e[m].j);
    }
    sizes.step = load_rows(*this, k, same.step);
    sizes.add_up(law);
  }

  SLOPE_INLINE static double lane(double same, int) { return same; }
  SLOPE_INLINE static double lane(Four several, int m) { return several[m]; }

  // of contact m, force f on i, minus f on j; torque ti on i, minus tj on j
  template <class T, class Partners>
  SLOPE_INLINE static void give(int m, const Entry &e, const VectorsOf<T> &f,
                                const VectorsOf<T> &ti, const VectorsOf<T> &tj,
                                const MovingBalls &balls, const Partners &partners)
  {
    add(balls.f[e.i], f, m);
    add(balls.torque[e.i], ti, m);
    if (partners.gets_force(e.j)) {
      subtract(balls.f[e.j], f, m);
      subtract(balls.torque[e.j], tj, m);
    }
  }

  template <class T> SLOPE_INLINE static void add(Vector &sum, const VectorsOf<T> &f, int m)
  {
    two_at(&sum.x) += f.xy.pair(m);
    sum.z += f.z[m];
  }
  template <class T> SLOPE_INLINE static void subtract(Vector &sum, const VectorsOf<T> &f, int m)
  {
    two_at(&sum.x) -= f.xy.pair(m);
    sum.z -= f.z[m];
  }
};

// see ContactKernel
inline bool any_moved(const double *now, const double *was, size_t n, double most)
{
  size_t k = 0;
  Four farthest = Four();
  for (; k + 4 <= n; k += 4) {
    const Four d = four(now + k) - four(was + k);
    farthest = larger(farthest, larger(d, Four(-d)));
  }
  double all = 0.0;
  for (int m = 0; m < 4; m++) all = larger(all, farthest[m]);
  for (; k < n; k++) all = larger(all, std::fabs(now[k] - was[k]));
  return !(all <= most);
}

template <class Partners>
void find_contacts(const ContactView &view, bool repeat, const MovingBalls &balls,
                   const Partners &partners)
{
  ContactPasses(view).find(repeat, balls, partners);
}

template <class Partners>
void apply_contacts(const ContactView &view, const ContactLaw &law, double dt, bool repeat,
                    const MovingBalls &balls, const Partners &partners, ContactTally *tally)
{
  if (tally)
    ContactPasses(view).apply<true>(law, dt, repeat, balls, partners, tally);
  else
    ContactPasses(view).apply<false>(law, dt, repeat, balls, partners, tally);
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

// a constant, so that none of this code runs before its kernel has been chosen
#define SLOPE_CONTACT_KERNEL                                                     \
  {                                                                              \
    {find_contacts<MovingPartners>, apply_contacts<MovingPartners>},             \
        {find_contacts<FixedPartners>, apply_contacts<FixedPartners>}, any_moved \
  }

#endif

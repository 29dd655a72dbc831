/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The two passes over a list of contacts, for one set of instructions: find() and apply() of
   ContactKernel. Contacts are evaluated four at a time (SIMD). Included by contact_kernel_*.cpp alone. No
   LAMMPS. */

#ifndef SLOPE_CONTACT_PASSES_H
#define SLOPE_CONTACT_PASSES_H

#include "contact_geometry.h"
#include "contact_kernel.h"
#include "contact_rows.h"
#include "simd4.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

class ContactPasses : ContactView {
 public:
  SLOPE_INLINE explicit ContactPasses(const ContactView &view) : ContactView(view) {}

  template <class Partners>
  void find(bool repeat, const MovingBalls &balls, const Partners &partners)
  {
    for (size_t block = 0; block < blocks; block++) {
      if (!repeat) {
        before[block] = touching[block];
        touching[block] = equal ? touching_bits<double>(block, balls, partners)
                                : touching_bits<Four>(block, balls, partners);
      }
      count(block, touching[block], balls.count, partners);
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
  SLOPE_INLINE void count(size_t block, std::uint64_t bits, unsigned char *counts,
                          const Partners &partners) const
  {
    const Entry *e = entries + block * BLOCK;
    for (; bits; bits &= bits - 1) {
      const Entry &contact = e[__builtin_ctzll(bits)];
      increase(counts[contact.i]);
      if (Partners::MOVE && partners.gets_force(contact.j)) increase(counts[contact.j]);
    }
  }

  // what depends on the sizes of four contacts: N = double if they are equal, otherwise Four
  template <class N> struct Sizes {
    N radius_i, radius_j;
    ContactStepOf<N> step;
  };

  // contacts to be evaluated four at a time
  struct Batch {
    int found[2 * BLOCK + FETCHED + 3], count = 0;

    void drop(int done)
    {
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
    const Sizes<double> same = {
        radius_i, radius_j, step_of(moves, law, dt, repeat, radius_i, radius_j, mass_i, mass_j)};
    Batch lasting, changing;    // the second: those that begin or end in the step
    auto evaluate = [&](bool changes, const int *k, int count) {
      if (changes)
        apply_four<true, ROLLING, N, TALLY>(k, count, law, same, repeat, balls, partners, tally);
      else
        apply_four<false, ROLLING, N, TALLY>(k, count, law, same, repeat, balls, partners, tally);
    };
    auto evaluate_all_but = [&](Batch &batch, bool changes, int left) {
      int c = 0;
      for (; c + 4 + left <= batch.count; c += 4) {
        for (int m = 0; m < 4 && left > 0; m++) prefetch(batch.found[c + left + m], partners);
        evaluate(changes, &batch.found[c], 4);
      }
      batch.drop(c);
    };
    for (size_t block = 0; block < blocks; block++) {
      if (law.exact > 0.0)
        sort(block, repeat, lasting, changing);
      else
        sort_plain(block, repeat, lasting);
      evaluate_all_but(lasting, false, FETCHED);
      evaluate_all_but(changing, true, 0);
    }
    evaluate_all_but(lasting, false, 0);
    for (Batch *batch : {&lasting, &changing}) {
      const int count = batch->count;
      if (count == 0) continue;
      std::fill(batch->found + count, batch->found + 4, batch->found[count - 1]);    // idle
      evaluate(batch == &changing, batch->found, count);
    }
  }

  SLOPE_INLINE static void push(Batch &batch, size_t block, std::uint64_t bits)
  {
    for (; bits; bits &= bits - 1)
      batch.found[batch.count++] = static_cast<int>(block) * BLOCK + __builtin_ctzll(bits);
  }

  // contacts of a block that have a force: those that touch, and those that touched a step ago
  SLOPE_INLINE void sort(size_t block, bool repeat, Batch &lasting, Batch &changing)
  {
    const std::uint64_t now = touching[block];
    if (repeat) {
      push(lasting, block, now & ~fresh[block]);
      push(changing, block, (now & fresh[block]) | ended[block]);
      return;
    }
    const std::uint64_t was = before[block];
    for (std::uint64_t bits = now & was & fresh[block]; bits; bits &= bits - 1)
      histories[block * BLOCK + __builtin_ctzll(bits)][AGE] = OLD;
    push(lasting, block, now & was);
    fresh[block] = now & ~was;
    ended[block] = was & ~now;
    clear_histories(block, fresh[block]);
    push(changing, block, fresh[block] | ended[block]);
  }

  SLOPE_INLINE void sort_plain(size_t block, bool repeat, Batch &batch)
  {
    if (!repeat) clear_histories(block, touching[block] & ~before[block]);
    push(batch, block, touching[block]);
  }

  SLOPE_INLINE void clear_histories(size_t block, std::uint64_t bits)
  {
    for (; bits; bits &= bits - 1)
      std::memset(histories[block * BLOCK + __builtin_ctzll(bits)], 0, HISTORY * sizeof(double));
  }

  // a bit of each contact of a block that touches
  template <class N, class Partners>
  SLOPE_INLINE std::uint64_t touching_bits(size_t block, const MovingBalls &balls,
                                           const Partners &partners) const
  {
    const size_t start = block * BLOCK;
    const int listed = static_cast<int>(std::min<size_t>(BLOCK, size - start));
    const double sum = radius_i + radius_j;
    std::uint64_t now = 0;
    const Entry *e = &entries[start];
    Entry padded[BLOCK];
    if (listed < BLOCK) {    // the last one stands for those that are missing
      std::fill(std::copy(e, e + listed, padded), padded + BLOCK, e[listed - 1]);
      e = padded;
    }
    const Entry *next = start + 2 * BLOCK <= size ? e + BLOCK : e;
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
  static void find_reach(const Entry *, const MovingBalls &, const Partners &, double &)
  {
  }
  template <class Partners>
  SLOPE_INLINE static void find_reach(const Entry *e, const MovingBalls &balls,
                                      const Partners &partners, Four &reach)
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

  // The contacts k of which count, of four, are not idle; CHANGES: they begin or end in the step
  template <bool CHANGES, bool ROLLING, class N, bool TALLY, class Partners>
  SLOPE_INLINE void apply_four(const int *k, int count, const ContactLaw &law,
                               const Sizes<double> &same, bool repeat, const MovingBalls &balls,
                               const Partners &partners, ContactTally *tally)
  {
    const Entry e[4] = {entries[k[0]], entries[k[1]], entries[k[2]], entries[k[3]]};
    double *const h[4] = {histories[k[0]], histories[k[1]], histories[k[2]], histories[k[3]]};
    Sizes<N> sizes;
    find_sizes(k, e, same, balls, partners, sizes);
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
    find_velocities(e, ri, rj, balls, partners, c);
    c.follow_whole_step();
    if (CHANGES) find_times(k, repeat, delta, rinv, Four(N(ri + rj) + Four()), same.step.dt, c);

    Four history[6];
    load(h, history);
    ContactForceOf<Four> out;
    contact_force<ROLLING>(sizes.step, c, contacts(e, sizes.step, balls, partners), history, out);
    if (!repeat) store<ROLLING>(h, history);    // otherwise it is what the step has left

    const Four none = Four();
    const Columns f(out.f[0], out.f[1], out.f[2], none);
    const Columns ti(out.m[0] - ri * out.t[0], out.m[1] - ri * out.t[1], out.m[2] - ri * out.t[2],
                     none);
    const Columns tj(out.m[0] + rj * out.t[0], out.m[1] + rj * out.t[1], out.m[2] + rj * out.t[2],
                     none);
    give(e[0], f.x, ti.x, tj.x, balls, partners);
    if (count > 1) give(e[1], f.y, ti.y, tj.y, balls, partners);
    if (count > 2) give(e[2], f.z, ti.z, tj.z, balls, partners);
    if (count > 3) give(e[3], f.w, ti.w, tj.w, balls, partners);
    if (TALLY)
      for (int m = 0; m < count; m++)
        add_to(*tally, e[m], Vector{out.f[0][m], out.f[1][m], out.f[2][m]},
               Vector{delta.x[m], delta.y[m], delta.z[m]});
  }

  template <class N, class Partners>
  SLOPE_INLINE static void find_velocities(const Entry *e, const N &ri, const N &rj,
                                           const MovingBalls &balls, const Partners &partners,
                                           ContactOf<Four, N> &c)
  {
    Four v[4], rw[4], w[4];
    for (int m = 0; m < 4; m++) {
      v[m] = four(&balls.v[e[m].i].x);
      w[m] = four(&balls.omega[e[m].i].x);
      rw[m] = lane(ri, m) * w[m];
      if (Partners::MOVE) {
        v[m] -= four(&partners.v(e[m].j).x);
        rw[m] += lane(rj, m) * four(&partners.omega(e[m].j).x);
        w[m] -= four(&partners.omega(e[m].j).x);
      }
    }
    put(Columns(v[0], v[1], v[2], v[3]), c.v);
    put(Columns(rw[0], rw[1], rw[2], rw[3]), c.rw);
    put(Columns(w[0], w[1], w[2], w[3]), c.w);

    for (int m = 0; m < 4; m++) {
      v[m] = four(&balls.ahead[e[m].i].x);
      if (Partners::MOVE) v[m] -= four(&partners.ahead(e[m].j).x);
    }
    const Columns ahead(v[0], v[1], v[2], v[3]);
    c.ahead = ahead.x * c.n[0] + ahead.y * c.n[1] + ahead.z * c.n[2];
  }

  template <class N, class Partners>
  SLOPE_INLINE Four contacts(const Entry *e, const ContactStepOf<N> &step, const MovingBalls &balls,
                             const Partners &partners) const
  {
    Four ni, nj = Four();
    for (int m = 0; m < 4; m++) {
      ni[m] = balls.count[e[m].i];
      if (Partners::MOVE) nj[m] = balls.count[e[m].j];
    }
    return mean_contacts(step, ni, nj);
  }

  // Contacts that begin or end in the step. A force acts from the middle of a step to the middle of the
  // next. A contact that touches for the part f of its first step has dashpots for f + 1/2 of a step, one
  // that touched for the part g of its last step for g, of which the force before gave 1/2. Contacts
  // shorter than a step are found in that part of the cases only, and count for a whole one. A spring that
  // is stretched at a rate V then has V (f - 1/2)^2/2, V (g - 1/2)^2/2 more than the overlaps say.
  // f and g are those of the overlaps now and a step ago; delta: vector of the centres, reach: of the radii.
  template <class N>
  SLOPE_INLINE void find_times(const int *k, bool repeat, const Columns &delta, Four rinv,
                               Four reach, double dt, ContactOf<Four, N> &c) const
  {
    const Four zero = Four(), one = all<Four>(1.0), vn = normal_velocity(c);
    Four lasted;       // as a step ago; < 0 if it ends
    FourFlags ends;    // as find() saw it: an overlap of 0 is one or the other by rounding
    for (int m = 0; m < 4; m++) {
      lasted[m] = histories[k[m]][AGE];
      ends[m] = touching[k[m] / BLOCK] >> (k[m] % BLOCK) & 1 ? 0 : -1;
    }
    const Four x = delta.x - dt * c.v[0], y = delta.y - dt * c.v[1], z = delta.z - dt * c.v[2];
    const Four was = reach - root(Four(x * x + y * y + z * z));
    const Four f = choose(was < zero, c.overlap / (c.overlap - was), one);
    const Four g = choose(was > zero, was / (was - c.overlap), zero);
    // a partner of which the overlaps say something else has been put in place, or taken away

    const Four real = choose(ends, choose(was > zero, one, zero), choose(was < zero, one, zero));
    const Four late = real * (choose(ends, g, f) - 0.5);
    const Four before = repeat ? Four(-lasted) : lasted;
    c.weight = choose(ends, real * (larger(g, Four(one - before)) - 0.5), one + real * (f - 0.5));
    c.beyond = 0.5 * late * late *
        choose(real > zero, larger(Four(c.overlap - was), Four(was - c.overlap)), zero);

    // the normal turns: vn in the middle of these times

    const Four across = c.v[0] * c.v[0] + c.v[1] * c.v[1] + c.v[2] * c.v[2] - vn * vn;
    c.turn = 0.5 * real * choose(ends, g - 1.5, 0.5 - f) * dt * rinv * across;
    c.touches = choose(ends, zero, one);
    c.first = c.touches * real;
    c.grown = choose(ends, zero, f);
    c.early = choose(ends, zero, 0.5 * dt * late * late);
    if (repeat) return;
    const Four age = choose(ends, -before, choose(real > zero, f, all<Four>(OLD)));
    for (int m = 0; m < 4; m++) histories[k[m]][AGE] = age[m];
  }

  SLOPE_INLINE static void load(double *const *h, Four *springs)
  {
    const Columns begin(four(h[0]), four(h[1]), four(h[2]), four(h[3]));
    const Columns end(four(h[0] + 2), four(h[1] + 2), four(h[2] + 2), four(h[3] + 2));
    put(begin, springs);
    springs[3] = begin.w;
    springs[4] = end.z;
    springs[5] = end.w;
  }

  template <bool ROLLING> SLOPE_INLINE static void store(double *const *h, const Four *springs)
  {
    const Columns rows(springs[0], springs[1], springs[2], springs[3]);
    four(h[0]) = rows.x;
    four(h[1]) = rows.y;
    four(h[2]) = rows.z;
    four(h[3]) = rows.w;
    if (ROLLING)
      for (int m = 0; m < 4; m++) {
        h[m][4] = springs[4][m];
        h[m][5] = springs[5][m];
      }
  }

  template <class Partners>
  SLOPE_INLINE void find_sizes(const int *, const Entry *, const Sizes<double> &same,
                               const MovingBalls &, const Partners &, Sizes<double> &sizes) const
  {
    sizes = same;
  }
  template <class Partners>
  SLOPE_INLINE void find_sizes(const int *k, const Entry *e, const Sizes<double> &same,
                               const MovingBalls &balls, const Partners &partners,
                               Sizes<Four> &sizes) const
  {
    sizes.radius_i = sizes.radius_j = Four();
    for (int m = 0; m < 4; m++) {
      sizes.radius_i[m] = balls.radius[e[m].i];
      sizes.radius_j[m] = partners.radius(e[m].j);
    }
    sizes.step = load_rows(*this, k, same.step);
  }

  SLOPE_INLINE static double lane(double same, int) { return same; }
  SLOPE_INLINE static double lane(Four several, int m) { return several[m]; }

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
    two_at(&sum.x) += TwoThere{f[0], f[1]};
    sum.z += f[2];
  }
  SLOPE_INLINE static void subtract(Vector &sum, Four f)
  {
    two_at(&sum.x) -= TwoThere{f[0], f[1]};
    sum.z -= f[2];
  }
};

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
#define SLOPE_CONTACT_KERNEL                                                                     \
  {                                                                                              \
    find_contacts<MovingPartners>, find_contacts<FixedPartners>, apply_contacts<MovingPartners>, \
        apply_contacts<FixedPartners>                                                            \
  }

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The two passes over a list of contacts, for one set of instructions: find() and apply() of
   ContactKernel. Contacts are evaluated four at a time (SIMD), or one at a time where two balls touch
   nothing else. Included by contact_kernel_*.cpp alone. No LAMMPS. */

#ifndef SLOPE_CONTACT_PASSES_H
#define SLOPE_CONTACT_PASSES_H

#include "contact_geometry.h"
#include "contact_kernel.h"
#include "simd4.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

class ContactPasses : protected ContactView {
 public:
  SLOPE_INLINE explicit ContactPasses(const ContactView &view) : ContactView(view) {}

  template <class Partners>
  void find(bool repeat, bool first, const MovingBalls &balls, const Partners &partners)
  {
    for (size_t block = 0; block < blocks; block++) {
      before[block] = touching[block];
      if (!repeat) {
        touching[block] = equal ? touching_bits<double>(block, balls, partners)
                                : touching_bits<Four>(block, balls, partners);
        ended[block] = 0;
      }
      if (!balls.count) continue;    // scheme solved needs no numbers
      if (first) count(block, before[block], balls.count_before, partners);
      count(block, touching[block], balls.count, partners);
    }
  }

  template <bool TALLY, class Partners>
  void apply(const ContactLaw &law, double dt, bool repeat, const MovingBalls &balls,
             const Partners &partners, ContactTally *tally)
  {
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

 protected:
  typedef ContactEntry Entry;
  static constexpr int AHEAD = 16;    // contacts found, and fetched from memory, before their turn

  SLOPE_INLINE static void add_to(ContactTally &tally, const Entry &e, const Vector &f,
                                  const Vector &delta)
  {
    tally.force.x += f.x;
    tally.force.y += f.y;
    tally.force.z += f.z;
    if (tally.visit) tally.visit(tally.visitor, e.i, e.j, f, delta);
  }

  SLOPE_INLINE static std::uint64_t bit(size_t k) { return std::uint64_t(1) << (k % BLOCK); }

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

  // the larger number of contacts of the two balls; a fixed one has none
  template <class Partners>
  SLOPE_INLINE int larger_count(const Entry &e, const unsigned char *counts) const
  {
    const int i = moves.i > 0.0 ? counts[e.i] : 0;
    return Partners::MOVE && moves.j > 0.0 ? std::max<int>(i, counts[e.j]) : i;
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

  template <bool ROLLING, class N, bool TALLY, class Partners>
  void apply(const ContactLaw &law_in, double dt, bool repeat, const MovingBalls &balls_in,
             const Partners &partners_in, ContactTally *tally)
  {
    const ContactLaw law = law_in;    // copies: no store below can change them
    const MovingBalls balls = balls_in;
    const Partners partners = partners_in;
    const Sizes<double> same = {
        radius_i, radius_j, step_of(moves, law, dt, repeat, radius_i, radius_j, mass_i, mass_j)};
    const LoneContact lone = lone_of(moves, law, dt, radius_i, radius_j, mass_i, mass_j);
    auto evaluate = [&](int k, Life life) {
      apply_lone<ROLLING, TALLY>(k, life, law, same, lone, repeat, balls, partners, tally);
    };
    Batch batch;
    batch.count = 0;
    for (size_t block = 0; block < blocks; block++) {
      if (repeat)
        sort_repeated<Partners>(block, law, balls, batch, evaluate);
      else
        sort<Partners>(block, law, balls, batch, evaluate);
      int c = 0;
      for (; c + 4 + AHEAD <= batch.count; c += 4) {
        for (int m = 0; m < 4; m++) prefetch(batch.found[c + AHEAD + m], partners);
        apply_four<ROLLING, N, TALLY>(&batch.found[c], &batch.crowd[c], 4, law, same, repeat, balls,
                                      partners, tally);
      }
      batch.drop(c);
    }
    const int count = batch.count;
    for (int c = count; c % 4; c++) {    // idle
      batch.found[c] = batch.found[count - 1];
      batch.crowd[c] = batch.crowd[count - 1];    // they write the same springs
    }
    for (int c = 0; c < count; c += 4)
      apply_four<ROLLING, N, TALLY>(&batch.found[c], &batch.crowd[c], std::min(4, count - c), law,
                                    same, repeat, balls, partners, tally);
  }

  // Contacts of a block that touch: those with company go into the batch, the others to lone(). A
  // contact begins or ends alone if its balls touch nothing else before and after the step.
  template <class Partners, class Lone>
  SLOPE_INLINE void sort(size_t block, const ContactLaw &law, const MovingBalls &balls,
                         Batch &batch, Lone lone)
  {
    const bool exact = law.exact > 0.0;
    const int start = static_cast<int>(block) * BLOCK;
    const std::uint64_t now = touching[block], was = before[block];
    for (std::uint64_t bits = now & was; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const int n = larger_count<Partners>(entries[k], balls.count);
      if (n == 1 && exact && is_impact(histories[k][PHASE]))
        lone(k, LASTS);
      else
        batch.push(k, n - 1);
    }
    for (std::uint64_t bits = now & ~was; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const Entry &e = entries[k];
      const int n = larger_count<Partners>(e, balls.count);
      double *history = histories[k];
      std::memset(history, 0, HISTORY * sizeof(double));
      if (exact && n == 1 && larger_count<Partners>(e, balls.count_before) == 0) {
        lone(k, BEGINS);
        continue;
      }
      history[PHASE] = BEGAN_IN_CROWD;
      batch.push(k, n - 1);
    }
    if (!exact) return;
    for (std::uint64_t bits = was & ~now; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const Entry &e = entries[k];
      if (larger_count<Partners>(e, balls.count) == 0 &&
          larger_count<Partners>(e, balls.count_before) == 1) {
        lone(k, ENDS);
        ended[block] |= bit(k);
      }
    }
  }

  // the same for the step that has just ended, from the phases in the histories
  template <class Partners, class Lone>
  void sort_repeated(size_t block, const ContactLaw &law, const MovingBalls &balls, Batch &batch,
                     Lone lone)
  {
    const bool exact = law.exact > 0.0;
    const int start = static_cast<int>(block) * BLOCK;
    for (std::uint64_t bits = touching[block]; bits; bits &= bits - 1) {
      const int k = start + __builtin_ctzll(bits);
      const Entry &e = entries[k];
      const double phase = histories[k][PHASE];
      const int n = larger_count<Partners>(e, balls.count);
      if (!exact || n > 1 || !is_impact(phase))
        batch.push(k, n - 1);
      else
        lone(k, is_new_impact(phase) ? BEGINS : LASTS);
    }
    for (std::uint64_t bits = ended[block]; bits; bits &= bits - 1)
      lone(start + __builtin_ctzll(bits), ENDS);
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

  // the contacts k of which count, of four, are not idle
  template <bool ROLLING, class N, bool TALLY, class Partners>
  SLOPE_INLINE void apply_four(const int *k, const double *crowd, int count, const ContactLaw &law,
                               const Sizes<double> &same, bool repeat, const MovingBalls &balls,
                               const Partners &partners, ContactTally *tally)
  {
    const Entry e[4] = {entries[k[0]], entries[k[1]], entries[k[2]], entries[k[3]]};
    double *const h[4] = {histories[k[0]], histories[k[1]], histories[k[2]], histories[k[3]]};
    Sizes<N> sizes;
    find_sizes(e, law, same, repeat, balls, partners, sizes);
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

    Four history[6];    // in company no step asks for the phase
    const Columns begin(four(h[0]), four(h[1]), four(h[2]), four(h[3]));
    const Columns end(four(h[0] + 2), four(h[1] + 2), four(h[2] + 2), four(h[3] + 2));
    put(begin, history);
    history[3] = begin.w;
    history[4] = end.z;
    history[5] = end.w;

    ContactForceOf<Four> out;
    contact_force<ROLLING>(sizes.step, c, Four(four(crowd)), history, out);

    if (!repeat) {    // otherwise it is what the step has left
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

  template <class Partners>
  SLOPE_INLINE void find_sizes(const Entry *, const ContactLaw &, const Sizes<double> &same, bool,
                               const MovingBalls &, const Partners &, Sizes<double> &sizes) const
  {
    sizes = same;
  }
  template <class Partners>
  SLOPE_INLINE void find_sizes(const Entry *e, const ContactLaw &law, const Sizes<double> &same,
                               bool repeat, const MovingBalls &balls, const Partners &partners,
                               Sizes<Four> &sizes) const
  {
    Four mi = Four(), mj = Four();
    sizes.radius_i = sizes.radius_j = Four();
    for (int m = 0; m < 4; m++) {
      sizes.radius_i[m] = balls.radius[e[m].i];
      sizes.radius_j[m] = partners.radius(e[m].j);
      mi[m] = balls.mass[e[m].i];
      mj[m] = partners.mass(e[m].j);
    }
    sizes.step = step_of(moves, law, same.step.dt, repeat, sizes.radius_i, sizes.radius_j, mi, mj);
  }

  // a contact whose balls touch nothing else
  template <bool ROLLING, bool TALLY, class Partners>
  void apply_lone(int k, Life life, const ContactLaw &law, const Sizes<double> &same,
                  const LoneContact &lone, bool repeat, const MovingBalls &balls,
                  const Partners &partners, ContactTally *tally)
  {
    const Entry e = entries[k];
    Contact c;
    Vector delta;
    set_contact(law, balls, partners, e.i, e.j, c, delta);
    double history[HISTORY];
    std::memcpy(history, histories[k], sizeof(history));
    ContactForce out;
    double ri = same.radius_i, rj = same.radius_j;
    bool known;
    if (equal) {
      known = lone_contact_force<ROLLING>(same.step, lone, life, repeat, c, history, out);
    } else {
      ri = balls.radius[e.i];
      rj = partners.radius(e.j);
      const double mi = balls.mass[e.i], mj = partners.mass(e.j);
      known = lone_contact_force<ROLLING>(step_of(moves, law, same.step.dt, repeat, ri, rj, mi, mj),
                                          lone_of(moves, law, same.step.dt, ri, rj, mi, mj), life,
                                          repeat, c, history, out);
    }
    if (!repeat)
      std::memcpy(histories[k], history, sizeof(history));
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
    if (TALLY) add_to(*tally, e, Vector{out.f[0], out.f[1], out.f[2]}, delta);
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
void find_contacts(const ContactView &view, bool repeat, bool first, const MovingBalls &balls,
                   const Partners &partners)
{
  ContactPasses(view).find(repeat, first, balls, partners);
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

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The passes of a step of scheme solved over a list of contacts, for one set of instructions: see ContactKernel.
   Included by contact_kernel_*.cpp alone. No LAMMPS. */

#ifndef SLOPE_CONTACT_SWEEPS_H
#define SLOPE_CONTACT_SWEEPS_H

#include "contact_passes.h"
#include "solved_contact.h"

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

class ContactSweeps : ContactPasses {
 public:
  SLOPE_INLINE explicit ContactSweeps(const ContactView &view) : ContactPasses(view) {}

  template <class Partners>
  void begin(const ContactLaw &law, double dt, bool repeat, const MovingBalls &balls,
             const Partners &partners)
  {
    *active_count = 0;
    const bool rolls = law.rolling > 0.0;
    if (rolls && equal)
      begin<true, double>(law, dt, repeat, balls, partners);
    else if (rolls)
      begin<true, Four>(law, dt, repeat, balls, partners);
    else if (equal)
      begin<false, double>(law, dt, repeat, balls, partners);
    else
      begin<false, Four>(law, dt, repeat, balls, partners);
  }

  template <bool LAST, bool TALLY, class Partners>
  void sweep(const ContactLaw &law, double dt, const MovingBalls &balls, const Partners &partners,
             ContactTally *tally)
  {
    const bool rolls = law.rolling > 0.0;
    if (rolls && equal)
      sweep<LAST, true, double, TALLY>(law, dt, balls, partners, tally);
    else if (rolls)
      sweep<LAST, true, Four, TALLY>(law, dt, balls, partners, tally);
    else if (equal)
      sweep<LAST, false, double, TALLY>(law, dt, balls, partners, tally);
    else
      sweep<LAST, false, Four, TALLY>(law, dt, balls, partners, tally);
  }

 private:
  // what depends on the sizes of four contacts: N = double if they are equal, otherwise Four
  template <class N> struct SolvedSizes {
    N radius_i, radius_j;
    SolvedStepOf<N> step;
  };

  // Contacts of a step, four at a time: those that touch, and those that touched a step ago. Their springs
  // grow; their forces with the velocities of the middle of the step, and their dashpots, go to the balls.
  template <bool ROLLING, class N, class Partners>
  void begin(const ContactLaw &law_in, double dt, bool repeat, const MovingBalls &balls_in,
             const Partners &partners_in)
  {
    const ContactLaw law = law_in;    // copies: no store below can change them
    const MovingBalls balls = balls_in;
    const Partners partners = partners_in;
    const SolvedSizes<double> same = {
        radius_i, radius_j, solved_step_of(moves, law, dt, radius_i, radius_j, mass_i, mass_j)};
    int found[BLOCK + 4], count = 0;
    double age[BLOCK + 4];    // of a contact: NEW, LASTING, ENDED
    for (size_t block = 0; block < blocks; block++) {
      const std::uint64_t now = touching[block], was = before[block];
      for (std::uint64_t bits = repeat ? now : now | was; bits; bits &= bits - 1) {
        const int k = static_cast<int>(block) * BLOCK + __builtin_ctzll(bits);
        const bool touched = was & bit(k);
        found[count] = k;
        age[count++] = !touched ? NEW : (now & bit(k)) ? LASTING : ENDED;
        if (!touched) std::memset(histories[k], 0, HISTORY * sizeof(double));
      }
      int c = 0;
      for (; c + 4 <= count; c += 4)
        begin_four<ROLLING, N>(&found[c], &age[c], 4, law, same, repeat, balls, partners);
      std::copy(found + c, found + count, found);
      std::copy(age + c, age + count, age);
      count -= c;
    }
    if (count == 0) return;
    for (int c = count; c < 4; c++) {    // idle
      found[c] = found[count - 1];
      age[c] = age[count - 1];
    }
    begin_four<ROLLING, N>(found, age, count, law, same, repeat, balls, partners);
  }

  static constexpr double NEW = 0.0, LASTING = 1.0, ENDED = 2.0;

  // Weights of a contact's first and last step, from its overlap now and a step ago; turn: dt / distance of
  // the centres. Returns the part of the step in which its springs grow.
  // A contact begins and ends within a step, and a force acts from the middle of a step to the middle of
  // the next. A contact that touches for the part f of its first step has dashpots for f + 1/2, one that
  // touched for the part g of its last step for g, of which the force before gave 1/2; contacts shorter than
  // a step are found in that part of the cases only, and count for a whole one. A spring that is stretched
  // at a rate V then has V (f - 1/2)^2/2, V (g - 1/2)^2/2 more than the overlaps say.
  template <class N>
  SLOPE_INLINE static Four set_times(Four age, Four overlap, Four was, Four turn, double *const *h,
                                     SolvedContactOf<Four, N> &c)
  {
    const Four zero = Four(), one = all<Four>(1.0), vn = normal_velocity(c);
    const Four f = choose(was < 0.0, overlap / (overlap - was), one);
    const Four g = choose(was > 0.0, was / (was - overlap), zero);
    Four lasted = Four();
    for (int m = 0; m < 4; m++) lasted[m] = h[m][PHASE];
    const Four over = larger(g, one - lasted) - 0.5;
    c.weight = choose(age == NEW, f + 0.5, choose(age == ENDED, over, one));

    // vn in the middle of these times: the normal turns

    const Four across = c.v[0] * c.v[0] + c.v[1] * c.v[1] + c.v[2] * c.v[2] - vn * vn;
    const Four middle =
        choose(age == NEW, 0.5 * (0.5 - f), choose(age == ENDED, 0.5 * (g - 1.5), zero));
    c.turn = middle * turn * across;
    const Four late = choose(age == NEW, f - 0.5, choose(age == ENDED, g - 0.5, zero));
    c.beyond = 0.5 * late * late * choose(overlap > was, overlap - was, was - overlap);
    const Four grow = choose(age == NEW, f, one);
    for (int m = 0; m < 4; m++) h[m][PHASE] = grow[m];
    return grow;
  }

  template <bool ROLLING, class N, class Partners>
  SLOPE_INLINE void begin_four(const int *k, const double *age, int count, const ContactLaw &law,
                               const SolvedSizes<double> &same, bool repeat,
                               const MovingBalls &balls, const Partners &partners)
  {
    const Entry e[4] = {entries[k[0]], entries[k[1]], entries[k[2]], entries[k[3]]};
    double *const h[4] = {histories[k[0]], histories[k[1]], histories[k[2]], histories[k[3]]};
    SolvedSizes<N> sizes;
    find_solved_sizes(e, law, same, balls, partners, sizes);
    const N ri = sizes.radius_i, rj = sizes.radius_j;
    const double dt = sizes.step.dt;

    SolvedContactOf<Four, N> c;
    c.rolling_radius = law.rolling_factor * ri * rj / (ri + rj);
    const Columns delta = distances(e, balls, partners);
    const Four rsq = delta.x * delta.x + delta.y * delta.y + delta.z * delta.z;
    const Four r = root(rsq), rinv = 1.0 / rsq * r;
    c.n[0] = delta.x * rinv;
    c.n[1] = delta.y * rinv;
    c.n[2] = delta.z * rinv;
    velocities(e, ri, rj, balls.v, balls.omega, partners, c);

    const Four zero = Four(), overlap = ri + rj - r;
    c.weight = choose(four(age) == ENDED, zero, all<Four>(1.0));
    c.turn = c.beyond = zero;
    Four grow = all<Four>(1.0);
    if (!repeat) {
      const Four x = delta.x - dt * c.v[0], y = delta.y - dt * c.v[1], z = delta.z - dt * c.v[2];
      const Four was = ri + rj - root(Four(x * x + y * y + z * z));    // overlap a step ago, m
      grow = set_times(four(age), overlap, was, Four(dt * rinv), h, c);
    }
    c.overlap = larger(overlap, zero);

    Four s[6], u[3];
    load(h, s);
    grow = repeat ? zero : dt * grow;
    sliding_velocity(c, normal_velocity(c), u);
    grow_spring(c.n, u, grow, s);
    if (ROLLING) {
      rolling_velocity(c, u);
      grow_spring(c.n, u, grow, s + 3);
    }
    store<ROLLING>(h, s);

    ActiveContacts &a = active[(*active_count)++];
    std::copy(k, k + 4, a.k);
    a.count = count;
    for (int d = 0; d < 3; d++) four(a.n[d]) = c.n[d];
    four(a.overlap) = c.overlap;
    four(a.weight) = c.weight;
    four(a.turn) = c.turn;
    four(a.beyond) = c.beyond;
    if (!balls.dashpots) return;

    give_dashpots<ROLLING>(e, count, sizes, c, s, balls, partners);
  }

  // dashpots and forces of four contacts, to their balls
  template <bool ROLLING, class N, class Partners>
  SLOPE_INLINE void give_dashpots(const Entry *e, int count, const SolvedSizes<N> &sizes,
                                  const SolvedContactOf<Four, N> &c, Four *s,
                                  const MovingBalls &balls, const Partners &partners) const
  {
    const N ri = sizes.radius_i, rj = sizes.radius_j;
    SolvedForceOf<Four> out;
    solved_force<ROLLING>(sizes.step, c, s, out);
    const double half = 0.5 * sizes.step.dt;
    const Four bn = half * c.weight * sizes.step.cn, bt = half * sizes.step.ct * out.sticks;
    const Four br = half * sizes.step.cr * out.rolls * c.rolling_radius * c.rolling_radius;
    const double twice = Partners::MOVE && moves.i * moves.j > 0.0 ? 2.0 : 1.0;    // solve_ball()
    Four rows[24];
    static const int X[6] = {0, 1, 2, 1, 0, 0}, Y[6] = {0, 1, 2, 2, 2, 1};
    for (int q = 0; q < 6; q++) {
      const Four nn = twice * c.n[X[q]] * c.n[Y[q]];
      rows[q] = (bn - bt) * nn;
      rows[6 + q] = bt * nn;
    }
    for (int d = 0; d < 3; d++) {
      rows[12 + d] = twice * bt * c.n[d];
      rows[17 + d] = out.f[d];
      rows[20 + d] = out.m[d] - ri * out.t[d];
    }
    rows[15] = twice * bt;
    rows[16] = twice * br;
    rows[23] = Four();
    int to[4];
    for (int m = 0; m < 4; m++) to[m] = e[m].i;
    add_rows(rows, to, count, balls);
    if (!Partners::MOVE) return;
    for (int d = 0; d < 3; d++) {
      rows[12 + d] = -rows[12 + d];
      rows[17 + d] = -rows[17 + d];
      rows[20 + d] = -(out.m[d] + rj * out.t[d]);
    }
    for (int m = 0; m < 4; m++) to[m] = partners.gets_force(e[m].j) ? e[m].j : -1;
    add_rows(rows, to, count, balls);
  }

  // sums of four contacts to their balls; -1: none
  SLOPE_INLINE static void add_rows(const Four *rows, const int *to, int count,
                                    const MovingBalls &balls)
  {
    for (int q = 0; q < BallDashpots::SIZE; q += 4) {
      const Columns group(rows[q], rows[q + 1], rows[q + 2], rows[q + 3]);
      const Four column[4] = {group.x, group.y, group.z, group.w};
      for (int m = 0; m < count; m++)
        if (to[m] >= 0) four(balls.dashpots[to[m]].row(q)) += column[m];
    }
  }

  // Forces with the velocities that the balls have found. LAST: they are those of the step, and springs
  // are cut back; otherwise sums for another sweep.
  template <bool LAST, bool ROLLING, class N, bool TALLY, class Partners>
  void sweep(const ContactLaw &law_in, double dt, const MovingBalls &balls_in,
             const Partners &partners_in, ContactTally *tally)
  {
    const ContactLaw law = law_in;
    const MovingBalls balls = balls_in;
    const Partners partners = partners_in;
    const SolvedSizes<double> same = {
        radius_i, radius_j, solved_step_of(moves, law, dt, radius_i, radius_j, mass_i, mass_j)};
    for (size_t n = 0; n < *active_count; n++) {
      const ActiveContacts &a = active[n];
      const Entry e[4] = {entries[a.k[0]], entries[a.k[1]], entries[a.k[2]], entries[a.k[3]]};
      double *const h[4] = {histories[a.k[0]], histories[a.k[1]], histories[a.k[2]],
                            histories[a.k[3]]};
      SolvedSizes<N> sizes;
      find_solved_sizes(e, law, same, balls, partners, sizes);
      const N ri = sizes.radius_i, rj = sizes.radius_j;
      SolvedContactOf<Four, N> c;
      c.rolling_radius = law.rolling_factor * ri * rj / (ri + rj);
      for (int d = 0; d < 3; d++) c.n[d] = four(a.n[d]);
      c.overlap = four(a.overlap);
      c.weight = four(a.weight);
      c.turn = four(a.turn);
      c.beyond = four(a.beyond);
      velocities(e, ri, rj, balls.mean_v, balls.mean_omega, partners, c);
      Four s[6];
      load(h, s);
      SolvedForceOf<Four> out;
      solved_force<ROLLING>(sizes.step, c, s, out);
      if (LAST) store<ROLLING>(h, s);

      const Four none = Four();
      const Columns f(out.f[0], out.f[1], out.f[2], none);
      const Columns ti(out.m[0] - ri * out.t[0], out.m[1] - ri * out.t[1], out.m[2] - ri * out.t[2],
                       none);
      const Columns tj(out.m[0] + rj * out.t[0], out.m[1] + rj * out.t[1], out.m[2] + rj * out.t[2],
                       none);
      const Four force[4] = {f.x, f.y, f.z, f.w}, on_i[4] = {ti.x, ti.y, ti.z, ti.w},
                 on_j[4] = {tj.x, tj.y, tj.z, tj.w};
      for (int m = 0; m < a.count; m++) {
        if (LAST)
          give(e[m], force[m], on_i[m], on_j[m], balls, partners);
        else
          give_sums(e[m], force[m], on_i[m], on_j[m], balls, partners);
        if (TALLY) add_to(*tally, e[m], force[m], balls, partners);
      }
    }
  }

  template <class Partners>
  SLOPE_INLINE static void add_to(ContactTally &tally, const Entry &e, Four force,
                                  const MovingBalls &balls, const Partners &partners)
  {
    const Vector f = {force[0], force[1], force[2]};
    tally.force.x += f.x;
    tally.force.y += f.y;
    tally.force.z += f.z;
    if (!tally.visit) return;
    const Vector &x = balls.x[e.i], &y = partners.x(e.j);
    tally.visit(tally.visitor, e.i, e.j, f, Vector{x.x - y.x, x.y - y.y, x.z - y.z});
  }

  template <class N, class Partners>
  SLOPE_INLINE static void velocities(const Entry *e, N ri, N rj, const Vector *v_of,
                                      const Vector *omega_of, const Partners &,
                                      SolvedContactOf<Four, N> &c)
  {
    Four v[4], rw[4], w[4];
    for (int m = 0; m < 4; m++) {
      v[m] = four(&v_of[e[m].i].x);
      w[m] = four(&omega_of[e[m].i].x);
      rw[m] = lane(ri, m) * w[m];
      if (Partners::MOVE) {
        const Four other = four(&omega_of[e[m].j].x);
        v[m] -= four(&v_of[e[m].j].x);
        rw[m] += lane(rj, m) * other;
        w[m] -= other;
      }
    }
    put(Columns(v[0], v[1], v[2], v[3]), c.v);
    put(Columns(rw[0], rw[1], rw[2], rw[3]), c.rw);
    put(Columns(w[0], w[1], w[2], w[3]), c.w);
  }

  SLOPE_INLINE static void load(double *const *h, Four *s)
  {
    const Columns begin(four(h[0]), four(h[1]), four(h[2]), four(h[3]));
    const Columns end(four(h[0] + 2), four(h[1] + 2), four(h[2] + 2), four(h[3] + 2));
    put(begin, s);
    s[3] = begin.w;
    s[4] = end.z;
    s[5] = end.w;
  }

  template <bool ROLLING> SLOPE_INLINE static void store(double *const *h, const Four *s)
  {
    const Columns rows(s[0], s[1], s[2], s[3]);
    four(h[0]) = rows.x;
    four(h[1]) = rows.y;
    four(h[2]) = rows.z;
    four(h[3]) = rows.w;
    if (ROLLING)
      for (int m = 0; m < 4; m++) {
        h[m][4] = s[4][m];
        h[m][5] = s[5][m];
      }
  }

  template <class Partners>
  SLOPE_INLINE void find_solved_sizes(const Entry *, const ContactLaw &,
                                      const SolvedSizes<double> &same, const MovingBalls &,
                                      const Partners &, SolvedSizes<double> &sizes) const
  {
    sizes = same;
  }
  template <class Partners>
  SLOPE_INLINE void find_solved_sizes(const Entry *e, const ContactLaw &law,
                                      const SolvedSizes<double> &same, const MovingBalls &balls,
                                      const Partners &partners, SolvedSizes<Four> &sizes) const
  {
    Four mi = Four(), mj = Four();
    sizes.radius_i = sizes.radius_j = Four();
    for (int m = 0; m < 4; m++) {
      sizes.radius_i[m] = balls.radius[e[m].i];
      sizes.radius_j[m] = partners.radius(e[m].j);
      mi[m] = balls.mass[e[m].i];
      mj[m] = partners.mass(e[m].j);
    }
    sizes.step = solved_step_of(moves, law, same.step.dt, sizes.radius_i, sizes.radius_j, mi, mj);
  }

  template <class Partners>
  SLOPE_INLINE static void give_sums(const Entry &e, Four f, Four ti, Four tj,
                                     const MovingBalls &balls, const Partners &partners)
  {
    BallDashpots &i = balls.dashpots[e.i];
    for (int d = 0; d < 3; d++) {
      i.f[d] += f[d];
      i.torque[d] += ti[d];
    }
    if (!partners.gets_force(e.j)) return;
    BallDashpots &j = balls.dashpots[e.j];
    for (int d = 0; d < 3; d++) {
      j.f[d] -= f[d];
      j.torque[d] -= tj[d];
    }
  }
};

// vectors of four balls as columns, the fourth of no meaning
SLOPE_INLINE Columns columns_of(const Vector *v, const int *i)
{
  return Columns(four(&v[i[0]].x), four(&v[i[1]].x), four(&v[i[2]].x), four(&v[i[3]].x));
}

// the next velocities of balls begin to end, and their forces cleared: see ContactKernel
inline void solve_balls(const BallSolve &b, int begin, int end)
{
  const double half = 0.5 * b.dt;
  for (int first = begin; first < end; first += 4) {
    int i[4];
    for (int m = 0; m < 4; m++) i[m] = std::min(first + m, end - 1);
    Four rows[BallDashpots::SIZE] = {Four()}, mass = Four(), radius = Four();
    for (int q = 0; q < BallDashpots::SIZE; q += 4) {
      const Columns group(four(b.dashpots[i[0]].row(q)), four(b.dashpots[i[1]].row(q)),
                          four(b.dashpots[i[2]].row(q)), four(b.dashpots[i[3]].row(q)));
      rows[q] = group.x;
      rows[q + 1] = group.y;
      rows[q + 2] = group.z;
      rows[q + 3] = group.w;
    }
    for (int m = 0; m < 4; m++) {
      mass[m] = b.mass[i[m]];
      radius[m] = b.radius[i[m]];
    }

    // the impulses of half a step, less what the velocities have of them already

    const Columns v = columns_of(b.v, i), mean = columns_of(b.mean_v, i);
    const Columns g = columns_of(b.field, i);
    const Columns w = columns_of(b.omega, i), mean_w = columns_of(b.mean_omega, i);
    const Four *const force = rows + BallDashpots::FORCE, *const torque = force + 3;
    const Four inertia = 0.4 * mass * radius * radius;
    const Four p[3] = {half * (force[0] + mass * g.x) - mass * (mean.x - v.x),
                       half * (force[1] + mass * g.y) - mass * (mean.y - v.y),
                       half * (force[2] + mass * g.z) - mass * (mean.z - v.z)};
    const Four q[3] = {half * torque[0] - inertia * (mean_w.x - w.x),
                       half * torque[1] - inertia * (mean_w.y - w.y),
                       half * torque[2] - inertia * (mean_w.z - w.z)};
    Four dv[3], dw[3];
    solve_ball(mass, radius, rows, rows + 6, rows + 12, rows[15], rows[16], p, q, dv, dw);
    for (int m = 0; m < 4 && first + m < end; m++) {
      Vector &to = b.mean_v[i[m]], &spin = b.mean_omega[i[m]];
      to = {to.x + dv[0][m], to.y + dv[1][m], to.z + dv[2][m]};
      spin = {spin.x + dw[0][m], spin.y + dw[1][m], spin.z + dw[2][m]};
      BallDashpots &sums = b.dashpots[i[m]];
      for (int d = 0; d < 3; d++) sums.f[d] = sums.torque[d] = 0.0;
    }
  }
}

template <class Partners>
void begin_contacts(const ContactView &view, const ContactLaw &law, double dt, bool repeat,
                    const MovingBalls &balls, const Partners &partners)
{
  ContactSweeps(view).begin(law, dt, repeat, balls, partners);
}

template <class Partners>
void sweep_contacts(const ContactView &view, const ContactLaw &law, double dt,
                    const MovingBalls &balls, const Partners &partners)
{
  ContactSweeps(view).template sweep<false, false>(law, dt, balls, partners, nullptr);
}

template <class Partners>
void finish_contacts(const ContactView &view, const ContactLaw &law, double dt,
                     const MovingBalls &balls, const Partners &partners, ContactTally *tally)
{
  if (tally)
    ContactSweeps(view).template sweep<true, true>(law, dt, balls, partners, tally);
  else
    ContactSweeps(view).template sweep<true, false>(law, dt, balls, partners, tally);
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

// a constant, so that none of this code runs before its kernel has been chosen
#define SLOPE_CONTACT_KERNEL                                                                     \
  {                                                                                              \
    find_contacts<MovingPartners>, find_contacts<FixedPartners>, apply_contacts<MovingPartners>, \
        apply_contacts<FixedPartners>,                                                           \
        {begin_contacts<MovingPartners>, sweep_contacts<MovingPartners>,                         \
         finish_contacts<MovingPartners>},                                                       \
        {begin_contacts<FixedPartners>, sweep_contacts<FixedPartners>,                           \
         finish_contacts<FixedPartners>},                                                        \
        solve_balls                                                                              \
  }

#endif

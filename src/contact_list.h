/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Contacts of one law: what may touch until the next neighbor list, and the forces of what
   does. Per block of listed contacts: distances; the touching ones gathered side by side; the
   contact law for several of them at a time (SIMD); forces handed out. Gathering first keeps
   the branch out of the arithmetic, and a block stays within the first-level cache.
   Pair gran/restitution and fix wall/gran/balls both use it. No LAMMPS in here. */

#ifndef SLOPE_CONTACT_LIST_H
#define SLOPE_CONTACT_LIST_H

#include "contact_law.h"
#include "simd4.h"

#include <algorithm>
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
  void prefetch_force(int j) const { __builtin_prefetch(&balls.f[j],1); __builtin_prefetch(&balls.torque[j],1); }
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
  void prefetch_force(int) const {}
  const Vector &v(int) const { return still; }
  const Vector &omega(int) const { return still; }
  double radius(int) const { return radius_all; }
  double mass(int) const { return 1.0; }
};

class ContactList {
 public:
  struct Entry {
    int i, j;           // moving ball, partner
    double *history;    // HISTORY values
  };

  std::vector<Entry> entries;
  std::vector<char> touching;    // a step ago
  std::vector<int *> flags;      // where LAMMPS wants to know about touching: store_flags()

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
    entries.push_back({i, j, history});
    touching.push_back(touch);
  }

  double memory_usage() const
  {
    return entries.capacity() * sizeof(Entry) + touching.capacity() +
        flags.capacity() * sizeof(int *);
  }

  // Contacts that overlap although they did not touch a step ago, before the first step:
  // visit(entry, overlap). They count as old ones.
  template <class Partners, class Visit>
  void start(const MovingBalls &balls, const Partners &partners, Visit visit)
  {
    for (size_t k = 0; k < entries.size(); k++) {
      const Entry &e = entries[k];
      const double overlap = balls.radius[e.i] + partners.radius(e.j) - distance(balls, partners, e);
      if (touching[k] || overlap <= 0.0) continue;
      visit(e, overlap);
      touching[k] = 1;
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
      const double n[3] = {a.x - b.x, a.y - b.y, a.z - b.z}, *h = e.history;
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
    for (size_t k = 0; k < flags.size(); k++) *flags[k] = touching[k];
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
      if (equal) apply<true, true, TALLY>(law, dt, again, balls, partners, tally);
      else apply<true, false, TALLY>(law, dt, again, balls, partners, tally);
    } else {
      if (equal) apply<false, true, TALLY>(law, dt, again, balls, partners, tally);
      else apply<false, false, TALLY>(law, dt, again, balls, partners, tally);
    }
  }

 private:
  static constexpr int BLOCK = 64;

  // a block of listed contacts and, side by side, the touching ones: Contact and ContactForce

  struct Block {
    double apart[BLOCK][4], rsq[BLOCK];    // of all listed contacts; the fourth is idle
    int from[BLOCK + 4];                   // the touching ones among them
    double delta[3][BLOCK];
    double v[3][BLOCK], rw[3][BLOCK], w[3][BLOCK];
    double radius_i[BLOCK], radius_j[BLOCK], mass_i[BLOCK], mass_j[BLOCK];    // unless equal
    double history[HISTORY][BLOCK];
    double n[3][BLOCK], overlap[BLOCK], growth[BLOCK], normal[BLOCK], phase[BLOCK], special[BLOCK];
    double f[3][BLOCK], torque_i[3][BLOCK], torque_j[3][BLOCK];
  };

  template <class Partners>
  static double distance(const MovingBalls &balls, const Partners &partners, const Entry &e)
  {
    const Vector &a = balls.x[e.i], &b = partners.x(e.j);
    const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    return std::sqrt(dx * dx + dy * dy + dz * dz);
  }

  template <bool ROLLING, bool EQUAL, bool TALLY, class Partners, class Tally>
  void apply(const ContactLaw &law_in, double dt, bool again, const MovingBalls &balls,
             const Partners &partners, Tally tally)
  {
    const ContactLaw law = law_in;    // a copy: no store below can change it
    const double mass_factor = move_i * move_j > 0.0 ? law.mass_factor : 1.0;
    const double inverse = move_i / mass_i + move_j / mass_j;
    const ContactStep step = contact_step(law, inverse, mass_factor / inverse, dt, again);
    Block b;

    for (size_t start = 0; start < entries.size(); start += BLOCK) {
      const int listed = static_cast<int>(std::min<size_t>(BLOCK, entries.size() - start));
      const Entry *e = &entries[start];
      Entry padded[BLOCK];
      if (listed < BLOCK) {    // four at a time: the last one stands for those that are missing
        std::fill(std::copy(e, e + listed, padded), padded + BLOCK, e[listed - 1]);
        e = padded;
      }
      find_distances(b, e, listed, balls, partners);
      const int count = find_touching<EQUAL>(b, e, &touching[start], listed, law, balls, partners);
      gather<EQUAL>(b, e, count, balls, partners);
      evaluate<ROLLING, EQUAL>(b, count, law, step, mass_factor);

      for (int c = 0; c < count; c++) {
        const int i = e[b.from[c]].i, j = e[b.from[c]].j;
        double *history = e[b.from[c]].history;
        if (!again)    // otherwise it is what the step has left
          for (int h = 0; h < HISTORY; h++) history[h] = b.history[h][c];
        Vector &f = balls.f[i], &t = balls.torque[i];
        f.x += b.f[0][c];
        f.y += b.f[1][c];
        f.z += b.f[2][c];
        t.x += b.torque_i[0][c];
        t.y += b.torque_i[1][c];
        t.z += b.torque_i[2][c];
        give(partners, j, b, c);
        if (TALLY)
          tally(i, j, Vector{b.f[0][c], b.f[1][c], b.f[2][c]},
                Vector{b.delta[0][c], b.delta[1][c], b.delta[2][c]});
      }
    }
  }

  template <class Partners>
  static void find_distances(Block &b, const Entry *e, int listed, const MovingBalls &balls,
                             const Partners &partners)
  {
    for (int k = 0; k < listed; k += 4) {
      for (int m = k; m < k + 4; m++) {
        four(b.apart[m]) = four(&balls.x[e[m].i].x) - four(&partners.x(e[m].j).x);
      }
      const Columns d(four(b.apart[k]), four(b.apart[k + 1]), four(b.apart[k + 2]),
                      four(b.apart[k + 3]));
      four(&b.rsq[k]) = d.x * d.x + d.y * d.y + d.z * d.z;
    }
  }

  // which of the listed contacts touch: from, and their number; those that begin get a history
  template <bool EQUAL, class Partners>
  int find_touching(Block &b, const Entry *e, char *was, int listed, const ContactLaw &law,
                    const MovingBalls &balls, const Partners &partners) const
  {
    const double sum = radius_i + radius_j;
    double reach[BLOCK];
    if (!EQUAL)
      for (int k = 0; k < listed; k++) {
        const double different = balls.radius[e[k].i] + partners.radius(e[k].j);
        reach[k] = different * different;
      }
    int count = 0, changes = 0, changed[BLOCK];
    for (int k = 0; k < listed; k++) {
      const int now = b.rsq[k] < (EQUAL ? sum * sum : reach[k]);
      b.from[count] = k;
      count += now;
      changed[changes] = k;
      changes += now ^ was[k];
    }
    for (int c = 0; c < changes; c++) {
      const int k = changed[c];
      was[k] ^= 1;
      double *history = e[k].history;
      memset(history, 0, HISTORY * sizeof(double));
      if (!was[k]) continue;
      const double ri = balls.radius[e[k].i], rj = partners.radius(e[k].j);
      const double mark =
          new_contact(law.rolling_factor * ri * rj / (ri + rj)) / std::sqrt(b.rsq[k]);
      for (int d = 0; d < 3; d++) history[d] = mark * b.apart[k][d];
    }
    for (int c = 0; c < count; c++) {    // ahead of gather()
      const Entry &touching_one = e[b.from[c]];
      __builtin_prefetch(touching_one.history, 1);
      if (Partners::MOVE) {
        __builtin_prefetch(&partners.v(touching_one.j));
        __builtin_prefetch(&partners.omega(touching_one.j));
      }
    }
    return count;
  }

  template <bool EQUAL, class Partners>
  void gather(Block &b, const Entry *e, int count, const MovingBalls &balls,
              const Partners &partners) const
  {
    if (count == 0) return;
    for (int c = count; c % 4; c++) b.from[c] = b.from[count - 1];

    for (int c = 0; c < count; c += 4) {
      Four v[4], rw[4], w[4];
      for (int m = 0; m < 4; m++) {
        const Entry &entry = e[b.from[c + m]];
        const int i = entry.i, j = entry.j;
        const double ri = EQUAL ? radius_i : balls.radius[i];
        const double rj = EQUAL ? radius_j : partners.radius(j);
        v[m] = four(&balls.v[i].x);
        w[m] = four(&balls.omega[i].x);
        rw[m] = ri * w[m];
        if (Partners::MOVE) {
          v[m] -= four(&partners.v(j).x);
          rw[m] += rj * four(&partners.omega(j).x);
          w[m] -= four(&partners.omega(j).x);
          partners.prefetch_force(j);
        }
        if (!EQUAL) {
          b.radius_i[c + m] = ri;
          b.radius_j[c + m] = rj;
          b.mass_i[c + m] = balls.mass[i];
          b.mass_j[c + m] = partners.mass(j);
        }
      }
      const int *from = &b.from[c];
      put(b.delta, c, Columns(four(b.apart[from[0]]), four(b.apart[from[1]]),
                              four(b.apart[from[2]]), four(b.apart[from[3]])));
      put(b.v, c, Columns(v[0], v[1], v[2], v[3]));
      put(b.rw, c, Columns(rw[0], rw[1], rw[2], rw[3]));
      put(b.w, c, Columns(w[0], w[1], w[2], w[3]));
      const double *const h[4] = {e[from[0]].history, e[from[1]].history, e[from[2]].history,
                                  e[from[3]].history};
      put(b.history, c, Columns(four(h[0]), four(h[1]), four(h[2]), four(h[3])));
      const Columns rest(four(h[0] + 2), four(h[1] + 2), four(h[2] + 2), four(h[3] + 2));
      four(&b.history[3][c]) = rest.y;
      four(&b.history[4][c]) = rest.z;
      four(&b.history[5][c]) = rest.w;
    }
  }

  static void put(double (*rows)[BLOCK], int c, const Columns &columns)
  {
    four(&rows[0][c]) = columns.x;
    four(&rows[1][c]) = columns.y;
    four(&rows[2][c]) = columns.z;
  }

  static void give(const FixedPartners &, int, const Block &, int) {}
  static void give(const MovingPartners &partners, int j, const Block &b, int c)
  {
    if (j >= partners.nforce) return;
    Vector &f = partners.balls.f[j], &t = partners.balls.torque[j];
    f.x -= b.f[0][c];
    f.y -= b.f[1][c];
    f.z -= b.f[2][c];
    t.x += b.torque_j[0][c];
    t.y += b.torque_j[1][c];
    t.z += b.torque_j[2][c];
  }

  // where contact k of the touching ones is, and how fast
  static void contact_of(const Block &b, int k, double ri, double rj, const ContactLaw &law, Contact &c)
  {
    const double dx = b.delta[0][k], dy = b.delta[1][k], dz = b.delta[2][k];
    const double r = std::sqrt(dx * dx + dy * dy + dz * dz), rinv = 1.0 / r;
    c.overlap = ri + rj - r;
    c.rolling_radius = law.rolling_factor * ri * rj / (ri + rj);
    for (int d = 0; d < 3; d++) {
      c.n[d] = b.delta[d][k] * rinv;
      c.v[d] = b.v[d][k];
    }
  }

  // forces of the touching contacts
  template <bool ROLLING, bool EQUAL>
  void evaluate(Block &b, int count, const ContactLaw &law, const ContactStep &same,
                double mass_factor) const
  {
    const int end = (count + 3) & ~3;    // what gather() has filled
    const double of_i = move_i, of_j = move_j;    // locals: no store can change them
    const double same_ri = radius_i, same_rj = radius_j;
#pragma GCC ivdep
    for (int k = 0; k < end; k++) {
      ContactStep step = same;
      if (!EQUAL) {
        const double inverse = of_i / b.mass_i[k] + of_j / b.mass_j[k];
        set_mass(step, law, inverse, mass_factor / inverse);
      }
      Contact c;
      contact_of(b, k, EQUAL ? same_ri : b.radius_i[k], EQUAL ? same_rj : b.radius_j[k], law, c);
      const double history[3] = {b.history[0][k], b.history[1][k], b.history[2][k]};
      double V, phase;
      contact_motion(step, c, history, V, phase);
      const double F = inside_force(step, c.overlap, V);
      for (int d = 0; d < 3; d++) b.n[d][k] = c.n[d];
      b.normal[k] = F;
      b.growth[k] = V;
      b.overlap[k] = c.overlap;
      b.phase[k] = begins_or_ends(step, c.overlap, V, phase, F) ? phase : INSIDE;
      b.special[k] = begins_or_ends(step, c.overlap, V, phase, F) ? 1.0 : 0.0;
    }
    int specials = 0, which[BLOCK];
    for (int k = 0; k < count; k++) {
      which[specials] = k;
      specials += b.special[k] > 0.0;
    }
    for (int s = 0; s < specials; s++) {
      const int k = which[s];
      ContactStep step = same;
      if (!EQUAL) {
        const double inverse = of_i / b.mass_i[k] + of_j / b.mass_j[k];
        set_mass(step, law, inverse, mass_factor / inverse);
      }
      b.normal[k] = normal_force(step, b.overlap[k], b.growth[k], b.phase[k]);
    }
#pragma GCC ivdep
    for (int k = 0; k < end; k++) {
      const double ri = EQUAL ? same_ri : b.radius_i[k];
      const double rj = EQUAL ? same_rj : b.radius_j[k];
      ContactStep step = same;
      if (!EQUAL) {
        const double inverse = of_i / b.mass_i[k] + of_j / b.mass_j[k];
        set_mass(step, law, inverse, mass_factor / inverse);
      }
      Contact c;
      ContactForce out;
      double history[HISTORY];
      c.rolling_radius = law.rolling_factor * ri * rj / (ri + rj);
      for (int d = 0; d < 3; d++) {
        c.n[d] = b.n[d][k];
        c.v[d] = b.v[d][k];
        c.rw[d] = b.rw[d][k];
        c.w[d] = b.w[d][k];
      }
      for (int h = 0; h < HISTORY; h++) history[h] = b.history[h][k];
      contact_force<ROLLING>(step, c, b.normal[k], b.phase[k], history, out);
      for (int h = 0; h < HISTORY; h++) b.history[h][k] = history[h];
      for (int d = 0; d < 3; d++) {
        b.f[d][k] = out.f[d];
        b.torque_i[d][k] = out.m[d] - ri * out.t[d];
        b.torque_j[d][k] = -out.m[d] - rj * out.t[d];
      }
    }
  }
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Contacts of one law: what may touch until the next neighbor list, and what does. A step has two passes,
   each over the lists of all styles: find() tells from the distances which contacts touch and counts
   those of each ball; apply() evaluates the law and hands out the forces. Pair gran/restitution and the wall
   fixes use it. The work is done by the kernels, contact_passes.h. No LAMMPS. */

#ifndef SLOPE_CONTACT_LIST_H
#define SLOPE_CONTACT_LIST_H

#include "contact_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace Slope {

// of the centres, m
template <class Partners>
double distance(const MovingBalls &balls, const Partners &partners, int i, int j)
{
  const Vector &a = balls.x[i], &b = partners.x(j);
  const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

class ContactList : public ContactSizes {
 public:
  typedef ContactEntry Entry;

  std::vector<Entry> entries;
  std::vector<double *> histories;    // HISTORY values of each
  std::vector<int *> flags;    // where LAMMPS wants to know what has a history: flag_histories()

  ContactList() { clear(); }

  void clear(bool i_moves = true, bool j_moves = true)
  {
    moves = {i_moves ? 1.0 : 0.0, j_moves ? 1.0 : 0.0};
    radius_i = radius_j = mass_i = mass_j = 1.0;
    entries.clear();
    histories.clear();
    bits.clear();
    flags.clear();
    equal = true;
    varying = false;
    forget_rows();
    watched = 0;
    seen.clear();
  }

  // has_history: the contact touched a step ago, or ended in it; then its history is there
  void add(int i, int j, double *history, bool has_history, double ri, double rj, double mi,
           double mj)
  {
    if (entries.empty()) {
      radius_i = ri;
      radius_j = rj;
      mass_i = mi;
      mass_j = mj;
    }
    equal =
        equal && same(ri, radius_i) && same(rj, radius_j) && same(mi, mass_i) && same(mj, mass_j);
    if (entries.size() % BLOCK == 0) bits.push_back({0, 0, 0, 0, 0});
    entries.push_back({i, j});
    histories.push_back(history);
    if (has_history) set_history(entries.size() - 1);
  }

  // radii and masses may change until the next neighbor list
  void let_vary()
  {
    equal = false;
    varying = true;
  }

  // The partners stand still, and most are out of reach: all are looked at again when one of so many balls, the
  // first ones, has moved. Until the next neighbor list.
  void watch(int balls) { watched = balls; }

  // contact k has a history
  void set_history(size_t k)
  {
    const double age = histories[k][AGE];
    ContactBits &b = bits[k / BLOCK];
    (has_ended(age) ? b.ended : b.touching) |= bit(k);
    if (is_new(age)) b.fresh |= bit(k);
  }

  bool touches(size_t k) const { return bits[k / BLOCK].touching & bit(k); }    // in the last step
  bool has_history(size_t k) const { return touches(k) || bits[k / BLOCK].ended & bit(k); }

  // visit(k) for each contact that touched in the last step
  template <class Visit> void for_each_touching(Visit visit) const
  {
    for (size_t block = 0; block < bits.size(); block++)
      for (std::uint64_t left = bits[block].touching; left; left &= left - 1)
        visit(block * BLOCK + __builtin_ctzll(left));
  }

  double memory_usage() const
  {
    return entries.capacity() * sizeof(Entry) + histories.capacity() * sizeof(double *) +
        bits.capacity() * sizeof(ContactBits) + flags.capacity() * sizeof(int *) +
        (row_numbers.capacity() + unsolved.capacity() + near_numbers.capacity()) * sizeof(int) +
        (rows.capacity() + companies.capacity()) * sizeof(double) +
        near_entries.capacity() * sizeof(Entry) + seen.capacity() * sizeof(Vector);
  }

  // Contacts that overlap although they did not touch a step ago, before the first step:
  // visit(entry, overlap). They count as old ones.
  template <class Partners, class Visit>
  void adopt_overlaps(const MovingBalls &balls, const Partners &partners, Visit visit)
  {
    for (size_t k = 0; k < entries.size(); k++) {
      const Entry &e = entries[k];
      const double overlap =
          touching(balls.radius[e.i], partners.radius(e.j)) - distance(balls, partners, e.i, e.j);
      if (touches(k) || overlap <= 0.0) continue;
      visit(e, overlap);
      std::memset(histories[k], 0, HISTORY * sizeof(double));
      bits[k / BLOCK].touching |= bit(k);
      bits[k / BLOCK].ended &= ~bit(k);
    }
  }

  // First pass of a step: find_contacts() of contact_passes.h, compiled for this processor
  template <class Partners>
  void find(bool repeat, const MovingBalls &balls, const Partners &partners)
  {
    if (entries.empty()) return;
    ContactView v = view();
    if (!Partners::MOVE && watched > 0 && !repeat) look_near(v, balls.x);
    ContactKernels::current().with(partners).find_contacts(v, repeat, balls, partners);
  }

  void flag_histories() const
  {
    for (size_t k = 0; k < flags.size(); k++) *flags[k] = has_history(k);
  }

  // Second pass: apply_contacts() of contact_passes.h
  template <class Partners>
  void apply(const ContactLaw &law, double dt, bool repeat, const MovingBalls &balls,
             const Partners &partners, ContactTally *tally = nullptr)
  {
    if (entries.empty()) return;
    if (!equal) make_rows(dt);
    ContactKernels::current().with(partners).apply_contacts(view(), law, dt, repeat, balls,
                                                            partners, tally);
  }

 private:
  static constexpr int BLOCK = ContactView::BLOCK;

  std::vector<ContactBits> bits;

  // Of a watched list: how many of the balls are watched; where they were when all contacts were looked at, how many
  // steps ago, and the contacts whose gaps were smaller than the room (m), which alone are looked at until a ball has
  // moved by that. The room follows how fast the balls are.
  int watched, steps = 0;
  std::vector<Vector> seen;
  double room = 0.0;
  NearContacts near = {nullptr, nullptr, 0};
  std::vector<int> near_numbers;
  std::vector<Entry> near_entries;
  static constexpr double LEAST_ROOM = 0.01, MOST_ROOM = 0.15;    // of the distance of the centres
  static constexpr int OFTEN = 8, SELDOM = 32;                    // steps

  void look_near(ContactView &v, const Vector *x)
  {
    static constexpr double COORDINATE = 0.57;    // of a way, < 1/sqrt(3)
    const size_t numbers = 3 * static_cast<size_t>(watched);
    const bool noted = !seen.empty() &&
        !ContactKernels::current().any_moved(&x->x, &seen[0].x, numbers, COORDINATE * room);
    if (!noted) note_anew(x);
    steps++;
    v.look = noted ? ContactView::NOTED : ContactView::NOTE;
    v.room = room;
    v.near = &near;
  }

  void note_anew(const Vector *x)
  {
    const double reach = radius_i + radius_j;
    if (!seen.empty() && steps < OFTEN) room *= 1.5;
    if (steps > SELDOM) room /= 1.5;
    room = std::max(LEAST_ROOM * reach, std::min(room, MOST_ROOM * reach));
    steps = 0;
    seen.assign(x, x + watched);
    near_numbers.resize(entries.size() + 3);
    near_entries.resize(entries.size() + 3);
    near = {near_numbers.data(), near_entries.data(), 0};
  }

  std::vector<double> companies;    // see ContactView
  ContactStep of_step = ContactStep();

  // where the balls are unequal: see ContactView
  bool varying;
  std::vector<int> row_numbers, unsolved;
  std::vector<double> rows;
  double solved_dt = 0.0;

  void forget_rows()
  {
    for (ContactBits &b : bits) b.solved = 0;
    rows.clear();
    unsolved.clear();
  }

  // a row for each contact that has a force in this step
  void make_rows(double dt)
  {
    if (varying || dt != solved_dt) forget_rows();
    solved_dt = dt;
    unsolved.clear();
    row_numbers.resize(entries.size());
    int next = static_cast<int>(rows.size() / ContactView::ROW);
    for (size_t block = 0; block < bits.size(); block++) {
      ContactBits &b = bits[block];
      std::uint64_t left = (b.touching | b.before | b.ended) & ~b.solved;
      for (b.solved |= left; left; left &= left - 1) {
        const int k = static_cast<int>(block) * BLOCK + __builtin_ctzll(left);
        row_numbers[k] = next++;
        unsolved.push_back(k);
      }
    }
    rows.resize(static_cast<size_t>(next) * ContactView::ROW);
  }

  // sizes that differ by rounding are one: unequal balls take more time
  static bool same(double a, double b) { return std::fabs(a - b) <= 1.0e-12 * b; }

  static std::uint64_t bit(size_t k) { return std::uint64_t(1) << (k % BLOCK); }

  ContactView view()
  {
    ContactView v = ContactView();
    static_cast<ContactSizes &>(v) = *this;
    v.entries = entries.data();
    v.histories = histories.data();
    v.size = entries.size();
    v.blocks = bits.size();
    v.bits = bits.data();
    if (companies.empty() && equal && moves.i * moves.j > 0.0)
      companies.resize(4 * ContactView::COMPANIES);
    v.companies = companies.data();
    v.of_step = &of_step;
    v.row_numbers = row_numbers.data();
    v.rows = rows.data();
    v.unsolved = unsolved.data();
    v.unsolved_size = unsolved.size();
    return v;
  }
};

// a tally that calls visit(i, j, force on i, vector j -> i) for each contact; visit must outlive it
template <class Visit> ContactTally tally_of(Visit &visit)
{
  return {{0.0, 0.0, 0.0},
          [](void *v, int i, int j, const Vector &f, const Vector &d) {
            (*static_cast<Visit *>(v))(i, j, f, d);
          },
          &visit};
}

}    // namespace Slope

#endif

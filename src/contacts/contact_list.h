// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Contacts of one law: what may touch until the next neighbor list, and what does. A step has two passes,
   each over the lists of all styles: find() tells from the distances which contacts touch and counts
   those of each ball; apply() evaluates the law and hands out the forces. Pair gran/restitution and the wall
   fixes use it. The work is done by the kernels. No LAMMPS. */

#ifndef SLOPE_CONTACT_LIST_H
#define SLOPE_CONTACT_LIST_H

#include "contact_geometry.h"
#include "contact_kernel.h"

#include <cstdint>
#include <cstring>
#include <vector>

namespace Slope {

class ContactList : public ContactSizes {
 public:
  typedef ContactEntry Entry;

  std::vector<Entry> entries;
  std::vector<double *> histories;    // HISTORY values of each
  std::vector<int *> flags;    // where LAMMPS wants to know what has a history: store_flags()

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
    equal = equal && ri == radius_i && rj == radius_j && mi == mass_i && mj == mass_j;
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
        (row_numbers.capacity() + unsolved.capacity()) * sizeof(int) +
        rows.capacity() * sizeof(double);
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

  // First pass of a step: see ContactKernel
  template <class Partners>
  void find(bool repeat, const MovingBalls &balls, const Partners &partners)
  {
    if (!entries.empty()) ContactKernels::current().find(view(), repeat, balls, partners);
  }

  void store_flags() const
  {
    for (size_t k = 0; k < flags.size(); k++) *flags[k] = has_history(k);
  }

  // Second pass: see ContactKernel
  template <class Partners>
  void apply(const ContactLaw &law, double dt, bool repeat, const MovingBalls &balls,
             const Partners &partners, ContactTally *tally = nullptr)
  {
    if (entries.empty()) return;
    if (!equal) make_rows(dt);
    ContactKernels::current().apply(view(), law, dt, repeat, balls, partners, tally);
  }

 private:
  static constexpr int BLOCK = ContactView::BLOCK;

  std::vector<ContactBits> bits;

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

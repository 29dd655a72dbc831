/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CONTACT_STORE_H
#define SLOPE_CONTACT_STORE_H

#include "pointers.h"

#include "contact_list.h"
#include "my_page.h"

#include <cstdint>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// The contacts of a wall's lists, kept by atom between one neighbor list and the next, and while
// atoms migrate, are sorted, or go into a restart file: the number of each partner in the wall
// (0 to 2^53, which stays the same when the lists' own indices do not) and the contact's history.
// A fix owns one and passes LAMMPS' calls on to it. lists: one for each type of the moving ball.
class ContactStore : protected Pointers {
 public:
  typedef std::vector<Slope::ContactList> Lists;

  ContactStore(class LAMMPS *, const std::string &caller);
  ~ContactStore() override;

  // take what has a history from the lists; number(j) is that of the lists' partner j
  template <typename Number> void take(const Lists &lists, Number number);

  // allot a history to each entry of new lists, the stored one to a contact that is known
  template <typename Number> void give(Lists &lists, Number number);

  // what the methods of Fix with these names do
  void grow_arrays(int nmax);
  void copy_arrays(int i, int j);
  void set_arrays(int i) { ncontact[i] = 0; }
  int pack_exchange(int i, double *buf) const;
  int unpack_exchange(int i, const double *buf);
  int size_restart(int i) const { return 2 + ncontact[i] * SIZE; }
  int maxsize_restart() const;    // collective
  int pack_restart(int i, double *buf) const;
  void unpack_restart(int i, int nth);
  double memory_usage() const;

  int maxexchange;    // values that pack_exchange() packs at most

 private:
  static constexpr int SIZE = 1 + Slope::HISTORY;    // values of a contact

  const std::string caller;
  int *ncontact;
  double **values;
  MyPage<double> page;
  std::vector<double> histories;    // of the lists

  void clear();
  void allot(int i, int n);
  void remember(int i, int64_t number, const double *history);
};

/* ---------------------------------------------------------------------- */

template <typename Number> void ContactStore::take(const Lists &lists, Number number)
{
  clear();
  for (const Slope::ContactList &l : lists)
    for (size_t k = 0, end; k < l.entries.size(); k = end) {
      const int i = l.entries[k].i;    // its entries follow one another
      int n = 0;
      for (end = k; end < l.entries.size() && l.entries[end].i == i; end++) n += l.has_history(end);
      if (n > 0) allot(i, n);
      for (; k < end && n > 0; k++)
        if (l.has_history(k)) remember(i, number(l.entries[k].j), l.histories[k]);
    }
}

template <typename Number> void ContactStore::give(Lists &lists, Number number)
{
  size_t total = 0;
  for (const Slope::ContactList &l : lists) total += l.entries.size();
  histories.assign(total * Slope::HISTORY, 0.0);
  double *next = histories.data();
  for (Slope::ContactList &l : lists)
    for (size_t k = 0; k < l.entries.size(); k++, next += Slope::HISTORY) {
      const Slope::ContactList::Entry &e = l.entries[k];
      l.histories[k] = next;
      const double *stored = values[e.i];
      for (int p = 0; p < ncontact[e.i]; p++, stored += SIZE)
        if (stored[0] == static_cast<double>(number(e.j))) {
          std::memcpy(next, stored + 1, Slope::HISTORY * sizeof(double));
          l.set_history(k);
        }
    }
}

}    // namespace LAMMPS_NS

#endif

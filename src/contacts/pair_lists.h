/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contacts of balls with balls, as lists: one for each pair of types, and for which of the two is frozen.
   They are made from LAMMPS' neighbor list and its histories, and good until the next one. */

#ifndef SLOPE_PAIR_LISTS_H
#define SLOPE_PAIR_LISTS_H

#include "pointers.h"

#include "contact_list.h"
#include "contact_table.h"

#include <vector>

namespace LAMMPS_NS {

class PairLists : protected Pointers {
 public:
  PairLists(LAMMPS *lmp, const ContactTable &laws) : Pointers(lmp), table(laws) {}

  // frozen: group bit; vary: radii and masses may change before the next neighbor list
  void build(const class NeighList &, class FixNeighHistory &, int frozen, bool vary,
             class ContactGuards &);

  // which contacts touch, counted with the balls; repeat: in the step that has just ended, at a set-up, where
  // a run must not begin with deep overlaps
  void find(bool repeat, const Slope::MovingBalls &, const Slope::MovingPartners &,
            const class ContactGuards &);

  // use(list, its law) for all lists
  template <class Use> void for_each(Use use)
  {
    for (size_t k = 0; k < lists.size(); k++) use(lists[k], table.law(k / SIDES));
  }

  // of the springs of this rank's contacts, J
  double elastic_energy(const Slope::MovingBalls &, const Slope::MovingPartners &, ContactGuards &);

  void flag_histories() const;    // which contacts have a history, to where LAMMPS keeps it
  double memory_usage() const;

 private:
  enum { BOTH_MOVE, I_FROZEN, J_FROZEN, SIDES };
  const ContactTable &table;
  std::vector<Slope::ContactList> lists;    // by type pair, as the table, and side
};

}    // namespace LAMMPS_NS

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* In a list of unequal balls each contact has a ContactStep of its own. It depends on sizes and masses alone,
   and solving for it takes longer than the contact's force: it is solved once, when a list meets the contact
   touching for the first time, and kept as a row of numbers. */

#ifndef SLOPE_CONTACT_ROWS_H
#define SLOPE_CONTACT_ROWS_H

#include "contact_kernel.h"
#include "simd4.h"

#include <algorithm>
#include <cstring>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

// to the rows of four contacts k
SLOPE_INLINE void store_rows(const ContactView &view, const int *k, const ContactOwnOf<Four> &s)
{
  Four numbers[ContactView::ROW] = {};
  std::memcpy(numbers, &s, sizeof(s));
  for (int n = 0; n < ContactView::ROW; n += 4) {
    const Columns c(numbers[n], numbers[n + 1], numbers[n + 2], numbers[n + 3]);
    four(view.row(k[0]) + n) = c.x;
    four(view.row(k[1]) + n) = c.y;
    four(view.row(k[2]) + n) = c.z;
    four(view.row(k[3]) + n) = c.w;
  }
}

// law: what all contacts share
SLOPE_INLINE ContactStepOf<Four> load_rows(const ContactView &view, const int *k,
                                           const ContactShared &law)
{
  const double *const r[4] = {view.row(k[0]), view.row(k[1]), view.row(k[2]), view.row(k[3])};
  Four numbers[ContactView::ROW] = {};
  for (int n = 0; n < ContactView::ROW; n += 4) {
    const Columns c(four(r[0] + n), four(r[1] + n), four(r[2] + n), four(r[3] + n));
    numbers[n] = c.x;
    numbers[n + 1] = c.y;
    numbers[n + 2] = c.z;
    numbers[n + 3] = c.w;
  }
  ContactStepOf<Four> s;
  static_cast<ContactShared &>(s) = law;
  std::memcpy(static_cast<ContactOwnOf<Four> *>(&s), numbers, sizeof(ContactOwnOf<Four>));
  return s;
}

// the rows of the contacts that have none yet
template <class Partners>
void solve_rows(const ContactView &view, const ContactLaw &law, double dt, const MovingBalls &balls,
                const Partners &partners)
{
  for (size_t begin = 0; begin < view.unsolved_size; begin += 4) {
    int k[4];
    Four ri = Four(), rj = Four(), mi = Four(), mj = Four();
    for (size_t m = 0; m < 4; m++) {
      k[m] = view.unsolved[std::min(begin + m, view.unsolved_size - 1)];
      const ContactEntry &e = view.entries[k[m]];
      ri[m] = balls.radius[e.i];
      rj[m] = partners.radius(e.j);
      mi[m] = balls.mass[e.i];
      mj[m] = partners.mass(e.j);
    }
    store_rows(view, k, step_of(view.moves, law, dt, false, ri, rj, mi, mj));
  }
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

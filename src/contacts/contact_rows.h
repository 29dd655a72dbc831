// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* In a list of unequal balls each contact has a ContactStep of its own. It depends on sizes and masses alone,
   and solving for it takes longer than the contact's force: it is solved once, when a list meets the contact
   touching for the first time, and kept as a row of numbers. No LAMMPS. */

#ifndef SLOPE_CONTACT_ROWS_H
#define SLOPE_CONTACT_ROWS_H

#include "contact_geometry.h"
#include "contact_kernel.h"
#include "simd4.h"

#include <algorithm>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

// what is in a row, and what all contacts of a law share: dt, grow, kn, friction, rolling, fn_least
static_assert(sizeof(ContactStep) == (ContactView::ROW + 6) * sizeof(double),
              "a number that depends on the balls must be in the rows");

// to the rows of four contacts k
SLOPE_INLINE void store_rows(const ContactView &view, const int *k, const ContactStepOf<Four> &s)
{
  const Columns a(s.cn, s.kt, s.ct, s.kr), b(s.cr, s.taken_n, s.taken_t, s.taken_r),
      c(s.per_kt, s.per_kr, s.share_i, s.share_j);
  const Four rows[4][3] = {{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}, {a.w, b.w, c.w}};
  for (int m = 0; m < 4; m++)
    for (int n = 0; n < 3; n++) four(view.row(k[m]) + 4 * n) = rows[m][n];
}

// law: what all contacts share
SLOPE_INLINE ContactStepOf<Four> load_rows(const ContactView &view, const int *k,
                                           const ContactStep &law)
{
  const double *const r[4] = {view.row(k[0]), view.row(k[1]), view.row(k[2]), view.row(k[3])};
  const Columns a(four(r[0]), four(r[1]), four(r[2]), four(r[3])),
      b(four(r[0] + 4), four(r[1] + 4), four(r[2] + 4), four(r[3] + 4)),
      c(four(r[0] + 8), four(r[1] + 8), four(r[2] + 8), four(r[3] + 8));
  return {law.dt,       law.grow,    all<Four>(law.kn),
          a.x,          a.y,         a.z,
          a.w,          b.x,         b.y,
          b.z,          b.w,         c.x,
          c.y,          c.z,         c.w,
          law.friction, law.rolling, law.fn_least};
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

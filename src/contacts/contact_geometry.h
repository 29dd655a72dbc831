// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A contact of two balls as the law sees it: geometry and velocities, masses and radii. No LAMMPS. */

#ifndef SLOPE_CONTACT_GEOMETRY_H
#define SLOPE_CONTACT_GEOMETRY_H

#include "contact_balls.h"
#include "contact_force.h"

#include <cmath>

namespace Slope {
inline namespace SLOPE_INSTRUCTIONS {

// of the centres, m
template <class Partners>
SLOPE_INLINE double distance(const MovingBalls &balls, const Partners &partners, int i, int j)
{
  const Vector &a = balls.x[i], &b = partners.x(j);
  const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

// geometry and velocities of the contact of ball i with partner j; delta: from the partner to the ball, m
template <class Partners>
SLOPE_INLINE void set_contact(const ContactLaw &law, const MovingBalls &balls,
                              const Partners &partners, int i, int j, Contact &c, Vector &delta)
{
  const double ri = balls.radius[i], rj = partners.radius(j);
  const double *xi = &balls.x[i].x, *xj = &partners.x(j).x;
  const double *vi = &balls.v[i].x, *vj = &partners.v(j).x;
  const double *wi = &balls.omega[i].x, *wj = &partners.omega(j).x;
  delta = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
  const double r = distance(balls, partners, i, j);
  c.overlap = touching(ri, rj) - r;
  const Vector &a = balls.ahead[i], &b = partners.ahead(j);
  c.ahead = ((a.x - b.x) * delta.x + (a.y - b.y) * delta.y + (a.z - b.z) * delta.z) / r;
  c.follow_whole_step();
  c.rolling_radius = law.rolling_factor * ri * rj / (ri + rj);
  for (int d = 0; d < 3; d++) {
    c.n[d] = (xi[d] - xj[d]) / r;
    c.v[d] = vi[d] - vj[d];
    c.rw[d] = ri * wi[d] + rj * wj[d];
    c.w[d] = wi[d] - wj[d];
  }
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A contact of two balls as the law sees it, and what the springs of the contacts of a list can give back: no more than
   friction lets through, and nothing where a sliding contact's spring only balances its dashpot. No LAMMPS. */

#ifndef SLOPE_CONTACT_ENERGY_H
#define SLOPE_CONTACT_ENERGY_H

#include "contact_force.h"
#include "contact_list.h"

#include <algorithm>

namespace Slope {

// geometry and velocities of the contact of ball i with partner j; delta: from the partner to the ball, m
template <class Partners>
void set_contact(const ContactLaw &law, const MovingBalls &balls, const Partners &partners, int i,
                 int j, Contact &c, Vector &delta)
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

// Twice the energy (J) that a spring of stretch s (m) can give back, its ends moving at u (m/s): at a
// force of most (N) it slides. limit: the same for spring and dashpot together, now.
inline double held(const SpringDashpot &law, double most, double limit, const double *s,
                   const double *u)
{
  constexpr double NEARLY = 0.8;    // of the square of a force: velocities may be half a step old
  if (!(law.k > 0.0)) return 0.0;
  double s2 = 0.0, f2 = 0.0, along = 0.0;
  for (int d = 0; d < 3; d++) {
    const double f = law.k * s[d] + law.c * u[d];
    s2 += s[d] * s[d];
    f2 += f * f;
    along += f * s[d];
  }
  const bool slides = f2 >= NEARLY * limit * limit;
  return slides && along < 0.0 ? 0.0 : std::min(law.k * s2, most * most / law.k);
}

// the same of all springs of a contact, J, as they act
inline double elastic_energy(const ContactStep &step, const Contact &c, const double *history)
{
  const double elastic = spring_force(step, c.overlap), vn = normal_velocity(c);
  const double pressing = elastic - step.cn * vn;
  double vt[3], w[3];
  sliding_velocity(c, vn, vt);
  flatten(c.n, c.w, w);
  for (double &x : w) x *= c.rolling_radius;
  return spring_energy(step, c.overlap) +
      0.5 *
      held({step.kt, step.ct}, step.friction * elastic, step.friction * pressing, history, vt) +
      0.5 *
      held({step.kr, step.cr}, step.rolling * elastic, step.rolling * pressing, history + 3, w);
}

// The same of a list, this rank's share, J; see(entry, overlap) is called for each contact that touched in the last step.
template <class Partners, class See>
double elastic_energy(const ContactList &list, const ContactLaw &law, double dt,
                      const MovingBalls &balls, const Partners &partners, See see)
{
  double energy = 0.0;
  ContactStep step =
      step_of(list.moves, law, dt, true, list.radius_i, list.radius_j, list.mass_i, list.mass_j);
  list.for_each_touching([&](size_t k) {
    const ContactList::Entry &e = list.entries[k];
    Contact c;
    Vector delta;
    set_contact(law, balls, partners, e.i, e.j, c, delta);
    see(e, c.overlap);
    if (!list.equal)
      step = step_of(list.moves, law, dt, true, balls.radius[e.i], partners.radius(e.j),
                     balls.mass[e.i], partners.mass(e.j));
    energy += partners.share(e.j) * elastic_energy(step, c, list.histories[k]);
  });
  return energy;
}

}    // namespace Slope

#endif

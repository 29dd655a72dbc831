// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The forces of the contacts in a step, kept until its end, and their work with the velocities of that time:
   with these it is what velocity Verlet changes the kinetic energy by. No LAMMPS. Derivation:
   doc/src/theory.rst. */

#ifndef SLOPE_CONTACT_WORKS_H
#define SLOPE_CONTACT_WORKS_H

#include "contact_law.h"
#include "vector3.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace Slope {

class ContactWorks {
 public:
  static constexpr int FIXED = -1;    // number of a partner that does not move

  struct Sum {
    double spring, dashpot, sliding;    // work on the balls, J
    double by_torque;                   // part of sliding that is the work of torques, J
    double stored;                      // in the normal springs, J
  };

  bool wanted = false;

  void clear() { forces.clear(); }

  // f: on ball i, N; delta: from the partner to the ball, m; share: of the contact that is this rank's
  void add(int i, int j, double ri, double rj, const ContactLaw &law, double share, const Vector &f,
           const Vector &delta)
  {
    const double overlap = std::max(touching(ri, rj) - std::sqrt(dot(delta, delta)), 0.0);
    add(i, j, ri, rj, law, share, f, delta, overlap, overlap);
  }

  // compression: of the spring in the energy, m, where it is not the overlap that gives the force
  void add(int i, int j, double ri, double rj, const ContactLaw &law, double share, const Vector &f,
           const Vector &delta, double overlap, double compression)
  {
    const double r = std::sqrt(dot(delta, delta));
    forces.push_back({i,
                      j,
                      ri,
                      rj,
                      share,
                      spring_force(law, overlap),
                      spring_energy(law, compression),
                      f,
                      {delta.x / r, delta.y / r, delta.z / r}});
  }

  // in a step of dt (s), with the velocities of its end
  Sum work(double dt, const Vector *v, const Vector *omega) const
  {
    Sum sum = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (const Force &c : forces) {
      const bool fixed = c.j == FIXED;
      const Vector still = {0.0, 0.0, 0.0};
      const Vector &vj = fixed ? still : v[c.j], &wj = fixed ? still : omega[c.j];
      const Vector &vi = v[c.i], &wi = omega[c.i], &n = c.n;
      const Vector u = {vi.x - vj.x, vi.y - vj.y, vi.z - vj.z};
      const Vector w = {c.ri * wi.x + c.rj * wj.x, c.ri * wi.y + c.rj * wj.y,
                        c.ri * wi.z + c.rj * wj.z};
      const double un = dot(u, n), part = dt * c.share;
      const double elastic = c.elastic, normal = dot(c.f, n);
      const double torque = -part * dot(c.f, cross(w, n));
      sum.spring += part * elastic * un;
      sum.dashpot += part * (normal - elastic) * un;
      sum.sliding += part * (dot(c.f, u) - normal * un) + torque;
      sum.by_torque += torque;
      sum.stored += c.share * c.stored;
    }
    return sum;
  }

 private:
  struct Force {
    int i, j;
    double ri, rj, share, elastic, stored;    // elastic: N, stored: J, of the normal spring
    Vector f, n;
  };
  std::vector<Force> forces;
};

}    // namespace Slope

#endif

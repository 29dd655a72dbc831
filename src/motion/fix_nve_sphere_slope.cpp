/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fix_nve_sphere_slope.h"

#include "atom.h"
#include "ball_sweep.h"

using namespace LAMMPS_NS;
using namespace Slope;

/* ----------------------------------------------------------------------
   half a step of the velocities and spins; MOVE: a step of the positions with these
------------------------------------------------------------------------- */

template <bool MOVE> void FixNVESphereSlope::integrate()
{
  const int n = igroup == atom->firstgroup ? atom->nfirst : atom->nlocal;
  if (n == 0) return;
  double *const x = atom->x[0], *const v = atom->v[0], *const omega = atom->omega[0];
  const double *const f = atom->f[0], *const torque = atom->torque[0];
  const double *const mass = atom->rmass, *const radius = atom->radius;
  const double dt = dtv, half = dtf, half_spin = dtf / inertia;

  sweep(
      n, atom->mask, groupbit,
      [=](int i) {
        const int k = 3 * i;
        const Four m = four(&mass[i]), r = four(&radius[i]);
        add_four(&v[k], OfComponents(half / m), &f[k]);
        if (MOVE) add_four(&x[k], OfComponents(all<Four>(dt)), &v[k]);
        add_four(&omega[k], OfComponents(half_spin / (r * r * m)), &torque[k]);
      },
      [=](int i) {
        const int k = 3 * i;
        add_one(&v[k], half / mass[i], &f[k]);
        if (MOVE) add_one(&x[k], dt, &v[k]);
        add_one(&omega[k], half_spin / (radius[i] * radius[i] * mass[i]), &torque[k]);
      });
}

/* ---------------------------------------------------------------------- */

void FixNVESphereSlope::initial_integrate(int vflag)
{
  if (extra)
    FixNVESphere::initial_integrate(vflag);    // dipoles
  else
    integrate<true>();
}

/* ---------------------------------------------------------------------- */

void FixNVESphereSlope::final_integrate()
{
  integrate<false>();
}

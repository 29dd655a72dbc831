/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fix_gravity_slope.h"

#include "atom.h"
#include "ball_sweep.h"

using namespace LAMMPS_NS;
using namespace Slope;

/* ---------------------------------------------------------------------- */

void FixGravitySlope::post_force(int vflag)
{
  const bool constant = varflag == 0;
  energy_due = constant && !disable && atom->rmass;
  if (!energy_due) {
    FixGravity::post_force(vflag);
    return;
  }
  const int n = atom->nlocal;
  if (n == 0) return;
  double *const f = atom->f[0];
  const double *const mass = atom->rmass;
  const double g[12] = {xacc, yacc, zacc, xacc, yacc, zacc, xacc, yacc, zacc, xacc, yacc, zacc};
  sweep(
      n, atom->mask, groupbit,
      [&](int i) {
        add_four(&f[3 * i], OfComponents(four(&mass[i])), g);
      },
      [&](int i) {
        add_one(&f[3 * i], mass[i], g);
      });
}

/* ----------------------------------------------------------------------
   potential energy, J
------------------------------------------------------------------------- */

double FixGravitySlope::compute_scalar()
{
  if (energy_due) {
    energy_due = false;
    eflag = 0;    // not yet summed over the ranks
    egrav = 0.0;
    double **const x = atom->x;
    for (int i = 0; i < atom->nlocal; i++)
      if (atom->mask[i] & groupbit)
        egrav -= atom->rmass[i] * (xacc * x[i][0] + yacc * x[i][1] + zacc * x[i][2]);
  }
  return FixGravity::compute_scalar();
}

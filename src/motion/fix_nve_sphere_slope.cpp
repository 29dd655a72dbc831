/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fix_nve_sphere_slope.h"

#include "atom.h"
#include "ball_sweep.h"
#include "contact_step.h"
#include "continuation.h"
#include "lammps_compat.h"
#include "pair_gran_restitution.h"

using namespace LAMMPS_NS;
using namespace Slope;

/* ----------------------------------------------------------------------
   half a step of the velocities and spins; MOVE: a step of the positions with these; LOOK: velocities that normal dashpots
   act on, for which Continuation would have to go through all balls once more
------------------------------------------------------------------------- */

template <bool MOVE, bool LOOK> void FixNVESphereSlope::integrate()
{
  const int n = igroup == atom->firstgroup ? atom->nfirst : atom->nlocal;
  if (n == 0) return;
  double *const x = atom->x[0], *const v = atom->v[0], *const omega = atom->omega[0];
  const double *const f = atom->f[0], *const torque = atom->torque[0];
  const double *const mass = atom->rmass, *const radius = atom->radius;
  double *const ahead = LOOK ? &contacts->to_look_ahead()->x : nullptr;
  const double part = AHEAD * dtv;
  int looked = 0;
  const double dt = dtv, half = dtf, half_spin = dtf / inertia;

  sweep(
      n, atom->mask, groupbit,
      [&](int i) {
        const int k = 3 * i;
        const Four m = four(&mass[i]), r = four(&radius[i]);
        add_four(&v[k], OfComponents(half / m), &f[k]);
        if (MOVE) add_four(&x[k], OfComponents(all<Four>(dt)), &v[k]);
        if (LOOK) sum_four(&ahead[k], &v[k], OfComponents(part / m), &f[k]);
        looked += 4;
        add_four(&omega[k], OfComponents(half_spin / (r * r * m)), &torque[k]);
      },
      [&](int i) {
        const int k = 3 * i;
        add_one(&v[k], half / mass[i], &f[k]);
        if (MOVE) add_one(&x[k], dt, &v[k]);
        for (int d = 0; d < 3 && LOOK; d++) ahead[k + d] = v[k + d] + part / mass[i] * f[k + d];
        looked++;
        add_one(&omega[k], half_spin / (radius[i] * radius[i] * mass[i]), &torque[k]);
      });
  if (LOOK && looked == atom->nlocal) contacts->note_looked();
}

// Only where no other fix can change velocities or forces until Continuation would look

void FixNVESphereSlope::init()
{
  FixNVESphere::init();
  PairGranRestitution *const pair = PairGranRestitution::of(lmp);
  contacts = pair ? pair->continuation() : nullptr;
  bool before = true;
  for (const Fix *fix : compat::fixes(lmp)) {
    const int mask = compat::mask_of(lmp, fix);
    const bool history = is_style(fix->style, "CONTACT_HISTORY");
    if (fix == this)
      before = false;
    else if ((mask & FixConst::INITIAL_INTEGRATE && !before) ||
             (mask & FixConst::POST_INTEGRATE && !history))
      contacts = nullptr;
  }
}

/* ---------------------------------------------------------------------- */

void FixNVESphereSlope::initial_integrate(int vflag)
{
  if (extra)
    FixNVESphere::initial_integrate(vflag);    // dipoles
  else
    contacts ? integrate<true, true>() : integrate<true, false>();
}

/* ---------------------------------------------------------------------- */

void FixNVESphereSlope::final_integrate()
{
  integrate<false, false>();
}

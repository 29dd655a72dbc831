/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "energy_guard.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "lammps_compat.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

EnergyGuard::EnergyGuard(LAMMPS *lmp) :
    Pointers(lmp), known(false), begun(false), lowest(0.0), motion(0.0), grown(0.0), count(0),
    number(0), pull{0.0, 0.0, 0.0}
{
}

/* ---------------------------------------------------------------------- */

void EnergyGuard::start()
{
  begun = false;
  motion = grown = 0.0;
  count = 0;

  known = contacts_alone();
  for (int k = 0; k < modify->nfix && known; k++)
    known = does_no_work(Slope::plain_style(modify->fix[k]->style), modify->fmask[k]);
}

// other pair styles, bonds and the like have energies of their own

bool EnergyGuard::contacts_alone() const
{
  if (force->bond || force->angle || force->dihedral || force->improper || force->kspace)
    return false;
  for (const std::string &style : compat::parts_of_hybrid(force->pair))
    if (!Slope::is_style(style, "gran/restitution") && !Slope::is_style(style, "zero"))
      return false;
  return true;
}

/* ----------------------------------------------------------------------
   A fix that moves balls, adds forces or changes velocities does work that is its own business. It acts
   before, between or after the halves of a step, or has one of the names of those that act at its end.
   fix ground/motion is counted: see check().
------------------------------------------------------------------------- */

bool EnergyGuard::does_no_work(const std::string &style, int mask)
{
  for (const char *name :
       {"nve/sphere", "gravity", "freeze", "wall/gran/balls", "wall/gran/mesh", "ground/motion",
        "control/line", "store/force", "CONTACT_HISTORY", "GROUP"})
    if (style == name) return true;
  for (const char *name : {"^adapt", "^deform", "^heat", "^momentum", "^nphug", "^press/",
                           "^python", "^set$", "^temp/"})
    if (utils::strmatch(style, name)) return false;
  return !(mask & (INITIAL_INTEGRATE | POST_INTEGRATE | PRE_FORCE | POST_FORCE | FINAL_INTEGRATE));
}

/* ----------------------------------------------------------------------
   a ball whose place or velocity is no number ends the run: nothing touches it any more
------------------------------------------------------------------------- */

void EnergyGuard::check_finite() const
{
  for (int i = 0; i < atom->nlocal; i++) {
    const double *x = atom->x[i], *v = atom->v[i], *f = atom->f[i];
    double sum = 0.0;
    for (int d = 0; d < 3; d++) sum += x[d] + v[d] + f[d] + atom->omega[i][d] + atom->torque[i][d];
    if (!std::isfinite(sum))
      error->one(
          FLERR,
          "Pair gran/restitution: ball {} has a position, velocity or force that is not finite at "
          "step {}: x {:.6g} {:.6g} {:.6g}, v {:.6g} {:.6g} {:.6g}, f {:.6g} {:.6g} {:.6g}",
          atom->tag[i], update->ntimestep, x[0], x[1], x[2], v[0], v[1], v[2], f[0], f[1], f[2]);
  }
}

/* ---------------------------------------------------------------------- */

bool EnergyGuard::check(double elastic)
{
  check_finite();

  double moving = elastic, height = 0.0, gravity[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < atom->nlocal; i++) {
    const double *v = atom->v[i], *w = atom->omega[i], r = atom->radius[i];
    moving += 0.5 * atom->rmass[i] *
        (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] +
         0.4 * r * r * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
  }
  for (Fix *fix : compat::fixes_of_style(lmp, "gravity")) {
    int dim;
    const double *g = static_cast<double *>(fix->extract("gvec", dim));
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & fix->groupbit)) continue;
      double x[3];
      domain->unmap(atom->x[i], atom->image[i], x);
      height -= atom->rmass[i] * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
    }
    for (int d = 0; d < 3; d++) gravity[d] += g[d];
  }

  // what the motion of the ground has put in is counted, and taken out again

  double given = 0.0;
  for (Fix *fix : compat::fixes_of_style(lmp, "ground/motion")) {
    int dim;
    given += *static_cast<double *>(fix->extract("work", dim));
  }
  double mine[3] = {moving, height, given};
  double all[3];
  MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, world);
  const double energy = all[0] + all[1] - all[2];

  // balls that came or went and gravity that turns change the energy: start again

  if (!begun || number != atom->natoms || !std::equal(gravity, gravity + 3, pull)) lowest = energy;
  begun = true;
  number = atom->natoms;
  std::copy(gravity, gravity + 3, pull);
  lowest = std::min(lowest, energy);
  motion = std::max(motion, all[0]);

  // rounding of large heights and of much work is no growth

  const double growth = energy - lowest;
  if (!known || growth <= 1.0e-9 * (std::fabs(all[1]) + std::fabs(all[2]))) return false;
  grown = std::max(grown, growth / motion);
  return growth > GROWTH * motion && count++ == 0;
}

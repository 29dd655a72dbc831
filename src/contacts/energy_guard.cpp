/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "energy_guard.h"

#include "atom.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "lammps_compat.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

EnergyGuard::EnergyGuard(LAMMPS *lmp) :
    Pointers(lmp), known(false), begun(false), gravity(lmp), lowest(0.0), motion(0.0), grown(0.0),
    count(0), came(0.0), all_came(0.0), new_balls(false)
{
}

/* ---------------------------------------------------------------------- */

void EnergyGuard::start()
{
  begun = false;
  motion = grown = 0.0;
  count = 0;

  known = unknown_work().empty();
  if (known) gravity.start();
}

std::string EnergyGuard::unknown_work() const
{
  const std::string other = other_forces();
  if (!other.empty()) return other;
  for (const Fix *fix : compat::fixes(lmp))
    if (!does_no_work(Slope::plain_style(fix->style), compat::mask_of(lmp, fix)))
      return fmt::format("fix {} {}", fix->id, fix->style);
  return "";
}

// other pair styles, bonds and the like have energies of their own

std::string EnergyGuard::other_forces() const
{
  if (force->bond || force->angle || force->dihedral || force->improper) return "bonds";
  if (force->kspace) return "a kspace style";
  for (const std::string &style : compat::parts_of_hybrid(lmp))
    if (!Slope::is_style(style, "gran/restitution") && !Slope::is_style(style, "zero"))
      return "pair style " + style;
  return "";
}

/* ----------------------------------------------------------------------
   A fix that moves balls, adds forces or changes velocities does work that is its own business. It acts
   before, between or after the halves of a step, or has one of the names of those that act at its end.
   fix ground/motion is counted: see check().
------------------------------------------------------------------------- */

bool EnergyGuard::does_no_work(const std::string &style, int mask)
{
  for (const char *name :
       {"nve/sphere", "gravity", "freeze", "enforce2d", "wall/gran/balls", "wall/gran/mesh",
        "ground/motion", "control/line", "store/force", "CONTACT_HISTORY", "GROUP"})
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

  double moving = elastic;
  for (int i = 0; i < atom->nlocal; i++) {
    const double *v = atom->v[i], *w = atom->omega[i], r = atom->radius[i];
    moving += 0.5 * atom->rmass[i] *
        (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] +
         0.4 * r * r * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
  }
  end_list();
  double mine[3] = {moving, gravity.done() + shaking_work(lmp), came};
  double all[3];
  MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, world);
  const double energy = all[0] - all[1];

  // balls that came bring energy: start again; those that went only took some

  new_balls = begun && all[2] != all_came;
  if (!begun || new_balls) lowest = energy;
  begun = true;
  all_came = all[2];
  lowest = std::min(lowest, energy);
  motion = std::max(motion, all[0]);

  // rounding of much work is no growth

  const double growth = energy - lowest;
  if (!known || growth <= 1.0e-9 * std::fabs(all[1])) return false;
  grown = std::max(grown, growth / motion);
  return growth > GROWTH * motion && count++ == 0;
}

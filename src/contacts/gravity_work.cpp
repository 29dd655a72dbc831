/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "gravity_work.h"

#include "atom.h"
#include "fix.h"
#include "group.h"
#include "lammps_compat.h"
#include "update.h"

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

const double *LAMMPS_NS::acceleration_of(Fix *gravity)
{
  int dim;
  return static_cast<double *>(gravity->extract("gvec", dim));
}

double LAMMPS_NS::shaking_work(LAMMPS *lmp)
{
  double work = 0.0;
  for (Fix *fix : compat::fixes_of_style(lmp, "ground/motion")) {
    int dim;
    work += *static_cast<double *>(fix->extract("work", dim));
  }
  return work;
}

/* ---------------------------------------------------------------------- */

void GravityWork::start()
{
  sum = 0.0;
  by_step = false;
  for (Fix *fix : compat::fixes_of_style(lmp, "gravity"))
    if (group->dynamic[fix->igroup] || compat::gravity_varies(fix)) by_step = true;
  begin_list();
}

/* ---------------------------------------------------------------------- */

double GravityWork::weighed(double **vectors) const
{
  double found = 0.0;
  for (Fix *fix : compat::fixes_of_style(lmp, "gravity")) {
    const double *g = acceleration_of(fix);
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & fix->groupbit)) continue;
      const double *a = vectors[i];
      found += atom->rmass[i] * (g[0] * a[0] + g[1] * a[1] + g[2] * a[2]);
    }
  }
  return found;
}

/* ---------------------------------------------------------------------- */

void GravityWork::begin_list()
{
  if (!by_step) at_begin = weighed(atom->x);
}

void GravityWork::count_way()
{
  if (by_step) return;
  const double now = weighed(atom->x);
  sum += now - at_begin;
  at_begin = now;
}

void GravityWork::count_step()
{
  if (by_step) sum += update->dt * weighed(atom->v);
}

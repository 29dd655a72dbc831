/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "empty_group.h"

#include "inserted_balls.h"
#include "lammps_compat.h"

#include "atom.h"
#include "fix.h"

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

bigint LAMMPS_NS::balls_beside_empty(LAMMPS *lmp, int groupbit,
                                     const std::function<bool(int)> &meant)
{
  int frozen = 0;
  for (const Fix *fix : compat::fixes_of_style(lmp, "freeze")) frozen |= fix->groupbit;
  const Atom *atom = lmp->atom;
  bigint mine[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    if (atom->mask[i] & groupbit) mine[0]++;
    if (!(atom->mask[i] & frozen) && meant(i)) mine[1]++;
  }
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
  if (all[0]) return 0;
  for (const InsertedBalls &balls : inserted_balls(lmp))
    if (balls.mask & groupbit) return 0;
  return all[1];
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_EXCHANGE_SIZE_H
#define SLOPE_EXCHANGE_SIZE_H

#include "lammps_compat.h"

namespace LAMMPS_NS {

// Collective: maxexchange of a fix whose atoms have at most mine numbers on this rank. LAMMPS makes room for one more
// atom in a message by what the fixes say beforehand. That must be the largest of all ranks, as an atom that crosses two
// borders is sent on at once by a rank that had none of its size; and Irregular (balance) takes the largest of the fixes,
// where an atom brings the numbers of all, so that each asks for as many times its own.
inline int exchange_size(LAMMPS *lmp, int mine)
{
  int most, fixes = 0;
  MPI_Allreduce(&mine, &most, 1, MPI_INT, MPI_MAX, lmp->world);
  for (const Fix *fix : compat::fixes(lmp)) fixes += fix->maxexchange_dynamic;
  return fixes * most;
}

}    // namespace LAMMPS_NS

#endif

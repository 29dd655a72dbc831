/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "node_memory.h"

#include "free_memory.h"

#include "comm.h"
#include "error.h"

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

MPI_Comm LAMMPS_NS::ranks_of_node(LAMMPS *lmp)
{
  MPI_Comm node;
#if defined(MPI_VERSION) && MPI_VERSION >= 3
  MPI_Comm_split_type(lmp->world, MPI_COMM_TYPE_SHARED, lmp->comm->me, MPI_INFO_NULL, &node);
#else
  MPI_Comm_split(lmp->world, lmp->comm->me, lmp->comm->me, &node);
#endif
  return node;
}

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::check_node_memory(LAMMPS *lmp, double bytes, const std::string &what,
                                  const std::string &remedy)
{
  MPI_Comm node = ranks_of_node(lmp);
  double found[3] = {0.0, Slope::free_memory(), 0.0};    // needed, left, ranks
  int ranks;
  MPI_Comm_size(node, &ranks);
  MPI_Allreduce(&bytes, &found[0], 1, MPI_DOUBLE, MPI_SUM, node);
  MPI_Bcast(&found[1], 1, MPI_DOUBLE, 0, node);    // the same for all of them
  MPI_Comm_free(&node);
  found[2] = ranks;

  struct {
    double spare;
    int rank;
  } mine = {found[1] - found[0], lmp->comm->me}, worst;
  MPI_Allreduce(&mine, &worst, 1, MPI_DOUBLE_INT, MPI_MINLOC, lmp->world);
  if (worst.spare >= 0.0) return;
  MPI_Bcast(found, 3, MPI_DOUBLE, worst.rank, lmp->world);
  lmp->error->all(FLERR,
                  "{} need {:.3g} GB of memory on a node ({:.0f} rank{}), which has {:.3g} GB "
                  "left: {}",
                  what, 1.0e-9 * found[0], found[2], found[2] > 1.0 ? "s" : "", 1.0e-9 * found[1],
                  remedy);
}

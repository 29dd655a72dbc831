/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "kernel_choice.h"

#include "comm.h"
#include "contact_kernel.h"
#include "error.h"

#include <cstdlib>
#include <stdexcept>
#include <string>

using namespace LAMMPS_NS;

void LAMMPS_NS::choose_contact_kernel(LAMMPS *lmp)
{
  std::string problem;
  int mine = -1, all;
  try {
    mine = Slope::ContactKernels::choose(std::getenv(Slope::ContactKernels::ENVIRONMENT));
  } catch (const std::invalid_argument &e) {
    problem = e.what();
  }
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MIN, lmp->world);
  if (all >= 0) {
    Slope::ContactKernels::set_current(all);
    return;
  }

  // the message of the first rank that has one, on all of them

  int rank = mine < 0 ? lmp->comm->me : lmp->comm->nprocs, first;
  MPI_Allreduce(&rank, &first, 1, MPI_INT, MPI_MIN, lmp->world);
  int length = static_cast<int>(problem.size());
  MPI_Bcast(&length, 1, MPI_INT, first, lmp->world);
  problem.resize(length);
  MPI_Bcast(&problem[0], length, MPI_CHAR, first, lmp->world);
  lmp->error->all(FLERR, "Pair gran/restitution: {}", problem);
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_RANK_ZERO_H
#define SLOPE_RANK_ZERO_H

#include "comm.h"
#include "error.h"
#include "pointers.h"

#include <exception>
#include <new>
#include <string>

namespace LAMMPS_NS {

// Collective: rank 0 does something that may throw, such as reading a file; what went wrong
// there ends the run on all ranks, with one line that starts with caller. Nobody hangs.
template <typename Work> void on_rank_zero(LAMMPS *lmp, const std::string &caller, Work work)
{
  std::string problem;
  if (lmp->comm->me == 0) {
    try {
      work();
    } catch (std::bad_alloc &) {
      problem = "not enough memory";
    } catch (std::exception &e) {
      problem = e.what();
    }
  }
  int length = problem.size();
  MPI_Bcast(&length, 1, MPI_INT, 0, lmp->world);
  if (length == 0) return;
  problem.resize(length);
  MPI_Bcast(&problem[0], length, MPI_CHAR, 0, lmp->world);
  lmp->error->all(FLERR, "{}: {}", caller, problem);
}

// Collective: all ranks do something that may throw on any of them; what went wrong first ends the
// run on all ranks in the same way.
template <typename Work> void on_all_ranks(LAMMPS *lmp, const std::string &caller, Work work)
{
  std::string problem;
  try {
    work();
  } catch (std::bad_alloc &) {
    problem = "not enough memory";
  } catch (std::exception &e) {
    problem = e.what();
  }
  const int me = lmp->comm->me, nprocs = lmp->comm->nprocs;
  int mine = problem.empty() ? nprocs : me, first;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, lmp->world);
  if (first == nprocs) return;
  int length = problem.size();
  MPI_Bcast(&length, 1, MPI_INT, first, lmp->world);
  problem.resize(length);
  MPI_Bcast(&problem[0], length, MPI_CHAR, first, lmp->world);
  lmp->error->all(FLERR, "{}: {}", caller, problem);
}

}    // namespace LAMMPS_NS

#endif

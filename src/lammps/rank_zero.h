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

// Collective: the problem of the first rank that has one (not empty) ends the run on all ranks, with one
// line that starts with caller. Nobody hangs.
inline void end_if_any(LAMMPS *lmp, const std::string &caller, std::string problem)
{
  int mine = problem.empty() ? lmp->comm->nprocs : lmp->comm->me, first;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, lmp->world);
  if (first == lmp->comm->nprocs) return;
  int length = problem.size();
  MPI_Bcast(&length, 1, MPI_INT, first, lmp->world);
  problem.resize(length);
  MPI_Bcast(&problem[0], length, MPI_CHAR, first, lmp->world);
  lmp->error->all(FLERR, "{}: {}", caller, problem);
}

// Collective: all ranks do something that may throw on any of them, which ends the run in this way.
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
  end_if_any(lmp, caller, problem);
}

// The same of rank 0 alone: reading a file, writing one.
template <typename Work> void on_rank_zero(LAMMPS *lmp, const std::string &caller, Work work)
{
  on_all_ranks(lmp, caller, [&]() {
    if (lmp->comm->me == 0) work();
  });
}

}    // namespace LAMMPS_NS

#endif

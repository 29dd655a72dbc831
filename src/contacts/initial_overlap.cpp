/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "initial_overlap.h"

#include "error.h"
#include "large_messages.h"

#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void InitialOverlap::record(double overlap, double radius, tagint ball, const double *where,
                            const std::string &partner)
{
  const double ratio = overlap / radius;
  if (ratio <= LIMIT) return;
  count++;
  if (ratio <= worst) return;
  worst = ratio;
  text = fmt::format("ball {} and {} at {:.6g} {:.6g} {:.6g}", ball, partner, where[0], where[1],
                     where[2]);
}

/* ---------------------------------------------------------------------- */

void InitialOverlap::check(const std::string &caller, const std::string &remedy)
{
  bigint total;
  MPI_Allreduce(&count, &total, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (total == 0) return;

  char buffer[256] = "";
  strncpy(buffer, text.c_str(), sizeof(buffer) - 1);
  const double most = with_largest(world, worst, buffer);

  error->all(FLERR,
             "{}: {} pairs overlap at the start by more than {:g} % of the radius, worst {:.4g} % "
             "between {} ({})",
             caller, total, 100.0 * LIMIT, 100.0 * most, buffer, remedy);
}

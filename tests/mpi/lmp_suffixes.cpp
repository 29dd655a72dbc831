// lmp with accelerated variants of fixes as -sf kk or -sf omp would choose them, made of the plain ones:
// so that every build can test that our styles know them, without the KOKKOS and OPENMP packages.

#include "fix_freeze.h"
#include "fix_gravity.h"
#include "fix_nve_sphere.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"

#include <mpi.h>

using namespace LAMMPS_NS;

template <typename Style> static Fix *make(LAMMPS *lmp, int narg, char **arg)
{
  return new Style(lmp, narg, arg);
}

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  auto *lammps = new LAMMPS(argc, argv, MPI_COMM_WORLD);
  for (const std::string suffix : {"/kk", "/kk/device", "/kk/host", "/omp", "/gpu", "/intel", "/opt"}) {
    (*lammps->modify->fix_map)["freeze" + suffix] = &make<FixFreeze>;
    (*lammps->modify->fix_map)["gravity" + suffix] = &make<FixGravity>;
    (*lammps->modify->fix_map)["nve/sphere" + suffix] = &make<FixNVESphere>;
  }
  lammps->input->file();
  delete lammps;
  MPI_Finalize();
  return 0;
}

// The tests of what needs LAMMPS, on all ranks; one that fails on any rank is a failure

#include <gtest/gtest.h>

#include <mpi.h>

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  ::testing::InitGoogleTest(&argc, argv);
  int mine = RUN_ALL_TESTS(), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return any;
}

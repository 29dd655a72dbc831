/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_GATHER_RECORDS_H
#define SLOPE_GATHER_RECORDS_H

#include "lmptype.h"

#include <algorithm>
#include <mpi.h>
#include <vector>

namespace LAMMPS_NS {

static constexpr bigint RECORD_BYTES = 1 << 26;    // of one message

// Collective: the records of all ranks, in the order of the ranks, on rank 0; nothing on the others.
// One rank after the other in messages of limited size: MPI counts in int, and so do the displacements
// of MPI_Gatherv, which more than 2^31 numbers of all ranks together would overflow.
template <typename Record>
std::vector<Record> gather_records(MPI_Comm world, const std::vector<Record> &mine,
                                   bigint bytes = RECORD_BYTES)
{
  int me, nprocs;
  MPI_Comm_rank(world, &me);
  MPI_Comm_size(world, &nprocs);
  const bigint most = std::max(bytes / static_cast<bigint>(sizeof(Record)), static_cast<bigint>(1));

  bigint number = mine.size();
  std::vector<bigint> numbers(me == 0 ? nprocs : 0);
  MPI_Gather(&number, 1, MPI_LMP_BIGINT, numbers.data(), 1, MPI_LMP_BIGINT, 0, world);

  for (bigint sent = 0; me != 0 && sent < number; sent += most)
    MPI_Send(mine.data() + sent, static_cast<int>(std::min(most, number - sent) * sizeof(Record)),
             MPI_BYTE, 0, 0, world);
  if (me != 0) return {};

  std::vector<Record> all(mine);
  for (int rank = 1; rank < nprocs; rank++) {
    bigint place = all.size();
    all.resize(place + numbers[rank]);
    for (bigint left = numbers[rank]; left > 0; left -= most) {
      const bigint part = std::min(most, left);
      MPI_Recv(all.data() + place, static_cast<int>(part * sizeof(Record)), MPI_BYTE, rank, 0,
               world, MPI_STATUS_IGNORE);
      place += part;
    }
  }
  return all;
}

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Messages of any size: MPI counts in int, and so do the displacements of MPI_Gatherv, which more than 2^31
   numbers of all ranks together would overflow. most: bytes of one message. */

#ifndef SLOPE_LARGE_MESSAGES_H
#define SLOPE_LARGE_MESSAGES_H

#include "lmptype.h"

#include <algorithm>
#include <mpi.h>
#include <vector>

namespace LAMMPS_NS {

static constexpr bigint MESSAGE_BYTES = 1 << 26;

// send(part, its bytes) for each message of some bytes
template <typename Send> void in_messages(void *data, bigint bytes, bigint most, Send send)
{
  for (bigint done = 0; done < bytes; done += most)
    send(static_cast<char *>(data) + done, static_cast<int>(std::min(most, bytes - done)));
}

inline void send_bytes(MPI_Comm world, const void *data, bigint bytes, int to,
                       bigint most = MESSAGE_BYTES)
{
  in_messages(const_cast<void *>(data), bytes, most, [&](char *part, int n) {
    MPI_Send(part, n, MPI_BYTE, to, 0, world);
  });
}

inline void receive_bytes(MPI_Comm world, void *data, bigint bytes, int from,
                          bigint most = MESSAGE_BYTES)
{
  in_messages(data, bytes, most, [&](char *part, int n) {
    MPI_Recv(part, n, MPI_BYTE, from, 0, world, MPI_STATUS_IGNORE);
  });
}

inline void broadcast_bytes(MPI_Comm world, void *data, bigint bytes, int from)
{
  in_messages(data, bytes, MESSAGE_BYTES, [&](char *part, int n) {
    MPI_Bcast(part, n, MPI_BYTE, from, world);
  });
}

// Collective: the records of one rank, on all of them
template <typename Record>
void broadcast(MPI_Comm world, std::vector<Record> &records, int from = 0)
{
  bigint number = records.size();
  MPI_Bcast(&number, 1, MPI_LMP_BIGINT, from, world);
  records.resize(number);
  broadcast_bytes(world, records.data(), number * sizeof(Record), from);
}

// Collective: take(record) on rank 0 for the records of all ranks, in the order of the ranks; nothing on the
// others. Rank 0 holds those of one message at a time, beside its own.
template <typename Record, typename Take>
void take_records(MPI_Comm world, const std::vector<Record> &mine, Take take,
                  bigint most = MESSAGE_BYTES)
{
  int me, nprocs;
  MPI_Comm_rank(world, &me);
  MPI_Comm_size(world, &nprocs);
  bigint number = mine.size();
  std::vector<bigint> numbers(me == 0 ? nprocs : 0);
  MPI_Gather(&number, 1, MPI_LMP_BIGINT, numbers.data(), 1, MPI_LMP_BIGINT, 0, world);
  const bigint whole = std::max<bigint>(1, most / sizeof(Record)) * sizeof(Record);
  if (me != 0) {
    send_bytes(world, mine.data(), number * sizeof(Record), 0, whole);
    return;
  }
  for (const Record &record : mine) take(record);
  std::vector<Record> some;
  for (int rank = 1; rank < nprocs; rank++)
    for (bigint left = numbers[rank] * sizeof(Record); left > 0; left -= whole) {
      const bigint bytes = std::min(left, whole);
      some.resize(bytes / sizeof(Record));
      receive_bytes(world, some.data(), bytes, rank, whole);
      for (const Record &record : some) take(record);
    }
}

// Collective: the records of all ranks, in the order of the ranks, on rank 0; nothing on the others.
template <typename Record>
std::vector<Record> gather_records(MPI_Comm world, const std::vector<Record> &mine,
                                   bigint most = MESSAGE_BYTES)
{
  bigint number = mine.size(), total = 0;
  MPI_Reduce(&number, &total, 1, MPI_LMP_BIGINT, MPI_SUM, 0, world);
  std::vector<Record> all;
  all.reserve(total);
  take_records(
      world, mine,
      [&](const Record &record) {
        all.push_back(record);
      },
      most);
  return all;
}

// Collective: the record of the rank whose value is largest, of several the first one, on all of them;
// returns that value
template <typename Record> double with_largest(MPI_Comm world, double value, Record &record)
{
  struct {
    double value;
    int rank;
  } mine, most;
  mine.value = value;
  MPI_Comm_rank(world, &mine.rank);
  MPI_Allreduce(&mine, &most, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  MPI_Bcast(&record, sizeof(Record), MPI_BYTE, most.rank, world);
  return most.value;
}

// Collective: each value becomes the sum of all ranks'.
inline void add_up(MPI_Comm world, std::vector<double> &values)
{
  std::vector<double> mine = values;
  MPI_Allreduce(mine.data(), values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM,
                world);
}

}    // namespace LAMMPS_NS

#endif

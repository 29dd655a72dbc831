// gather_records() on several ranks: all records in the order of the ranks, whatever the size of a message;
// broadcast() and with_largest(): those of one rank on all. Ends with status 1 and a line if not.

#include "large_messages.h"

#include <cstdio>

using namespace LAMMPS_NS;

struct Record {
  double rank, number, more[3];
};

// rank r has counts[r] records; bytes: of a message
static bool is_right(int me, const std::vector<int> &counts, bigint bytes)
{
  std::vector<Record> mine;
  for (int k = 0; k < counts[me]; k++)
    mine.push_back({static_cast<double>(me), static_cast<double>(k), {0.5, -1.0, 1.0e300}});
  const std::vector<Record> all = gather_records(MPI_COMM_WORLD, mine, bytes);
  if (me != 0) return all.empty();

  size_t at = 0;
  for (size_t rank = 0; rank < counts.size(); rank++)
    for (int k = 0; k < counts[rank]; k++, at++)
      if (at >= all.size() || all[at].rank != rank || all[at].number != k || all[at].more[2] != 1.0e300)
        return false;
  return at == all.size();
}

int main(int argc, char **argv)
{
  MPI_Init(&argc, &argv);
  int me, nprocs, failed = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);
  MPI_Comm_size(MPI_COMM_WORLD, &nprocs);

  // messages of one record (also where it is larger than a message), of a few, of all; ranks without any
  const std::vector<std::vector<int>> cases = {{0, 0, 0}, {0, 7, 0}, {5, 0, 12}, {1, 1000, 999}};
  for (const std::vector<int> &some : cases)
    for (const bigint bytes : {bigint(1), bigint(3 * sizeof(Record) + 1), MESSAGE_BYTES}) {
      std::vector<int> counts(nprocs, 4);
      for (int rank = 0; rank < nprocs && rank < 3; rank++) counts[rank] = some[rank];
      if (is_right(me, counts, bytes)) continue;
      printf("rank %d: wrong with messages of %ld bytes\n", me, static_cast<long>(bytes));
      failed = 1;
    }
  std::vector<Record> last(me == nprocs - 1 ? 7 : 2, Record{1.0 * me, 0.0, {0.5, -1.0, 1.0e300}});
  broadcast(MPI_COMM_WORLD, last, nprocs - 1);
  Record most = {1.0 * me, 0.0, {0.5, -1.0, 1.0e300}};
  const double value = with_largest(MPI_COMM_WORLD, me == 0 ? -1.0 : 2.0, most);    // rank 1 is the first of equals
  if (last.size() != 7 || last[6].rank != nprocs - 1 || value != (nprocs > 1 ? 2.0 : -1.0) ||
      most.rank != (nprocs > 1 ? 1 : 0)) {
    printf("rank %d: wrong shared records\n", me);
    failed = 1;
  }
  int any;
  MPI_Allreduce(&failed, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return any;
}

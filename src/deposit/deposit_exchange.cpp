/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_exchange.h"

#include "large_messages.h"

#include "comm.h"

#include <algorithm>
#include <cstdlib>
#include <map>

using namespace LAMMPS_NS;
using Slope::DepositBands;
using Slope::DepositBlocks;

static constexpr size_t ROUND = 2048;          // blocks that a rank sends in a round: 3 MB of bins
static constexpr int BATCH = 64;               // bands whose bytes rank 0 has at a time, if there
static constexpr int BATCH_CELLS = 4000000;    // are no more ranks, and not more cells in them
static constexpr int HEAD = 2;    // column, band: what stands before the values of a block

/* ---------------------------------------------------------------------- */

void DepositExchange::to_owners(const DepositBlocks &blocks, const DepositBands &bands,
                                const TakeBlock &take)
{
  if (comm->nprocs == 1) {
    for (size_t k = 0; k < blocks.size(); k++) take(blocks.column(k), blocks.band(k), blocks[k]);
    return;
  }
  bigint mine = (blocks.size() + ROUND - 1) / ROUND, rounds;
  MPI_Allreduce(&mine, &rounds, 1, MPI_LMP_BIGINT, MPI_MAX, world);
  for (bigint round = 0; round < rounds; round++) {
    const size_t begin = std::min(blocks.size(), (size_t) round * ROUND);
    one_round(blocks, begin, std::min(blocks.size(), begin + ROUND), bands, take);
  }
}

/* ----------------------------------------------------------------------
   only ranks that have something for each other send messages
------------------------------------------------------------------------- */

void DepositExchange::one_round(const DepositBlocks &blocks, size_t begin, size_t end,
                                const DepositBands &bands, const TakeBlock &take)
{
  const size_t values = blocks.values_per_block(), width = HEAD + values;
  std::vector<int> to(comm->nprocs, 0), from(comm->nprocs);
  for (size_t k = begin; k < end; k++) to[bands.owner(blocks.band(k))]++;
  MPI_Alltoall(to.data(), 1, MPI_INT, from.data(), 1, MPI_INT, world);

  std::vector<size_t> next(comm->nprocs, 0);    // place of the next block for a rank
  size_t coming = 0;
  for (int rank = 1; rank < comm->nprocs; rank++) next[rank] = next[rank - 1] + to[rank - 1];
  for (const int count : from) coming += count;
  std::vector<double> outbox((end - begin) * width), inbox(coming * width);
  for (size_t k = begin; k < end; k++) {
    double *record = &outbox[next[bands.owner(blocks.band(k))]++ * width];
    record[0] = blocks.column(k);
    record[1] = blocks.band(k);
    std::copy_n(blocks[k], values, record + HEAD);
  }

  // at most ROUND blocks, so that counts fit into an int

  std::vector<MPI_Request> arriving(comm->nprocs), leaving;
  double *place = inbox.data();
  for (int rank = 0; rank < comm->nprocs; rank++) {
    const size_t size = from[rank] * width;
    if (size > 0 && rank != comm->me)
      MPI_Irecv(place, (int) size, MPI_DOUBLE, rank, 0, world, &arriving[rank]);
    place += size;
  }
  for (int rank = 0; rank < comm->nprocs; rank++) {
    if (to[rank] == 0) continue;
    double *first = &outbox[(next[rank] - to[rank]) * width];
    const size_t size = to[rank] * width;
    if (rank == comm->me) {
      size_t before = 0;
      for (int other = 0; other < rank; other++) before += from[other];
      std::copy_n(first, size, &inbox[before * width]);
    } else {
      leaving.emplace_back();
      MPI_Isend(first, (int) size, MPI_DOUBLE, rank, 0, world, &leaving.back());
    }
  }

  place = inbox.data();
  for (int rank = 0; rank < comm->nprocs; rank++) {
    if (from[rank] > 0 && rank != comm->me) MPI_Wait(&arriving[rank], MPI_STATUS_IGNORE);
    for (int k = 0; k < from[rank]; k++, place += width)
      take((int) place[0], (int) place[1], place + HEAD);
  }
  for (MPI_Request &request : leaving) MPI_Wait(&request, MPI_STATUS_IGNORE);
}

/* ----------------------------------------------------------------------
   batch by batch of bands, in which every rank has work before it waits for another one
------------------------------------------------------------------------- */

void DepositExchange::to_rank_zero(const DepositBands &bands, int from, int to,
                                   const MakeBytes &make, const TakeBytes &take)
{
  const int step = from <= to ? 1 : -1, count = std::abs(to - from) + 1;
  const int batch = std::max(comm->nprocs, std::min(BATCH, BATCH_CELLS / bands.cells_in_band()));
  for (int done = 0; done < count; done += batch) {
    std::vector<int> now;
    for (int k = done; k < std::min(count, done + batch); k++) now.push_back(from + step * k);
    batch_to_rank_zero(bands, now, make, take);
  }
}

/* ---------------------------------------------------------------------- */

void DepositExchange::batch_to_rank_zero(const DepositBands &bands, const std::vector<int> &now,
                                         const MakeBytes &make, const TakeBytes &take)
{
  std::string mine;
  std::vector<bigint> sizes(now.size(), 0);    // of the bands of this rank
  for (size_t k = 0; k < now.size(); k++) {
    if (!bands.mine(now[k])) continue;
    const std::string bytes = make(now[k]);
    sizes[k] = bytes.size();
    mine += bytes;
  }
  std::vector<bigint> all(now.size());
  MPI_Reduce(sizes.data(), all.data(), (int) now.size(), MPI_LMP_BIGINT, MPI_SUM, 0, world);
  if (comm->me > 0) {
    send_bytes(world, mine.data(), mine.size(), 0);
    return;
  }

  std::map<int, bigint> total, next;
  for (size_t k = 0; k < now.size(); k++) total[bands.owner(now[k])] += all[k];
  std::map<int, std::string> texts;
  texts[0].swap(mine);
  for (size_t k = 0; k < now.size(); k++) {
    if (all[k] == 0) continue;    // perhaps after the last byte of its rank
    const int owner = bands.owner(now[k]);
    if (owner > 0 && next[owner] == 0) {
      texts[owner].resize(total[owner]);
      receive_bytes(world, &texts[owner][0], total[owner], owner);
    }
    take(texts[owner].substr(next[owner], all[k]));
    next[owner] += all[k];
    if (next[owner] == total[owner]) texts[owner] = std::string();
  }
}

/* ---------------------------------------------------------------------- */

double DepositExchange::sum(double value)
{
  double found;
  MPI_Allreduce(&value, &found, 1, MPI_DOUBLE, MPI_SUM, world);
  return found;
}

// Blocks to the ranks that hold their bands, and bytes of bands to rank 0, in their order

#include "deck.h"
#include "deposit_exchange.h"

#include <map>

using namespace LAMMPS_NS;
using Slope::DepositBands;
using Slope::DepositBlocks;

struct Exchange {
  Deck deck;
  DepositExchange exchange{deck.lmp.get()};
  int me = deck.me(), nprocs = deck.lmp->comm->nprocs;
  Slope::PlanGrid grid;
  DepositBands bands;

  Exchange(int columns, int rows)
  {
    const double extent[4] = {0.0, 1.0 * columns, 0.0, 1.0 * rows};
    grid = Slope::PlanGrid(extent, 1.0);
    bands = DepositBands(grid, me, nprocs);
  }
};

// each rank has all blocks, and adds its number + 1 to one cell: more blocks than go in a round
TEST(DepositExchange, ToOwners)
{
  Exchange e(600, 600);
  DepositBlocks blocks({0.0, -1.0});
  blocks.set_grid(e.grid);
  const int side = 75;    // blocks along x and y
  for (int band = 0; band < side; band++)
    for (int column = 0; column < side; column++) {
      double *values = blocks.make(column, band);
      values[(column + band) % 64] += e.me + 1.0;
      values[64 + column % 64] = e.me;
    }
  std::map<std::pair<int, int>, double> sums;
  std::map<std::pair<int, int>, int> last;
  e.exchange.to_owners(blocks, e.bands, [&](int column, int band, const double *values) {
    EXPECT_TRUE(e.bands.mine(band));
    sums[{column, band}] += values[(column + band) % 64];
    EXPECT_EQ(values[(column + band + 1) % 64], 0.0);
    const double rank = values[64 + column % 64];
    EXPECT_EQ(rank, (last[{column, band}]++));    // in the order of the ranks
  });
  size_t wanted = 0;
  for (int band = 0; band < side; band++) wanted += e.bands.mine(band) * side;
  EXPECT_EQ(sums.size(), wanted);
  for (const auto &sum : sums) EXPECT_EQ(sum.second, e.nprocs * (e.nprocs + 1) / 2.0);
}

// ranks that have nothing take part
TEST(DepositExchange, FromOneRank)
{
  Exchange e(64, 64);
  DepositBlocks blocks({0.0});
  blocks.set_grid(e.grid);
  if (e.me == e.nprocs - 1) blocks.make(3, 5)[7] = 42.0;
  int taken = 0;
  e.exchange.to_owners(blocks, e.bands, [&](int column, int band, const double *values) {
    EXPECT_EQ(column, 3);
    EXPECT_EQ(band, 5);
    EXPECT_EQ(values[7], 42.0);
    taken++;
  });
  EXPECT_EQ(taken, e.bands.mine(5));
}

// bands of any size, some empty, forwards and backwards, in several batches
TEST(DepositExchange, ToRankZero)
{
  Exchange e(10, 1600);
  const auto text = [](int band) { return std::string(band % 7, static_cast<char>('a' + band % 26)); };
  for (const bool up : {true, false}) {
    const int from = up ? 3 : 190, to = up ? 190 : 3;
    std::string all, wanted;
    for (int band = from; band != to + (up ? 1 : -1); band += up ? 1 : -1) wanted += text(band);
    e.exchange.to_rank_zero(
        e.bands, from, to,
        [&](int band) {
          EXPECT_TRUE(e.bands.mine(band));
          return text(band);
        },
        [&](const std::string &bytes) { all += bytes; });
    EXPECT_EQ(all, e.me == 0 ? wanted : "");
  }
  EXPECT_EQ(e.exchange.sum(e.me + 1.0), e.nprocs * (e.nprocs + 1) / 2.0);
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_BINS_H
#define SLOPE_DEPOSIT_BINS_H

#include "plan_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace Slope {

// A block of a deposit: SIDE x SIDE cells of a plan grid, row by row, and KINDS values of each. Numbers
// only, so that ranks can send it.
struct BlockOfCells {
  static constexpr int SIDE = 8;
  static constexpr int CELLS = SIDE * SIDE;

  int column, row;    // of blocks

  // column or row of the block that a cell is in, and its place in the block
  static int of_cell(unsigned k) { return k / SIDE; }
  static int index(unsigned i, unsigned j) { return j % SIDE * SIDE + i % SIDE; }
  static int across(int cells) { return cells / SIDE + (cells % SIDE > 0); }
};

// Values of the cells of a plan grid, in memory only where there is something.
template <int KINDS> class DepositBlocks {
 public:
  struct Block : BlockOfCells {
    double values[KINDS][CELLS];
  };

  // what cells of a new block have, one value of each kind
  explicit DepositBlocks(const double *start) : across(0), last(nullptr)
  {
    for (int kind = 0; kind < KINDS; kind++)
      std::fill_n(empty.values[kind], empty.CELLS, start[kind]);
  }

  void set_grid(const PlanGrid &grid)
  {
    across = Block::across(grid.n[0]);
    blocks.clear();
    last = nullptr;
    directory.assign(Block::across(grid.n[1]), std::vector<int32_t>());
  }

  // address space for all blocks, so that none of them ever moves; memory is taken as they are made
  void reserve() { blocks.reserve((size_t) across * directory.size()); }

  void clear()    // no blocks; their memory is used again
  {
    for (const Block &block : blocks) directory[block.row][block.column] = -1;
    blocks.clear();
    last = nullptr;
  }

  // the block in this column and row of blocks, made if it is not there; valid until the next one is
  Block &make(int column, int row)
  {
    if (last && column == last->column && row == last->row)
      return *last;    // balls come in clusters
    std::vector<int32_t> &places = directory[row];
    if (places.empty()) places.assign(across, -1);
    if (places[column] < 0) {
      places[column] = (int32_t) blocks.size();
      empty.column = column;
      empty.row = row;
      blocks.push_back(empty);
    }
    last = &blocks[places[column]];
    return *last;
  }

  // nullptr if there is none
  const Block *find(int column, int row) const
  {
    const std::vector<int32_t> &places = directory[row];
    return places.empty() || places[column] < 0 ? nullptr : &blocks[places[column]];
  }

  // all of them, in the order in which they were made
  std::vector<Block> &all() { return blocks; }
  const std::vector<Block> &all() const { return blocks; }

  double bytes() const
  {
    double sum = (double) blocks.size() * sizeof(Block);
    for (const auto &places : directory)
      sum += sizeof(places) + places.capacity() * sizeof(int32_t);
    return sum;
  }

 private:
  Block empty;
  int across;                                     // blocks in a row of them
  std::vector<std::vector<int32_t>> directory;    // row, column: number of the block; -1: none
  std::vector<Block> blocks;
  Block *last;    // of the last make()
};

// Balls of a deposit in the cells of a plan grid. A ball represents a cube of ground; the cube's
// square in plan is cut exactly by the cells, so that no volume is lost on any grid.
class DepositBins {
 public:
  // of a cell: the volume that lies over it, and of the balls whose centre is over it the largest
  // speed (-1: no centre) and the largest energy
  enum { VOLUME, SPEED, ENERGY, KINDS };
  typedef DepositBlocks<KINDS> Blocks;

  DepositBins();

  void set_grid(const PlanGrid &);

  // squares that reach beyond this box along an axis continue at its other side
  void set_period(int dim, bool periodic, double boxlo, double boxhi);

  void clear() { bins.clear(); }

  // a ball's place, the side of its cube; returns the part of its volume that is off the grid,
  // exactly 0 for a square that does not touch the edge
  double bin(const double *x, double side, double speed, double energy);

  const Blocks &blocks() const { return bins; }

 private:
  struct Cuts {    // of one ball's square by the cells along one axis
    std::vector<int> cell;
    std::vector<double> part;
    int count;
  };

  PlanGrid grid;
  bool periodic[2];
  double boxlo[2], boxhi[2];
  Blocks bins;
  Cuts cuts[2];

  double wrap(int dim, double x) const    // balls leave a periodic box a little
  {
    if (!periodic[dim]) return x;
    const double prd = boxhi[dim] - boxlo[dim];
    return x - prd * std::floor((x - boxlo[dim]) / prd);
  }
  void add_volume(double volume);
  void add_centre(const double *place, double speed, double energy);
  void cut(int dim, double centre, double side, double &beyond);
  void cut_piece(int dim, double a, double b, double side, double &beyond);
};

}    // namespace Slope

#endif

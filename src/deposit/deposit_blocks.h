// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_BLOCKS_H
#define SLOPE_DEPOSIT_BLOCKS_H

#include "deposit_bands.h"
#include "plan_grid.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace Slope {

// Values of the cells of a plan grid, several kinds of them, in memory only where there is something:
// in blocks of SIDE x SIDE cells. A block has all values of one kind, row by row, then those of the
// next kind.
class DepositBlocks {
 public:
  static constexpr int SIDE = DepositBands::ROWS;    // a band of rows is a row of blocks
  static constexpr int CELLS = SIDE * SIDE;

  // what cells of a new block have, one value of each kind
  explicit DepositBlocks(const std::vector<double> &start_in) :
      start(start_in), across(0), last{-1, -1}, last_values(nullptr)
  {
  }

  void set_grid(const PlanGrid &);
  void clear();    // no blocks; their memory is used again

  size_t values_per_block() const { return CELLS * start.size(); }

  // values of the block in this column and band of blocks, made if it is not there
  double *make(int column, int band)
  {
    if (column == last.column && band == last.band) return last_values;    // balls come in clusters
    const std::vector<int32_t> &places = directory[band];
    last_values = !places.empty() && places[column] >= 0 ? values[places[column]].get()
                                                         : add(column, band);
    last.column = column;
    last.band = band;
    return last_values;
  }

  // nullptr if there is none
  const double *find(int column, int band) const
  {
    const std::vector<int32_t> &places = directory[band];
    return places.empty() || places[column] < 0 ? nullptr : values[places[column]].get();
  }

  // column or band of the block that a cell is in, and where in the values of the block the cell has
  // its value of kind 0
  static int of_cell(unsigned k) { return k / SIDE; }
  static int index(unsigned i, unsigned j) { return j % SIDE * SIDE + i % SIDE; }

  // all blocks, in the order in which they were made
  size_t size() const { return blocks.size(); }
  int column(size_t k) const { return blocks[k].column; }
  int band(size_t k) const { return blocks[k].band; }
  double *operator[](size_t k) { return values[k].get(); }
  const double *operator[](size_t k) const { return values[k].get(); }

  double bytes() const;

 private:
  struct Place {
    int column, band;
  };

  std::vector<double> start;
  int across;                                     // blocks in a band
  std::vector<std::vector<int32_t>> directory;    // band, column: number of the block; -1: none
  std::vector<Place> blocks;
  std::vector<std::unique_ptr<double[]>> values;    // of more blocks than there are, after clear()
  Place last;                                       // block of the last make()
  double *last_values;

  double *add(int column, int band);
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_EXCHANGE_H
#define SLOPE_DEPOSIT_EXCHANGE_H

#include "deposit_bands.h"
#include "deposit_blocks.h"
#include "pointers.h"

#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// How the ranks of fix deposit/grid exchange their parts of the plan grid. All methods are
// collective. No message is too large for MPI, whatever the size of the grid, and what a rank keeps for
// them does not grow with its rows.
class DepositExchange : protected Pointers {
 public:
  explicit DepositExchange(class LAMMPS *lmp) : Pointers(lmp) {}

  // All blocks to the ranks that hold their bands; there take() gets column, band and values of each,
  // in an order that depends on nothing but the ranks and their blocks.
  typedef std::function<void(int column, int band, const double *values)> TakeBlock;
  void to_owners(const Slope::DepositBlocks &, const Slope::DepositBands &, const TakeBlock &take);

  // Data of the bands from ... to, in ascending or descending order: make() is called on the rank
  // that holds the band, take() on rank 0, band by band in this order. take() must not throw.
  typedef std::function<std::string(int band)> MakeBytes;
  typedef std::function<void(const std::string &)> TakeBytes;
  void to_rank_zero(const Slope::DepositBands &, int from, int to, const MakeBytes &make,
                    const TakeBytes &take);

  double sum(double value);    // of all ranks

 private:
  void one_round(const Slope::DepositBlocks &, size_t begin, size_t end,
                 const Slope::DepositBands &, const TakeBlock &);
  void batch_to_rank_zero(const Slope::DepositBands &, const std::vector<int> &bands,
                          const MakeBytes &, const TakeBytes &);
};

}    // namespace LAMMPS_NS

#endif

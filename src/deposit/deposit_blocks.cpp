// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_blocks.h"

#include <algorithm>

using namespace Slope;

enum { X, Y };

/* ---------------------------------------------------------------------- */

void DepositBlocks::set_grid(const PlanGrid &grid)
{
  across = grid.n[X] / SIDE + (grid.n[X] % SIDE > 0);
  directory.clear();
  directory.resize(DepositBands(grid, 0, 1).number());
  blocks.clear();
  last.column = last.band = -1;
}

/* ---------------------------------------------------------------------- */

void DepositBlocks::clear()
{
  for (const Place &block : blocks) directory[block.band][block.column] = -1;
  blocks.clear();
  last.column = last.band = -1;
}

/* ---------------------------------------------------------------------- */

double *DepositBlocks::add(int column, int band)
{
  if (directory[band].empty()) directory[band].assign(across, -1);
  directory[band][column] = (int32_t) blocks.size();
  blocks.push_back({column, band});
  if (values.size() < blocks.size()) values.emplace_back(new double[values_per_block()]);

  double *block = values[blocks.size() - 1].get();
  for (size_t kind = 0; kind < start.size(); kind++)
    std::fill_n(block + kind * CELLS, (size_t) CELLS, start[kind]);
  return block;
}

/* ---------------------------------------------------------------------- */

double DepositBlocks::bytes() const
{
  double sum = (double) values.size() * (values_per_block() * sizeof(double) + sizeof(Place));
  for (const auto &places : directory) sum += sizeof(places) + places.capacity() * sizeof(int32_t);
  return sum;
}

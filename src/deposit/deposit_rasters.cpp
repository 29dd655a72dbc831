// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_rasters.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace Slope;

static constexpr int SIDE = DepositBlocks::SIDE;
static constexpr int CELLS = DepositBlocks::CELLS;
static const double NaN = std::numeric_limits<double>::quiet_NaN();

enum { X, Y };

// of a cell where nothing ever was, kind by kind
static const double UNTOUCHED[DepositRasters::KINDS] = {0.0, 0.0, 0.0, 0.0, NaN, NaN, 0.0};

/* ---------------------------------------------------------------------- */

DepositRasters::DepositRasters() :
    snapshot_time(NaN), change(1.0), blocks(std::vector<double>(UNTOUCHED, UNTOUCHED + KINDS))
{
}

/* ---------------------------------------------------------------------- */

void DepositRasters::create(const PlanGrid &grid_in, int me, int nranks)
{
  cells = grid_in;
  rows = DepositBands(cells, me, nranks);
  blocks.set_grid(cells);
  ground.assign(rows.ncells(), NaN);
}

/* ---------------------------------------------------------------------- */

void DepositRasters::clear()
{
  for (size_t k = 0; k < blocks.size(); k++) std::fill_n(blocks[k] + THICKNESS * CELLS, CELLS, 0.0);
}

/* ---------------------------------------------------------------------- */

void DepositRasters::add(int column, int band, const double *bins, bool record, double time,
                         double motion)
{
  const double area = cells.cell * cells.cell;
  double *block = blocks.make(column, band);
  for (int k = 0; k < CELLS; k++) {
    block[THICKNESS * CELLS + k] += bins[DepositBins::VOLUME * CELLS + k] / area;
    const double speed = bins[DepositBins::SPEED * CELLS + k];
    if (!record || speed < 0.0) continue;
    double &most_speed = block[MAX_SPEED * CELLS + k], &most_energy = block[MAX_ENERGY * CELLS + k];
    double &arrival = block[ARRIVAL * CELLS + k];
    most_speed = std::max(most_speed, speed);
    most_energy = std::max(most_energy, bins[DepositBins::ENERGY * CELLS + k]);
    if (std::isnan(arrival)) arrival = time;
    if (speed > motion) block[LAST_MOTION * CELLS + k] = time;
  }
}

/* ----------------------------------------------------------------------
   the volume is taken from what the raster holds, so that the balance checks the raster
------------------------------------------------------------------------- */

double DepositRasters::finish(bool record)
{
  double sum = 0.0;
  for (size_t b = 0; b < blocks.size(); b++) {
    const double *h = blocks[b] + THICKNESS * CELLS;
    double *most = blocks[b] + MAX_THICKNESS * CELLS;
    double here = 0.0;
    for (int k = 0; k < CELLS; k++) here += h[k];
    sum += here;
    if (!record) continue;
    for (int k = 0; k < CELLS; k++) most[k] = std::max(most[k], h[k]);
  }
  return sum * cells.cell * cells.cell;
}

/* ---------------------------------------------------------------------- */

double DepositRasters::moved() const
{
  double sum = 0.0;
  for (size_t b = 0; b < blocks.size(); b++) {
    const double *h = blocks[b] + THICKNESS * CELLS, *before = blocks[b] + SNAPSHOT * CELLS;
    double here = 0.0;
    for (int k = 0; k < CELLS; k++) here += std::fabs(h[k] - before[k]);
    sum += here;
  }
  return 0.5 * sum * cells.cell * cells.cell;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::take_snapshot(double time, double share)
{
  if (time > snapshot_time) change = share / (time - snapshot_time);
  for (size_t b = 0; b < blocks.size(); b++)
    std::copy_n(blocks[b] + THICKNESS * CELLS, CELLS, blocks[b] + SNAPSHOT * CELLS);
  snapshot_time = time;
}

/* ---------------------------------------------------------------------- */

double DepositRasters::at(Name name, int i, int j) const
{
  const double *block = blocks.find(i / SIDE, j / SIDE);
  return block ? block[name * CELLS + DepositBlocks::index(i, j)] : UNTOUCHED[name];
}

/* ---------------------------------------------------------------------- */

void DepositRasters::row(Name name, int j, double *values) const
{
  for (int i = 0; i < cells.n[X]; i += SIDE) {
    const int count = std::min(SIDE, cells.n[X] - i);
    const double *block = blocks.find(i / SIDE, j / SIDE);
    if (block)
      std::copy_n(block + name * CELLS + DepositBlocks::index(i, j), count, values + i);
    else
      std::fill_n(values + i, count, UNTOUCHED[name]);
  }
}

/* ---------------------------------------------------------------------- */

double DepositRasters::largest(Name name) const
{
  double found = 0.0;
  for (size_t b = 0; b < blocks.size(); b++) {
    const double *values = blocks[b] + name * CELLS;
    found = std::max(found, *std::max_element(values, values + CELLS));
  }
  return found;
}

/* ---------------------------------------------------------------------- */

double DepositRasters::bytes() const
{
  return (double) ground.capacity() * sizeof(double) + blocks.bytes();
}

/* ---------------------------------------------------------------------- */

std::vector<double> DepositRasters::touched(int band) const
{
  std::vector<double> found;
  for (int j = rows.first_row(band); j < rows.end_row(band); j++)
    for (int i = 0; i < cells.n[X]; i += SIDE) {
      const double *block = blocks.find(i / SIDE, band);
      if (!block) continue;
      const double *cell = block + DepositBlocks::index(i, j);
      for (int k = i; k < std::min(i + SIDE, cells.n[X]); k++, cell++) {
        if (cell[MAX_THICKNESS * CELLS] == 0.0 && std::isnan(cell[ARRIVAL * CELLS])) continue;
        found.push_back((double) j * cells.n[X] + k);
        for (int kind = MAX_THICKNESS; kind < KINDS; kind++) found.push_back(cell[kind * CELLS]);
      }
    }
  return found;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::restore(const double *values)
{
  const int64_t number = (int64_t) values[0];
  const int i = (int) (number % cells.n[X]), j = (int) (number / cells.n[X]);
  if (!rows.mine(j / SIDE)) return;
  double *cell = blocks.make(i / SIDE, j / SIDE) + DepositBlocks::index(i, j);
  for (int kind = MAX_THICKNESS; kind < KINDS; kind++) cell[kind * CELLS] = values[kind];
}

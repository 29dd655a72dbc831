// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_rasters.h"

#include "elevation_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace Slope;

static constexpr int SIDE = BlockOfCells::SIDE;
static constexpr int CELLS = BlockOfCells::CELLS;
// digits in files: the sum of the thickness as written is the volume on the grid to 1e-9
static constexpr int EXACT = 12, DIGITS = 9;
typedef DepositBlocks<DepositRasters::KINDS>::Block Block;
static const double NaN = std::numeric_limits<double>::quiet_NaN();

enum { X, Y };

// of a cell where nothing ever was: thickness, largest thickness, speed and energy; arrival, last motion; snapshot
static const double UNTOUCHED[] = {0.0, 0.0, 0.0, 0.0, NaN, NaN, 0.0};
static_assert(sizeof(UNTOUCHED) / sizeof(double) == DepositRasters::KINDS, "one of each kind");

/* ---------------------------------------------------------------------- */

DepositRasters::DepositRasters() : snapshot_time(NaN), change(1.0), blocks(UNTOUCHED) {}

/* ---------------------------------------------------------------------- */

void DepositRasters::create(const PlanGrid &grid_in)
{
  cells = grid_in;
  blocks.set_grid(cells);
}

/* ---------------------------------------------------------------------- */

void DepositRasters::set_base(std::vector<double> heights)
{
  ground.swap(heights);
  blocks.reserve();
}

/* ---------------------------------------------------------------------- */

void DepositRasters::clear()
{
  for (Block &block : blocks.all()) std::fill_n(block.values[THICKNESS], CELLS, 0.0);
}

/* ---------------------------------------------------------------------- */

void DepositRasters::add(const DepositBins::Blocks::Block &bins, bool record, double time,
                         double motion)
{
  const double area = cells.cell * cells.cell;
  Block &block = blocks.make(bins.column, bins.row);
  for (int k = 0; k < CELLS; k++) {
    block.values[THICKNESS][k] += bins.values[DepositBins::VOLUME][k] / area;
    const double speed = bins.values[DepositBins::SPEED][k];
    if (!record || speed < 0.0) continue;
    double &most_speed = block.values[MAX_SPEED][k], &most_energy = block.values[MAX_ENERGY][k];
    double &arrival = block.values[ARRIVAL][k];
    most_speed = std::max(most_speed, speed);
    most_energy = std::max(most_energy, bins.values[DepositBins::ENERGY][k]);
    if (std::isnan(arrival)) arrival = time;
    if (speed > motion) block.values[LAST_MOTION][k] = time;
  }
}

/* ----------------------------------------------------------------------
   the volume is taken from what the raster holds, so that the balance checks the raster
------------------------------------------------------------------------- */

double DepositRasters::finish(bool record)
{
  double sum = 0.0;
  for (Block &block : blocks.all()) {
    const double *h = block.values[THICKNESS];
    double *most = block.values[MAX_THICKNESS];
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
  for (const Block &block : blocks.all()) {
    const double *h = block.values[THICKNESS], *before = block.values[SNAPSHOT];
    double here = 0.0;
    for (int k = 0; k < CELLS; k++) here += std::fabs(h[k] - before[k]);
    sum += here;
  }
  return 0.5 * sum * cells.cell * cells.cell;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::take_snapshot(double time, double fraction)
{
  if (time > snapshot_time) change = fraction / (time - snapshot_time);
  for (Block &block : blocks.all())
    std::copy_n(block.values[THICKNESS], CELLS, block.values[SNAPSHOT]);
  snapshot_time = time;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::row(Name name, int j, double *values) const
{
  for (int i = 0; i < cells.n[X]; i += SIDE) {
    const int count = std::min(SIDE, cells.n[X] - i);
    const Block *block = blocks.find(i / SIDE, j / SIDE);
    if (block)
      std::copy_n(block->values[name] + Block::index(i, j), count, values + i);
    else
      std::fill_n(values + i, count, UNTOUCHED[name]);
  }
}

/* ---------------------------------------------------------------------- */

double DepositRasters::largest(Name name) const
{
  double found = 0.0;
  for (const Block &block : blocks.all())
    found = std::max(found, *std::max_element(block.values[name], block.values[name] + CELLS));
  return found;
}

/* ---------------------------------------------------------------------- */

double DepositRasters::bytes() const
{
  return (double) ground.capacity() * sizeof(double) + blocks.bytes();
}

/* ---------------------------------------------------------------------- */

std::vector<double> DepositRasters::touched(int j) const
{
  std::vector<double> found;
  for (int i = 0; i < cells.n[X]; i++) {
    const Block *block = blocks.find(i / SIDE, j / SIDE);
    if (!block) continue;
    const int k = Block::index(i, j);
    if (block->values[MAX_THICKNESS][k] == 0.0 && std::isnan(block->values[ARRIVAL][k])) continue;
    found.push_back((double) j * cells.n[X] + i);
    for (int kind = MAX_THICKNESS; kind < KINDS; kind++) found.push_back(block->values[kind][k]);
  }
  return found;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::restore(const double *values)
{
  const int64_t number = (int64_t) values[0];
  const int i = (int) (number % cells.n[X]), j = (int) (number / cells.n[X]);
  Block &block = blocks.make(i / SIDE, j / SIDE);
  for (int kind = MAX_THICKNESS; kind < KINDS; kind++)
    block.values[kind][Block::index(i, j)] = values[kind];
}

/* ---------------------------------------------------------------------- */

std::vector<DepositRasters::File> DepositRasters::files(const std::string &prefix,
                                                        const std::string &number)
{
  std::vector<File> found;
  if (!number.empty())
    found.push_back({prefix + "." + number + ".thickness.asc", THICKNESS, EXACT});
  const std::vector<File> always = {
      {".thickness.asc", THICKNESS, EXACT},  {".surface.asc", SURFACE, DIGITS},
      {".base.asc", BASE, DIGITS},           {".max_thickness.asc", MAX_THICKNESS, DIGITS},
      {".max_speed.asc", MAX_SPEED, DIGITS}, {".max_energy.asc", MAX_ENERGY, DIGITS},
      {".arrival.asc", ARRIVAL, DIGITS},     {".last_motion.asc", LAST_MOTION, DIGITS}};
  for (const File &file : always) found.push_back({prefix + file.path, file.content, file.digits});
  return found;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::write(AtomicFile &to, const File &file) const
{
  const int columns = cells.n[X];
  std::vector<double> values(columns, 0.0);
  std::string text =
      ElevationGrid::header(columns, cells.n[Y], cells.lo[X], cells.lo[Y], cells.cell);
  for (int j = cells.n[Y] - 1; j >= 0; j--) {    // the rows start in the north
    if (file.content == SURFACE)
      row(THICKNESS, j, values.data());
    else if (file.content != BASE)
      row((Name) file.content, j, values.data());
    for (int i = 0; i < columns && file.content >= BASE; i++)
      values[i] = base(i, j) + (file.content == SURFACE ? values[i] : 0.0);
    ElevationGrid::append_row(text, values.data(), columns, file.digits);
    to.write(text);
    text.clear();
  }
}

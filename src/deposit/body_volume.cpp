/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "body_volume.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <unordered_map>

using namespace Slope;

static constexpr int FIRST_CELLS = 32;          // along the longer side
static constexpr int FIRST_STEPS = 1000;        // of a search through the whole height
static constexpr int STEPS = 24;                // of one near to what the columns around found
static constexpr double STEPS_IN_BODY = 4.0;    // at least so many in what the columns around found
static constexpr int BISECTIONS = 10;           // of a step
static constexpr size_t ENOUGH_MARKED = 200;    // cells: the body is no longer smaller than a cell
static constexpr int MARKED_LEVELS = 5;
static constexpr int LEVELS = 24;
static constexpr double STEEPEST = 2.0;    // slope of the body's surface beyond the columns around
static constexpr double SAME = 3.0e-4;     // two sums; the finer one is a third as wrong
static constexpr size_t ENOUGH_FILLED = 20000;    // columns: fewer may agree by chance
static constexpr size_t MOST_FILLED = 500000;

enum { X, Y, Z };

/* ----------------------------------------------------------------------
   numbers in 0..1 that only the cell decides on, so that ranks play no part: splitmix64
------------------------------------------------------------------------- */

namespace {
class Chance {
 public:
  Chance(int level, int i, int j) :
      state(((uint64_t) level << 58) ^ ((uint64_t) i << 29) ^ (uint64_t) j)
  {
    next();
  }
  double next()
  {
    uint64_t x = state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return ((x ^ (x >> 31)) >> 11) * 1.1102230246251565e-16;
  }

 private:
  uint64_t state;
};
}    // namespace

/* ---------------------------------------------------------------------- */

BodyVolume::BodyVolume(const Box &box_in, const Inside &inside_in, const Ranks &ranks_in) :
    box(box_in), inside(inside_in), ranks(ranks_in), any_marks(true), cell(0.0), n{0, 0}, level(0),
    filled(0)
{
}

/* ---------------------------------------------------------------------- */

void BodyVolume::mark(double x, double y)
{
  marks.push_back(x);
  marks.push_back(y);
}

/* ---------------------------------------------------------------------- */

double BodyVolume::volume()
{
  for (int dim = X; dim <= Z; dim++)
    if (!(box.lo[dim] < box.hi[dim])) return 0.0;

  set_level(0);
  cells.clear();
  for (int j = 0; j < n[Y]; j++)
    for (int i = 0; i < n[X]; i++) cells.push_back({i, j, FIRST_STEPS, box.lo[Z], box.hi[Z]});

  double found = sum();
  while (true) {
    const double before = found;
    split();
    if (cells.empty()) return 0.0;
    found = sum();
    if (filled >= ENOUGH_FILLED && std::fabs(found - before) <= SAME * found) return found;
    if (filled > MOST_FILLED || level == LEVELS) {
      char text[160];
      snprintf(text, sizeof(text),
               "its volume must be a number to 1e-3, got %.6g and %.6g in finer and finer columns",
               before, found);
      throw std::runtime_error(text);
    }
  }
}

/* ---------------------------------------------------------------------- */

void BodyVolume::set_level(int level_in)
{
  level = level_in;
  const double length[2] = {box.hi[X] - box.lo[X], box.hi[Y] - box.lo[Y]};
  cell = std::max(length[X], length[Y]) / FIRST_CELLS / std::pow(2.0, level);
  for (int dim = X; dim <= Y; dim++)
    n[dim] = (int) std::max(1.0, std::ceil(length[dim] / cell - 1.0e-9));
}

/* ---------------------------------------------------------------------- */

void BodyVolume::add_up(std::vector<double> &values) const
{
  if (ranks.sum) ranks.sum(values);
}

/* ----------------------------------------------------------------------
   all columns; each rank's are 0 on the others, so that adding up rounds nothing
------------------------------------------------------------------------- */

double BodyVolume::sum()
{
  std::vector<double> found(3 * cells.size(), 0.0);
  for (size_t k = ranks.me; k < cells.size(); k += ranks.number) {
    found[3 * k] = column(cells[k]);
    found[3 * k + 1] = cells[k].zlo;
    found[3 * k + 2] = cells[k].zhi;
  }
  add_up(found);

  double total = 0.0;
  filled = 0;
  for (size_t k = 0; k < cells.size(); k++) {
    total += found[3 * k];
    if (found[3 * k] > 0.0) filled++;
    cells[k].zlo = found[3 * k + 1];
    cells[k].zhi = found[3 * k + 2];
  }
  return total * cell * cell;
}

/* ----------------------------------------------------------------------
   length of the body over one place in a cell. A piece that is thinner than a step is met with
   the chance thickness/step, and counts as a step then: right in the mean. So do gaps.
------------------------------------------------------------------------- */

double BodyVolume::column(Cell &c) const
{
  Chance chance(level, c.i, c.j);
  const double x = box.lo[X] + (c.i + chance.next()) * cell;
  const double y = box.lo[Y] + (c.j + chance.next()) * cell;
  const double step = (c.zhi - c.zlo) / c.steps, last = c.zhi;
  double z = c.zlo + chance.next() * step;
  c.zlo = 1.0;
  c.zhi = -1.0;
  if (x > box.hi[X] || y > box.hi[Y]) return 0.0;

  while (there(x, y, z)) z -= step;    // more of it below than was expected

  double length = 0.0, bottom = 0.0;
  bool was = false, any = false;
  for (; was || z <= last; z += step) {
    const bool now = there(x, y, z);
    if (now && !was) {
      bottom = edge(x, y, z - step, z);
      if (!any)
        c.zlo = bottom;
      else
        length -= std::max(0.0, step - (bottom - c.zhi));
      any = true;
    } else if (was && !now) {
      c.zhi = edge(x, y, z, z - step);
      length += std::max(c.zhi - bottom, step);
    }
    was = now;
  }
  return std::max(0.0, length);
}

/* ---------------------------------------------------------------------- */

double BodyVolume::edge(double x, double y, double out, double in) const
{
  for (int k = 0; k < BISECTIONS; k++) {
    const double middle = 0.5 * (out + in);
    (there(x, y, middle) ? in : out) = middle;
  }
  return 0.5 * (out + in);
}

/* ----------------------------------------------------------------------
   the cells of the next level: the quarters of all cells that hold some of the body and of their
   eight neighbours, to be searched near to what these found
------------------------------------------------------------------------- */

void BodyVolume::split()
{
  const double margin = STEEPEST * cell;
  const std::vector<Cell> parents = cells;
  set_level(level + 1);

  std::unordered_map<int64_t, size_t> place;
  cells.clear();
  for (const Cell &parent : parents) {
    if (!(parent.zlo < parent.zhi)) continue;
    const double zlo = std::max(box.lo[Z], parent.zlo - margin);
    const double zhi = std::min(box.hi[Z], parent.zhi + margin);
    const double most = STEPS_IN_BODY * (zhi - zlo) / (parent.zhi - parent.zlo);
    const int steps =
        std::min(FIRST_STEPS, std::max(STEPS, (int) std::min(most, 1.0 * FIRST_STEPS)));
    for (int j = std::max(0, 2 * parent.j - 2); j < std::min(n[Y], 2 * parent.j + 4); j++)
      for (int i = std::max(0, 2 * parent.i - 2); i < std::min(n[X], 2 * parent.i + 4); i++) {
        const auto known = place.insert({key(i, j), cells.size()});
        if (known.second) {
          cells.push_back({i, j, steps, zlo, zhi});
        } else {
          Cell &child = cells[known.first->second];
          child.zlo = std::min(child.zlo, zlo);
          child.zhi = std::max(child.zhi, zhi);
          child.steps = std::max(child.steps, steps);
        }
      }
  }
  if (any_marks) add_marked(cells);
}

/* ----------------------------------------------------------------------
   as long as the body may be smaller than a cell, those with a mark are searched as well
------------------------------------------------------------------------- */

void BodyVolume::add_marked(std::vector<Cell> &all)
{
  std::vector<double> marked((size_t) n[X] * n[Y], 0.0);
  for (size_t k = 0; k < marks.size(); k += 2) {
    const double i = std::floor((marks[k] - box.lo[X]) / cell);
    const double j = std::floor((marks[k + 1] - box.lo[Y]) / cell);
    if (i >= 0.0 && i < n[X] && j >= 0.0 && j < n[Y]) marked[key((int) i, (int) j)] = 1.0;
  }
  add_up(marked);
  const size_t count = marked.size() - std::count(marked.begin(), marked.end(), 0.0);
  any_marks = count > 0 && count < ENOUGH_MARKED && level < MARKED_LEVELS;

  for (const Cell &c : all) marked[key(c.i, c.j)] = 0.0;
  for (int j = 0; j < n[Y]; j++)
    for (int i = 0; i < n[X]; i++)
      if (marked[key(i, j)] > 0.0) all.push_back({i, j, FIRST_STEPS, box.lo[Z], box.hi[Z]});
}

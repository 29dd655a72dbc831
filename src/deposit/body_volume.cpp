// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "body_volume.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

using namespace Slope;

static constexpr int FIRST_CELLS = 128, MOST_CELLS = 3500;    // along the longer side
static constexpr double FINER = 1.5;    // cells of a sum, along a side, over those of the last one
static constexpr double ROUNDING = 1.0e-9;    // of a cell
static constexpr double SAME = 3.0e-4;        // two sums; the finer one is less than half as wrong
static constexpr double ENOUGH_FILLED = 20000;    // columns: fewer may agree by chance

// Places of the columns in their cells, from one to the next: 1/g and 1/g^2, g^3 = g + 1 (the plastic number),
// whose multiples, modulo 1, fill a square evenly (M. Roberts, The unreasonable effectiveness of quasirandom
// sequences, 2018)
static constexpr double STEP_X = 0.7548776662466927, STEP_Y = 0.5698402909980532;

enum { X, Y };

/* ----------------------------------------------------------------------
   A row of cells belongs to one rank and is 0 on the others, so that adding up rounds nothing. Returns the
   volume; around: the cells that hold some of the body, and their neighbors
------------------------------------------------------------------------- */

static double volume_in_cells(const PlanBox &box, int most,
                              const std::function<double(double, double)> &length,
                              const ColumnRanks &ranks, double &filled, PlanBox &around)
{
  enum { VOLUME, FILLED, FIRST, END, NUMBER };
  const double size[2] = {box.hi[X] - box.lo[X], box.hi[Y] - box.lo[Y]};
  const double cell = std::max(size[X], size[Y]) / most;
  const int nx = static_cast<int>(std::ceil(size[X] / cell - ROUNDING));
  const int ny = static_cast<int>(std::ceil(size[Y] / cell - ROUNDING));
  std::vector<double> rows(static_cast<size_t>(NUMBER) * ny, 0.0);
  for (int j = ranks.me; j < ny; j += ranks.number) {
    double *row = &rows[static_cast<size_t>(NUMBER) * j];
    for (int i = 0; i < nx; i++) {
      const double k = static_cast<double>(j) * nx + i + 1.0;
      const double x = box.lo[X] + (i + std::fmod(k * STEP_X, 1.0)) * cell;
      const double y = box.lo[Y] + (j + std::fmod(k * STEP_Y, 1.0)) * cell;
      const double here = x > box.hi[X] || y > box.hi[Y] ? 0.0 : length(x, y);
      if (!(here > 0.0)) continue;
      if (row[FILLED]++ == 0.0) row[FIRST] = i;
      row[END] = i + 1;
      row[VOLUME] += here * cell * cell;
    }
  }
  if (ranks.sum) ranks.sum(rows);

  double volume = 0.0;
  filled = 0.0;
  for (int j = 0; j < ny; j++) {
    const double *row = &rows[static_cast<size_t>(NUMBER) * j];
    if (row[FILLED] == 0.0) continue;
    volume += row[VOLUME];
    filled += row[FILLED];
    const double x = box.lo[X], y = box.lo[Y];
    around.lo[X] = std::min(around.lo[X], std::max(x, x + (row[FIRST] - 1) * cell));
    around.hi[X] = std::max(around.hi[X], std::min(box.hi[X], x + (row[END] + 1) * cell));
    around.lo[Y] = std::min(around.lo[Y], std::max(y, y + (j - 1) * cell));
    around.hi[Y] = std::max(around.hi[Y], std::min(box.hi[Y], y + (j + 2) * cell));
  }
  return volume;
}

/* ---------------------------------------------------------------------- */

double Slope::body_volume(const PlanBox &all, const PlanBox &likely,
                          const std::function<double(double x, double y)> &length,
                          const ColumnRanks &ranks)
{
  PlanBox box = all;
  double found = -1.0, filled;
  for (double most = FIRST_CELLS; most <= MOST_CELLS; most *= FINER) {
    if (!(box.lo[X] < box.hi[X] && box.lo[Y] < box.hi[Y])) return 0.0;
    PlanBox around = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    const double before = found;
    found = volume_in_cells(box, static_cast<int>(most), length, ranks, filled, around);
    if (filled >= ENOUGH_FILLED && std::fabs(found - before) <= SAME * found) return found;
    if (found == 0.0 && (before == 0.0 || !(likely.lo[X] <= likely.hi[X]))) return 0.0;
    for (int d = X; d <= Y; d++) {
      const double beyond = found > 0.0 ? 0.0 : likely.hi[d] - likely.lo[d];
      around.lo[d] = std::min(around.lo[d], likely.lo[d] - beyond);
      around.hi[d] = std::max(around.hi[d], likely.hi[d] + beyond);
      box.lo[d] = std::max(all.lo[d], around.lo[d]);
      box.hi[d] = std::min(all.hi[d], around.hi[d]);
    }
  }
  char text[120];
  snprintf(text, sizeof(text),
           "its volume must be a number to 1e-3, got %.6g in the finest columns", found);
  throw std::runtime_error(text);
}

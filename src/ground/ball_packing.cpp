// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_packing.h"

#include "constants.h"
#include "packing_tile.h"

#include <algorithm>
#include <cmath>
#include <random>

using namespace Slope;

/* ----------------------------------------------------------------------
   A direction at random is a point at random on the unit sphere of quaternions (Shoemake 1992), here
   one in its ball, taken by rejection. Only operations that every processor rounds alike.
------------------------------------------------------------------------- */

BallPacking::BallPacking(double diameter_in, uint64_t seed) :
    diameter(diameter_in), side(diameter_in * std::cbrt(PACKING_BALLS * PI / 6.0 / SOLID_FRACTION))
{
  std::mt19937_64 engine(seed);
  const auto uniform = [&engine]() {
    return (engine() >> 11) / 9007199254740992.0;    // 2^53
  };
  double q[4], norm2;
  do {
    norm2 = 0.0;
    for (double &c : q) {
      c = 2.0 * uniform() - 1.0;
      norm2 += c * c;
    }
  } while (norm2 > 1.0 || norm2 < 1.0e-3);
  for (double &c : q) c /= std::sqrt(norm2);

  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  for (int d = 0; d < 3; d++) {
    origin[d] = uniform();
    reach[d] = 0.0;
    for (int e = 0; e < 3; e++) {
      turn[d][e] = rows[d][e];
      reach[d] += 0.5 * side * std::fabs(rows[d][e]);
    }
  }
}

double BallPacking::expected(double volume) const
{
  return volume * SOLID_FRACTION / (PI / 6.0 * diameter * diameter * diameter);
}

void BallPacking::place(const double in_sides[3], double x[3]) const
{
  for (int d = 0; d < 3; d++)
    x[d] = side * (turn[d][0] * in_sides[0] + turn[d][1] * in_sides[1] + turn[d][2] * in_sides[2]);
}

/* ----------------------------------------------------------------------
   tiles that may have a part in a box: along each axis of the tile, those between its corners
------------------------------------------------------------------------- */

void BallPacking::cells(const double lo[3], const double hi[3], int64_t first[3],
                        int64_t last[3]) const
{
  for (int e = 0; e < 3; e++) {
    double least = -origin[e], most = least;
    for (int d = 0; d < 3; d++) {
      const double a = turn[d][e] * lo[d] / side, b = turn[d][e] * hi[d] / side;
      least += std::min(a, b);
      most += std::max(a, b);
    }
    // one more: rounding
    first[e] = static_cast<int64_t>(std::floor(least)) - 1;
    last[e] = static_cast<int64_t>(std::floor(most)) + 1;
  }
}

void BallPacking::visit(const double lo[3], const double hi[3],
                        const std::function<void(const double *)> &take) const
{
  int64_t first[3], last[3], cell[3];
  cells(lo, hi, first, last);
  for (cell[2] = first[2]; cell[2] <= last[2]; cell[2]++)
    for (cell[1] = first[1]; cell[1] <= last[1]; cell[1]++)
      for (cell[0] = first[0]; cell[0] <= last[0]; cell[0]++) {
        const double middle[3] = {cell[0] + origin[0] + 0.5, cell[1] + origin[1] + 0.5,
                                  cell[2] + origin[2] + 0.5};
        double x[3];
        place(middle, x);
        bool near = true;
        for (int d = 0; d < 3; d++)
          near = near && x[d] + reach[d] >= lo[d] - diameter && x[d] - reach[d] <= hi[d] + diameter;
        if (near) visit_cell(cell, lo, hi, take);
      }
}

void BallPacking::visit_cell(const int64_t cell[3], const double lo[3], const double hi[3],
                             const std::function<void(const double *)> &take) const
{
  for (const int(&ball)[3] : PACKING_TILE) {
    double in_sides[3], x[3];
    for (int e = 0; e < 3; e++) in_sides[e] = cell[e] + (origin[e] + ball[e] / PACKING_UNITS);
    place(in_sides, x);
    if (x[0] >= lo[0] && x[0] <= hi[0] && x[1] >= lo[1] && x[1] <= hi[1] && x[2] >= lo[2] &&
        x[2] <= hi[2])
      take(x);
  }
}

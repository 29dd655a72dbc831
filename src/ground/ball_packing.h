// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A disordered packing of equal balls that fills all of space: the periodic one of packing_tile.h, turned
   and shifted as a whole, so that no two balls touch. */

#ifndef SLOPE_BALL_PACKING_H
#define SLOPE_BALL_PACKING_H

#include <cstdint>
#include <functional>

namespace Slope {

class BallPacking {
 public:
  // diameter of the balls, > 0; each seed has a direction and a place of its own, all equally likely
  BallPacking(double diameter, uint64_t seed);

  // how many centres are in a box of that volume, on average
  double expected(double volume) const;

  // visits the centres in the box lo to hi, its faces included; those of two boxes that overlap are the
  // same to the last digit
  void visit(const double lo[3], const double hi[3],
             const std::function<void(const double *)> &take) const;

 private:
  double diameter, side;           // of a ball; of the tile
  double turn[3][3], origin[3];    // a column for each axis of the tile; of its corner, in sides
  double reach[3];                 // half the extent of a turned tile along x, y, z

  void place(const double in_sides[3], double x[3]) const;
  void cells(const double lo[3], const double hi[3], int64_t first[3], int64_t last[3]) const;
  void visit_cell(const int64_t cell[3], const double lo[3], const double hi[3],
                  const std::function<void(const double *)> &take) const;
};

}    // namespace Slope

#endif

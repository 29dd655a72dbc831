// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CONSTANTS_H
#define SLOPE_CONSTANTS_H

namespace Slope {

static constexpr double PI = 3.14159265358979323846;
static constexpr double DEGREE = PI / 180.0;    // rad
static constexpr double GRAVITY = 9.80665;      // m/s2, standard
static constexpr double SIMPLE_CUBIC =
    6.0 / PI;    // bulk volume / volume of a ball, on this lattice

static constexpr double GOLDEN =
    0.6180339887498949;    // what is beyond whole numbers in its multiples repeats no grid
static constexpr double MOST_COUNTED = 2147483647.0;    // with int
static constexpr double FARTHEST =
    1.0e12;    // coordinates beyond it are mistakes: closer than 1e-4 would be one place

}    // namespace Slope

#endif

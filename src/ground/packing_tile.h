// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_PACKING_TILE_H
#define SLOPE_PACKING_TILE_H

namespace Slope {

// Centres of equal balls in a periodic cube, which they fill to a solid fraction of SOLID_FRACTION without
// order and without a contact; in millionths of the cube's side.
static constexpr double SOLID_FRACTION = 0.60;
static constexpr int PACKING_BALLS = 3000;
static constexpr double PACKING_UNITS = 1000000.0;
extern const int PACKING_TILE[PACKING_BALLS][3];

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Balls that fix pour and fix deposit will add: what is said at the start of a run must hold for them, too. */

#ifndef SLOPE_INSERTED_BALLS_H
#define SLOPE_INSERTED_BALLS_H

#include <vector>

namespace LAMMPS_NS {
class LAMMPS;

// kinds of balls; lightest and heaviest of each, kg, 0: unknown; radii, m
struct InsertedBalls {
  int type, mask;    // as balls have them
  double mass_min, mass_max, radius_min, radius_max;
};

std::vector<InsertedBalls> inserted_balls(LAMMPS *);

}    // namespace LAMMPS_NS

#endif

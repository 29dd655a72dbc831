/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Balls that fix pour and fix deposit will add: what is said at the start of a run must hold for them, too. */

#ifndef SLOPE_INSERTED_BALLS_H
#define SLOPE_INSERTED_BALLS_H

#include "lmptype.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;

// kinds of balls; lightest and heaviest of each, kg, 0: unknown; radii, m
struct InsertedBalls {
  int type, mask;    // as balls have them
  double mass_min, mass_max, radius_min, radius_max;
};

std::vector<InsertedBalls> inserted_balls(LAMMPS *);

// A group has the balls that were there when it was defined. If it has none, and no fix pour or fix deposit will give it one:
// the number of balls that it seems to be meant for, of those that move; else 0. Collective.
bigint balls_beside_empty(LAMMPS *, int groupbit, const std::function<bool(int)> &meant);

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_EMPTY_GROUP_H
#define SLOPE_EMPTY_GROUP_H

#include "lmptype.h"

#include <functional>

namespace LAMMPS_NS {
class LAMMPS;

// A group has the balls that were there when it was defined. If it has none, and no fix pour or fix deposit will give it one:
// the number of balls that it seems to be meant for, of those that move; else 0. Collective.
bigint balls_beside_empty(LAMMPS *, int groupbit, const std::function<bool(int)> &meant);

}    // namespace LAMMPS_NS

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_VECTOR3_H
#define SLOPE_VECTOR3_H

#include "instruction_set.h"

namespace Slope {

// as LAMMPS stores it: three numbers that follow one another
struct Vector {
  double x, y, z;
};

SLOPE_INLINE double dot(const Vector &a, const Vector &b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
SLOPE_INLINE Vector cross(const Vector &a, const Vector &b)
{
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}    // namespace Slope

#endif

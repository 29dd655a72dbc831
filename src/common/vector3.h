// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_VECTOR3_H
#define SLOPE_VECTOR3_H

namespace Slope {

// as LAMMPS stores it: three numbers that follow one another
struct Vector {
  double x, y, z;
};

}    // namespace Slope

#endif

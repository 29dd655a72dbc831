/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_REGION_MARKS_H
#define SLOPE_REGION_MARKS_H

#include <vector>

namespace LAMMPS_NS {
class Region;

// Numbers that tell a region from one that has its ID, and maybe its address, after it: those of its shape, or, where a style
// keeps these to itself, its box and what of many places in it is inside.
std::vector<double> region_marks(Region *);

}    // namespace LAMMPS_NS

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SURFACE_CONTACT_H
#define SLOPE_SURFACE_CONTACT_H

#include "touched_surface.h"

namespace Slope {

// A contact of a ball with a surface
struct SurfaceContact {
  SurfacePoint at;
  double overlap;    // that gives its force, m
  double spring;     // compression of its spring in the energy, m
  bool joined;       // of several points of one surface
};

}    // namespace Slope

#endif

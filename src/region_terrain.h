/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef REGION_CLASS
// clang-format off
RegionStyle(terrain,RegTerrain);
// clang-format on
#else

#ifndef LMP_REGION_TERRAIN_H
#define LMP_REGION_TERRAIN_H

#include "region.h"

#include "elevation_grid.h"

namespace LAMMPS_NS {

class RegTerrain : public Region {
 public:
  RegTerrain(class LAMMPS *, int, char **);
  int inside(double, double, double) override;
  int surface_interior(double *, double) override;
  int surface_exterior(double *, double) override;

  // the raster that the ground surface is interpolated from
  const Slope::ElevationGrid &grid() const { return elevation; }

 private:
  Slope::ElevationGrid elevation;
  double bottom;    // the region ends here

  void read(const char *);
  int no_contacts();
};

}    // namespace LAMMPS_NS

#endif
#endif

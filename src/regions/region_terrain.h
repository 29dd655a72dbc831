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

#include "file_region.h"

#include "elevation_grid.h"

#include <memory>

namespace LAMMPS_NS {

class RegTerrain : public FileRegion {
 public:
  RegTerrain(class LAMMPS *, int, char **);
  ~RegTerrain() override;
  int inside(double, double, double) override;

  // the raster that the ground surface is interpolated from
  const Slope::ElevationGrid &grid() const { return elevation; }

 private:
  Slope::ElevationGrid elevation;
  std::unique_ptr<class NodeArray> heights;    // one copy for the ranks of a node
  double zmin, zmax, bottom;                   // the region ends at the bottom
  int nodata;

  void read(const char *);
};

}    // namespace LAMMPS_NS

#endif
#endif

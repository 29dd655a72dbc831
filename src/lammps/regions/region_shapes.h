/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_REGION_SHAPES_H
#define SLOPE_REGION_SHAPES_H

#include "elevation_grid.h"

namespace LAMMPS_NS {

// What a region style is beside a region, for those who know it as a Region only: a dynamic_cast of
// the region to one of these finds out.

// the ground below a raster
class RasterRegion {
 public:
  // the raster that the ground surface is interpolated from
  virtual const Slope::ElevationGrid &grid() const = 0;

 protected:
  ~RasterRegion() = default;
};

// vertical prism: the same inside at all heights
class PrismRegion {
 public:
  virtual bool covers(double x, double y) const = 0;

 protected:
  ~PrismRegion() = default;
};

}    // namespace LAMMPS_NS

#endif

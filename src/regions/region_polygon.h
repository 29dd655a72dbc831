/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef REGION_CLASS
// clang-format off
RegionStyle(polygon,RegPolygon);
// clang-format on
#else

#ifndef LMP_REGION_POLYGON_H
#define LMP_REGION_POLYGON_H

#include "file_region.h"

#include "polygon.h"

namespace LAMMPS_NS {

class RegPolygon : public FileRegion {
 public:
  RegPolygon(class LAMMPS *, int, char **);
  void init() override;
  // at all heights
  bool covers(double x, double y) const { return polygon.inside(x, y); }
  int inside(double, double, double) override;

 private:
  Slope::Polygon polygon;

  void read(const char *);
};

}    // namespace LAMMPS_NS

#endif
#endif

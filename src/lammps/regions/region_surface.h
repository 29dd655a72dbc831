/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_REGION_SURFACE_H
#define SLOPE_REGION_SURFACE_H

#include "pointers.h"

#include "intervals.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// The lower or upper boundary of any region that stands still, as a height over the plan.
// Columns of known styles are intervals; of others only Region::match() is asked, so intersections
// and unions of whatever regions do.
class RegionSurface : protected Pointers {
 public:
  enum { LOWER, UPPER };

  // A column of an unknown style is searched in steps: a part of the region thinner than the step may
  // be missed. Of a known one parts thinner than a small part of the step count as rounding. step 0: a
  // thousandth of the region's height. Errors start with caller.
  RegionSurface(class LAMMPS *, const std::string &caller, const char *region_id, int side,
                double step = 0.0);
  ~RegionSurface() override;

  // lowest (topmost) point of the region over x,y; false if the region is not there.
  // No communication: any rank may ask for any column.
  bool height(double x, double y, double &z) const;

  // The same, but the boundary is looked for only where it is near the height of a column close by
  // (NaN: anywhere), found to a thousandth of the step. Far sooner, and it may be another part's.
  bool height_near(double x, double y, double near, double &z) const;

  // The lower boundary of what is right below a height, by a walk down from there: false if the region
  // is not there, or thinner than a step.
  bool height_below(double x, double y, double top, double &z) const;

  // whether height() is known for any column of the rectangle: what the constructor asks for, said
  // without an error
  static bool is_fit(const class Region *, int side, double xlo, double xhi, double ylo,
                     double yhi);

  // false if the region is unbounded on this side (INF): no boundary there
  bool has_boundary() const { return bounded; }

  // whether the region, and all that it is made of, is still the one of the constructor; if not, the
  // ID of the first one that is not: nothing may be asked then
  bool stands(std::string &changed) const;

  // bounding box; where the region has no bound, that of the simulation box
  double xlo, xhi, ylo, yhi, zlo, zhi;

 private:
  class Region *region;
  const class RasterRegion *terrain;    // set if its grid is the boundary
  double start, direction, step;        // of the search along z

  struct Part {
    std::string id;
    class Region *region;
    double zlo, zhi;    // of its bounding box
  };
  std::vector<Part> made_of;
  bool bounded;

  std::unique_ptr<class RegionColumns> columns;    // empty: they are searched
  mutable Slope::Intervals parts;                  // keeps its memory

  void note_parts(class Region *);
  bool column(double x, double y) const;
  bool search(double x, double y, double &z) const;
  bool search_near(double x, double y, double near, double &z) const;
  bool search_below(double x, double y, double top, double &z) const;
  bool inside(double x, double y, double walked) const;
  bool between(double x, double y, double out, double in, double precision, double &z) const;
};

}    // namespace LAMMPS_NS

#endif

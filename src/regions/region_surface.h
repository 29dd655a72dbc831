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
class RegionSurface : protected Pointers {
 public:
  enum { LOWER, UPPER };
  static constexpr double UNBOUNDED = 1.0e19;    // LAMMPS writes INF as 1e20
  static constexpr double STEPS = 1000.0;        // of a region's height, where no step is asked for

  // What is far thinner than a step counts as rounding, and the columns of some styles are searched in
  // steps (region_columns.h); 0: STEPS of them. Errors start with caller.
  RegionSurface(class LAMMPS *, const std::string &caller, const char *region_id, int side,
                double step = 0.0);
  ~RegionSurface() override;

  // lowest (topmost) point of the region over x,y; false if the region is not there.
  // No communication: any rank may ask for any column.
  bool height(double x, double y, double &z) const;

  // The same, but only where the boundary is near the height of a column close by (NaN: anywhere): it
  // may be another part's.
  bool height_near(double x, double y, double near, double &z) const;

  // The lower boundary of what is right below a height: false if the region is not there.
  bool height_below(double x, double y, double top, double &z) const;

  // whether height() is that of a raster, and takes no search
  bool is_raster() const { return terrain != nullptr; }

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
  const class RegTerrain *terrain;    // set if its grid is the boundary
  bool lower;
  double step;

  struct Part {
    std::string id;
    class Region *region;
    std::vector<double> marks;
  };
  std::vector<Part> made_of;
  bool bounded;

  std::unique_ptr<class RegionColumns> columns;    // empty: a terrain's
  mutable Slope::Intervals parts;                  // keeps its memory

  void note_parts(class Region *);
  bool column(double x, double y) const;
};

}    // namespace LAMMPS_NS

#endif

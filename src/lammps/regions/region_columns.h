/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_REGION_COLUMNS_H
#define SLOPE_REGION_COLUMNS_H

#include "intervals.h"

#include <memory>

namespace LAMMPS_NS {
class LAMMPS;
class Region;

// What a region that stands still takes of the vertical line at x,y, exactly: terrain, polygon,
// sphere, block, plane, cylinder, and any intersection and union of these, side in or out.
class RegionColumns {
 public:
  // nullptr for a region with any other style in it, or if a region of a known style does not
  // contain the points that it should: then its columns have to be searched
  static std::unique_ptr<RegionColumns> of(LAMMPS *, Region *);
  virtual ~RegionColumns() = default;

  void column(double x, double y, Slope::Intervals &found) const;

 protected:
  bool side_in = true, everything = false;

  // with side in
  virtual void inside(double x, double y, Slope::Intervals &found) const = 0;
  virtual int cost() const { return 0; }    // the order of an intersection's parts

 private:
  static std::unique_ptr<RegionColumns> make(LAMMPS *, Region *);
  static std::unique_ptr<RegionColumns> make_shape(LAMMPS *, Region *);
  static bool agrees(const RegionColumns &, Region *);
  friend class CombinedColumns;
};

}    // namespace LAMMPS_NS

#endif

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

// What a region that stands still takes of the vertical line at x,y: of terrain, polygon, sphere, block,
// plane and cylinder exactly, of any other style by a search, and of any intersection and union of
// these, side in or out.
class RegionColumns {
 public:
  // where a search looks, and how far its steps are: it may miss what is thinner
  struct Search {
    double zlo, zhi, step;
  };
  static std::unique_ptr<RegionColumns> of(LAMMPS *, Region *, const Search &);
  virtual ~RegionColumns() = default;

  void column(double x, double y, Slope::Intervals &found) const;

 protected:
  explicit RegionColumns(int rank) : cost(rank) {}
  bool side_in = true, everything = false;
  const int cost;    // the order of an intersection's parts

  // with side in
  virtual void inside(double x, double y, Slope::Intervals &found) const = 0;

 private:
  static std::unique_ptr<RegionColumns> make_shape(LAMMPS *, Region *, const Search &);
  friend class CombinedColumns;
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SUNK_REGION_H
#define SLOPE_SUNK_REGION_H

#include "pointers.h"
#include "region_surface.h"

#include <memory>
#include <string>
#include <vector>

namespace Slope {
class SunkSurface;
}

namespace LAMMPS_NS {

// The boundary of a region sunk along its normal, doc/src/surface_sampling.rst. The lower boundary is
// that of a body: it continues beyond the body's rim, up to the ground, which is the region whose upper
// boundary is that of the body, too, the widest of these in plan.
class SunkRegion : protected Pointers {
 public:
  // diameter: of the balls, which tells how closely the boundary is looked at. All ranks; errors end
  // the run and start with caller.
  SunkRegion(class LAMMPS *, const std::string &caller, const std::string &region, int side,
             double sink, double diameter);
  ~SunkRegion() override;

  const std::string region;
  const int side;
  const double sink, diameter;
  std::string ground;    // ID, empty: none

  // Look at the boundary, once; may throw. Needs the region; the others need this.
  void build();
  void plan(double &xlo, double &xhi, double &ylo, double &yhi) const;    // of height()
  bool height(double x, double y, double &z) const;    // of ball centres, below the ground only
  bool centre(double x, double y, double &z) const;    // of a body: above it, too

  double lowest() const;    // of the centres, about
  double floor() const;     // what they must lie above

  // whether the regions are those of the constructor; if not, which one is not
  bool stands(std::string &changed) const;

  // whether all of the body lies in columns of another region
  bool lies_in(const RegionSurface &columns) const;

 private:
  std::unique_ptr<RegionSurface> boundary, top;    // top: of the ground
  std::unique_ptr<Slope::SunkSurface> surface;
  std::vector<double> columns;    // x y of some of the body's columns
  bool flush;                     // all of them end at the ground

  void find_columns();
  void find_ground(const std::string &caller);
};

}    // namespace LAMMPS_NS

#endif

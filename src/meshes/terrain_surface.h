/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_TERRAIN_SURFACE_H
#define SLOPE_TERRAIN_SURFACE_H

#include "elevation_grid.h"
#include "touched_surface.h"

#include <string>
#include <vector>

namespace Slope {

// The ground of an elevation grid as triangles, which are made when they are asked for. Their corners
// are the centres of the cells, and, where the plane is extended to the raster's edge, the points there;
// between four of them are two triangles, divided by the diagonal whose ends differ less in height.
// None has a corner without a value.
class TerrainSurface : public TouchedSurface {
 public:
  // std::runtime_error if there is no triangle
  TerrainSurface(const ElevationGrid &grid, const std::string &name);

  void find_near(const Vector &x, double reach, std::vector<int> &numbers) const override;
  Triangle triangle(int number) const override;
  int count() const override { return 2 * (nx - 1) * (ny - 1); }
  bool sparse() const override { return true; }
  const Vector &low() const override { return lowest; }
  const Vector &high() const override { return highest; }
  double checksum() const override { return sum; }
  double memory_usage() const override
  {
    return static_cast<double>(z.capacity()) * sizeof(double);
  }

  int holes() const { return missing; }    // quadrangles without triangles

 private:
  int nx, ny;    // corners
  double xlo, ylo, xhi, yhi, cell;
  std::vector<double> z;
  Vector lowest, highest;
  double sum;
  int missing;

  Vector corner(int i, int j) const;
  static double place(int i, int n, double lo, double hi, double cell);
  static int index_of(double x, int n, double lo, double cell);
  bool quadrangle(int i, int j, double &zmin, double &zmax) const;
};

}    // namespace Slope

#endif

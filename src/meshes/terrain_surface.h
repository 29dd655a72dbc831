// No LAMMPS
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
  // All but the heights of the corners; plain numbers, which can be sent.
  struct About {
    int nx, ny;    // corners
    double xlo, ylo, xhi, yhi, cell;
    Vector lowest, highest;
    double sum;
    int missing;    // quadrangles without triangles
  };

  // std::runtime_error if there is no triangle
  TerrainSurface(const ElevationGrid &grid, const std::string &name);

  // of heights that the caller keeps as long as this exists
  TerrainSurface(const About &about_in, const double *heights) : about_(about_in), z(heights) {}
  TerrainSurface(const TerrainSurface &) = delete;
  TerrainSurface &operator=(const TerrainSurface &) = delete;

  const About &about() const { return about_; }
  const double *heights() const { return z; }    // of the corners, row by row from the south

  void find_near(const Vector &x, double reach, std::vector<int> &numbers) const override;
  Triangle triangle(int number) const override;
  int count() const override { return 2 * (about_.nx - 1) * (about_.ny - 1); }
  bool sparse() const override { return true; }
  const Vector &low() const override { return about_.lowest; }
  const Vector &high() const override { return about_.highest; }
  double checksum() const override { return about_.sum; }
  double memory_usage() const override
  {
    return static_cast<double>(own.capacity()) * sizeof(double);
  }

 private:
  About about_;
  std::vector<double> own;
  const double *z;

  void fill(const ElevationGrid &);
  void measure();
  Vector corner(int i, int j) const;
  static double place(int i, int n, double lo, double hi, double cell);
  static int index_of(double x, int n, double lo, double cell);
  bool quadrangle(int i, int j, double &zmin, double &zmax) const;
};

}    // namespace Slope

#endif

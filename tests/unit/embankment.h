/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Terrains for tests of slip surfaces. The two embankments are those of Scoops3D's examples (USGS, public domain):
   after Donald and Giam 1989 and after Arai and Tagyo 1985. */

#ifndef SLOPE_TEST_EMBANKMENT_H
#define SLOPE_TEST_EMBANKMENT_H

#include "elevation_grid.h"
#include "slip_factor.h"

#include <algorithm>
#include <cmath>

namespace embankment {

// rises by step per cell of 0.5 m, from cell first on
inline Slope::ElevationGrid extruded(int nx, int ny, double low, int first, double step, int steps)
{
  Slope::ElevationGrid grid(nx, ny, 0.0, 0.0, 0.5, low);
  for (int j = 0; j < ny; j++)
    for (int i = 0; i < nx; i++) grid.at(i, j) = low + step * std::min(std::max(i - first, 0), steps);
  return grid;
}

inline Slope::ElevationGrid of_10_m(int ny = 101) { return extruded(102, ny, 25.0, 20, 0.25, 40); }
inline Slope::ElevationGrid of_20_m(int ny = 133) { return extruded(133, ny, 15.0, 36, 1.0 / 3.0, 60); }

// c (kPa), phi (degrees), unit weight (kN/m3)
inline Slope::SlipSoil::Strength strength(double c, double phi, double weight)
{
  return {1000.0 * c, std::tan(phi * Slope::PI / 180.0), 1000.0 * weight / Slope::GRAVITY};
}

inline Slope::SlipSoil::Strength strength_10_m() { return strength(3.0, 19.6, 20.0); }
inline Slope::SlipSoil::Strength strength_20_m() { return strength(41.65, 15.0, 18.82); }

// the critical spheres of Scoops3D's searches
inline Slope::SlipSurface sphere_10_m() { return {10.25, 25.25, 54.0, 28.9617, Slope::PI}; }
inline Slope::SlipSurface sphere_20_m() { return {25.75, 33.25, 49.0, 36.6347, Slope::PI}; }

// rises towards +x by a dip (radians); height 0 in the middle
inline Slope::ElevationGrid plane(int n, double cell, double dip)
{
  Slope::ElevationGrid grid(n, n, -0.5 * n * cell, -0.5 * n * cell, cell, 0.0);
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) grid.at(i, j) = (grid.xlo + (i + 0.5) * cell) * std::tan(dip);
  return grid;
}

// whose part below that plane is a cap of this half angle
inline Slope::SlipSurface cap(double radius, double half_angle, double dip)
{
  const double up = radius * std::cos(half_angle);
  return {-up * std::sin(dip), 0.0, up * std::cos(dip), radius, Slope::PI};
}

}    // namespace embankment

#endif

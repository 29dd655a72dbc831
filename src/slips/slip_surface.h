// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_SURFACE_H
#define SLOPE_SLIP_SURFACE_H

#include <cmath>

namespace Slope {

// The lower half of a sphere, of an ellipsoid, or of a cylinder with spherical ends. u is the
// horizontal distance from the centre against the direction of sliding, v the one to the left of u:
// (u/A)^2 + (v'/B)^2 + (z - z_centre)^2 = R^2 with v' = v beyond the straight part. The axis of
// moments is the horizontal line along v through the centre.
struct SlipSurface {
  double x, y, z, radius;    // centre; radius: vertical semi-axis, m
  double direction;          // of sliding, radians counterclockwise from +x
  double along = 1.0;        // A: horizontal semi-axis in the direction of sliding / radius
  double across = 1.0;       // B: the other one / radius
  double straight = 0.0;     // length of the straight part, along v, m

  SlipSurface() : x(0.0), y(0.0), z(0.0), radius(1.0), direction(0.0) {}
  SlipSurface(double _x, double _y, double _z, double _radius, double _direction = 0.0) :
      x(_x), y(_y), z(_z), radius(_radius), direction(_direction)
  {
  }

  // the same for all directions of sliding
  bool round() const { return along == across && straight == 0.0; }

  // half extents of the bounding box of the plan
  double half_x() const { return half(std::cos(direction), std::sin(direction)); }
  double half_y() const { return half(std::sin(direction), std::cos(direction)); }

  // distance across from the straight part, with sign
  double beyond(double v) const
  {
    const double h = 0.5 * straight;
    return v > h ? v - h : v < -h ? v + h : 0.0;
  }

 private:
  double half(double c, double s) const
  {
    return radius * std::hypot(along * c, across * s) + 0.5 * straight * std::fabs(s);
  }
};

}    // namespace Slope

#endif

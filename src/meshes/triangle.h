// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A triangle and the point of it that is nearest to another point. No LAMMPS. */

#ifndef SLOPE_TRIANGLE_H
#define SLOPE_TRIANGLE_H

#include "vector3.h"

#include <algorithm>
#include <cmath>

namespace Slope {

inline Vector minus(const Vector &a, const Vector &b)
{
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline double size_of(const Vector &a)
{
  return std::sqrt(dot(a, a));
}
inline Vector moved(const Vector &a, double s, const Vector &way)    // a + s way
{
  return {a.x + s * way.x, a.y + s * way.y, a.z + s * way.z};
}

struct Triangle {
  Vector a, b, c;

  Vector twice_area() const { return cross(minus(b, a), minus(c, a)); }    // along the normal
  double area() const { return 0.5 * size_of(twice_area()); }
  Vector middle() const
  {
    return {(a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0, (a.z + b.z + c.z) / 3.0};
  }
  double longest_side() const
  {
    return std::max({size_of(minus(b, a)), size_of(minus(c, b)), size_of(minus(a, c))});
  }
};

// A point of a surface, and how another point x sees it: distance (m), unit normal from it to x
struct SurfacePoint {
  enum Feature { CORNER, SIDE, FACE };

  Vector point, normal;
  double distance;
  int triangle;
  Feature on;
  Vector side;    // along it, of any length, if the point is on one
};

// The point of a triangle that is nearest to x, by the region of the triangle's plane over which x
// lies: a corner's, a side's, its own (Ericson 2005, Real-time collision detection, 5.1.5). The
// triangle has an area. Where x lies in the triangle the normal is that of (b - a) x (c - a).
inline SurfacePoint nearest_point(const Triangle &t, int number, const Vector &x)
{
  const Vector ab = minus(t.b, t.a), ac = minus(t.c, t.a);
  const Vector ax = minus(x, t.a), bx = minus(x, t.b), cx = minus(x, t.c);
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  const double d3 = dot(ab, bx), d4 = dot(ac, bx);
  const double d5 = dot(ab, cx), d6 = dot(ac, cx);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;

  SurfacePoint p = {};
  p.triangle = number;
  const Vector across = cross(ab, ac);
  const Vector up = moved({0.0, 0.0, 0.0}, 1.0 / size_of(across), across);
  auto on_side = [&p](const Vector &from, double share, const Vector &side) {
    p.on = SurfacePoint::SIDE;
    p.side = side;
    p.point = moved(from, share, side);
  };
  p.on = SurfacePoint::CORNER;
  if (d1 <= 0.0 && d2 <= 0.0)
    p.point = t.a;
  else if (d3 >= 0.0 && d4 <= d3)
    p.point = t.b;
  else if (d6 >= 0.0 && d5 <= d6)
    p.point = t.c;
  else if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
    on_side(t.a, d1 / (d1 - d3), ab);
  else if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
    on_side(t.a, d2 / (d2 - d6), ac);
  else if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    on_side(t.b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(t.c, t.b));
  else {    // the plane itself: its normal has no rounding of the distance
    p.on = SurfacePoint::FACE;
    const double height = dot(ax, up);
    p.distance = std::fabs(height);
    p.normal = height < 0.0 ? Vector{-up.x, -up.y, -up.z} : up;
    p.point = moved(x, -height, up);
    return p;
  }
  const Vector way = minus(x, p.point);
  p.distance = size_of(way);
  p.normal = p.distance > 0.0 ? moved({0.0, 0.0, 0.0}, 1.0 / p.distance, way) : up;
  return p;
}

}    // namespace Slope

#endif

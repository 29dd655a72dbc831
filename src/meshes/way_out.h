// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The shortest way out of several faces of one surface. No LAMMPS. Derivation: doc/src/theory.rst,
   Surfaces of triangles. */

#ifndef SLOPE_WAY_OUT_H
#define SLOPE_WAY_OUT_H

#include "triangle.h"

#include <cmath>
#include <vector>

namespace Slope {

// a face that a ball overlaps: unit normal, and by how much
struct OverlappedFace {
  Vector normal;
  double depth;
};

// The shortest u with u.normal >= depth for all faces: that of the ball to a place where it overlaps none.
// It is the sum of at most three of the normals, each times a number >= 0 (the projection on a convex
// body). It starts from the deepest face, and where a face is left it takes the shortest way out of that
// and those that decided so far, which is longer each time; so it ends.
class WayOut {
 public:
  static Vector of(const std::vector<OverlappedFace> &faces, double radius)
  {
    WayOut way(faces, TOLERANCE * radius);
    for (int round = 0; round < MOST_ROUNDS; round++) {
      int left = -1;
      double most = way.tolerance;
      for (size_t k = 0; k < faces.size(); k++) {
        const double depth = faces[k].depth - dot(way.u, faces[k].normal);
        if (!(depth > most)) continue;
        most = depth;
        left = static_cast<int>(k);
      }
      if (left < 0 || !way.include(left)) break;
    }
    return way.u;
  }

 private:
  static constexpr double TOLERANCE = 1.0e-10;    // of the radius
  static constexpr double PARALLEL = 1.0e-13;     // least determinant
  static constexpr int MOST_ROUNDS = 50;

  const std::vector<OverlappedFace> &faces;
  double tolerance;
  Vector u;
  std::vector<int> deciding;    // up to three

  WayOut(const std::vector<OverlappedFace> &list, double overlap) :
      faces(list), tolerance(overlap), u{0.0, 0.0, 0.0}
  {
  }

  // of the faces that decide and another one: the shortest way, by trying which of them decide
  bool include(int k)
  {
    const std::vector<int> old = deciding;
    const size_t n = old.size();
    if (accept({k}, old)) return true;
    for (size_t a = 0; a < n; a++)
      if (accept({k, old[a]}, old)) return true;
    for (size_t a = 0; a < n; a++)
      for (size_t b = a + 1; b < n; b++)
        if (accept({k, old[a], old[b]}, old)) return true;
    return false;
  }

  // the way that just leaves the faces of a list, if it is pushed by each of them and leaves the others
  bool accept(const std::vector<int> &list, const std::vector<int> &others)
  {
    const OverlappedFace &p = faces[list[0]];
    Vector way = moved({0.0, 0.0, 0.0}, p.depth, p.normal);
    if (list.size() > 1) {
      const OverlappedFace &q = faces[list[1]];
      OverlappedFace r = {cross(p.normal, q.normal), 0.0};    // two: in the plane of their normals
      if (list.size() > 2) r = faces[list[2]];
      const Vector across[3] = {cross(q.normal, r.normal), cross(r.normal, p.normal),
                                cross(p.normal, q.normal)};
      const double volume = dot(p.normal, across[0]);
      if (!(std::fabs(volume) > PARALLEL)) return false;
      way = moved(
          moved(moved({0.0, 0.0, 0.0}, p.depth / volume, across[0]), q.depth / volume, across[1]),
          r.depth / volume, across[2]);
      for (size_t m = 0; m < list.size(); m++)
        if (dot(way, across[m]) / volume < 0.0) return false;
    }
    for (const int k : others)
      if (faces[k].depth - dot(way, faces[k].normal) > tolerance) return false;
    u = way;
    deciding = list;
    return true;
  }
};

}    // namespace Slope

#endif

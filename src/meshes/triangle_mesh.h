// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_TRIANGLE_MESH_H
#define SLOPE_TRIANGLE_MESH_H

#include "touched_surface.h"

#include <vector>

namespace Slope {

// Triangles in a tree of boxes: what is near a point is found in the logarithm of their number. They
// need not be connected, and neither order nor direction matters.
class TriangleMesh : public TouchedSurface {
 public:
  explicit TriangleMesh(
      const std::vector<Triangle> &triangles);    // at least one, each with an area

  void find_near(const Vector &x, double reach, std::vector<int> &numbers) const override;
  Triangle triangle(int number) const override { return triangles[number]; }
  int count() const override { return static_cast<int>(triangles.size()); }
  bool sparse() const override { return false; }
  const Vector &low() const override { return boxes[0].low; }
  const Vector &high() const override { return boxes[0].high; }
  bool closed() const override;                     // each edge is that of two triangles
  bool encloses(const Vector &x) const override;    // in a time as that of find_near()
  double checksum() const override { return sum; }
  double memory_usage() const override;

 private:
  static constexpr int LEAF = 4;    // triangles below which a box is not divided

  struct Box {
    Vector low, high;
    int first, last;    // of order
    int other;          // number of the second half's box; the first one's follows; 0: a leaf
  };

  std::vector<Triangle> triangles;    // in the order of the file
  std::vector<int> order;
  std::vector<Box> boxes;
  double sum;

  int build(const std::vector<Vector> &middles, int first, int last);

  // use(number) for the triangles of all leaves that are not in a box beside what is looked for
  template <class Beside, class Use> void each(Beside beside, Use use) const;
};

}    // namespace Slope

#endif

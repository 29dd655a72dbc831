// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_POLYGON_H
#define SLOPE_POLYGON_H

#include <string>
#include <vector>

namespace Slope {

// An area in plan, bounded by closed rings of straight edges. A point is inside if it is inside an
// odd number of rings, so that a ring in another one is a hole, and a ring in the hole an island.
//
// A point on an edge belongs to the side to the east of it, on a horizontal edge to the north:
// polygons that share an edge share no point and leave none out. This is exact on edges along x
// and y, and elsewhere as good as rounding.
//
// Errors are std::runtime_error with one line: file, line in it, rule, value.
class Polygon {
 public:
  Polygon() : xlo(0.0), xhi(0.0), ylo(0.0), yhi(0.0), scale(0.0) {}

  // rings that read() would take, without any check: x,y of all points, number of points of each
  Polygon(const std::vector<double> &xy, const std::vector<int> &sizes);

  // Read rings: a line "x,y" for each point, a blank line between two rings, # starts a comment.
  // The first point of a ring may be repeated at its end. An error is a ring with fewer than 3
  // points, without area, or whose edges cross or touch each other; and rings that cross. si: whether a head
  // with other units than metres is one, too (number_rows.h).
  static Polygon read(const std::string &path, bool si = true);

  bool inside(double x, double y) const;

  double area() const;    // of the inside

  double xlo, xhi, ylo, yhi;    // bounding box
  std::vector<double> xy;       // x,y of all points, ring after ring, first point not repeated
  std::vector<int> sizes;       // number of points of each ring

 private:
  struct Edge {
    double x0, y0, x1, y1;    // y0 < y1
    double xmax() const { return x0 > x1 ? x0 : x1; }
    double xat(double y) const { return x0 + (x1 - x0) * ((y - y0) / (y1 - y0)); }
  };
  std::vector<Edge> edges;

  // The bounding box is cut into strips along x: only the edges in its strip may be east of a point
  double scale;    // strips per height
  std::vector<int> first,
      members;    // of strip k: members first[k] to first[k+1], by xmax, from the east

  int strip(double y) const;
  void cut_into_strips();
};

}    // namespace Slope

#endif

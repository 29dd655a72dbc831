// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_PLAN_LINE_H
#define SLOPE_PLAN_LINE_H

#include <string>
#include <vector>

namespace Slope {

// A line of straight pieces in plan, open or closed, and what crosses the vertical plane over it. Forward is
// from the left-hand side of the line, seen from its first to its last point, to the right-hand
// side. A place on the line itself belongs to the side to the east of it, on a line along x to the
// north. So a path that is cut into pieces crosses as often as the whole one, and one through a
// corner crosses once.
class PlanLine {
 public:
  struct Crossing {
    double passed;    // of the path, 0 to 1
    double along;     // distance from the first point, along the line
    double x, y;
    int direction;    // 1: forward, -1: back
  };

  PlanLine() : xlo(0.0), xhi(0.0), ylo(0.0), yhi(0.0) {}
  explicit PlanLine(const std::vector<double> &xy);    // x,y of all points, as read() takes them

  // Read lines "x y" or "x,y", # starts a comment: at least two points, none like the one before, no empty
  // line between two. si: a head must have metres (number_rows.h).
  // Errors are std::runtime_error with one line: file, line in it, rule, value.
  static PlanLine read(const std::string &path, bool si = true);

  // Crossings of a straight path are appended, first ones first.
  void cross(const double *from, const double *to, std::vector<Crossing> &found) const;

  // Whether any of it lies within reach of a place.
  bool is_near(const double *place, double reach) const;

  double length() const { return start.empty() ? 0.0 : start.back(); }
  double checksum() const;    // other points, or another order, have another
  double largest() const;     // of its coordinates, whatever their signs

  std::vector<double> xy;
  double xlo, xhi, ylo, yhi;    // bounding box

 private:
  std::vector<double> start;    // distance of each point along the line

  bool is_near(const double *place, double reach, size_t first, size_t last) const;
};

}    // namespace Slope

#endif

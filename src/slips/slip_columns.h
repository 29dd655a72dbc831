// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_COLUMNS_H
#define SLOPE_SLIP_COLUMNS_H

#include "elevation_grid.h"
#include "slip_soil.h"

#include <cmath>
#include <vector>

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

  // dz/dx and dz/dy at a place in plan from the centre, where the surface is so deep below it
  struct Slope {
    double x, y;
  };
  Slope slope(double dx, double dy, double depth) const
  {
    const double c = std::cos(direction), s = std::sin(direction);
    const double rise = -(dx * c + dy * s) / (along * along * depth);
    const double rise_across = beyond(dx * s - dy * c) / (across * across * depth);
    return {rise_across * s - rise * c, -rise * s - rise_across * c};
  }

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

// The body above a slip surface, or above the bedrock where that is higher, as vertical columns: the
// largest connected part of where the ground is above this base. Memory is kept from surface to surface.
struct SlipColumns {
  // of each column
  std::vector<double> dx, dy;      // in plan, from the centre of the surface
  std::vector<double> depth;       // of the base below the centre
  std::vector<double> area;        // in plan
  std::vector<double> thick;       // from base to ground
  std::vector<double> weight;      // N
  std::vector<double> arm;         // of the weight's place below the centre
  std::vector<double> cohesion;    // Pa
  std::vector<double> friction;    // tangent
  std::vector<double> pore;        // Pa
  std::vector<double> slope_x;    // dz/dx of the bedrock where it is the base, no number elsewhere;
  std::vector<double> slope_y;    // both are empty if there is no bedrock

  double volume, plan_area, greatest_depth;
  bool at_edge;     // the body reaches the edge of the terrain, or cells without a value
  bool overhang;    // the rim is where the surface is vertical: it would leave a wall
  bool outside;     // a column is in a cell that is not allowed
  bool rocky;       // slope_x and slope_y are there

  size_t size() const { return area.size(); }
  void clear();
  void keep(size_t first, size_t last, size_t to);    // columns, moved to a place before them
  void resize(size_t n);

 private:
  std::vector<std::vector<double> *> arrays();    // those that there are
};

// Makes columns of surfaces below one terrain.
class SlipColumnMaker {
 public:
  // allowed: a flag for each cell of the ground, or empty for all of them; all three must outlive this
  SlipColumnMaker(const ElevationGrid &ground, const SlipSoil &soil,
                  const std::vector<char> &allowed);

  // One column in the middle of each stride-th cell: fast, with a staircase at the rim. False, as
  // below, if there is no body.
  bool coarse(const SlipSurface &, int stride, SlipColumns &);

  // The ground is bilinear between the cells' centres, as region terrain has it: along a line in x it
  // is a polyline, whose intersections with the surface are roots of a quadratic equation, and so is the
  // bedrock. Gauss points between these roots along at least so many lines across the body. No
  // staircase.
  bool exact(const SlipSurface &, SlipColumns &, int lines = 96);

 private:
  const ElevationGrid &ground;
  const SlipSoil &soil;
  const std::vector<char> &allowed;

  struct Run {    // of columns side by side, on a line
    int line;
    size_t parent;         // another run of the same part of the body, or itself
    double lo, hi;         // in x
    size_t first, last;    // columns
    double volume;
    bool unknown;    // no ground there
    bool at_edge, overhang;
  };
  struct Rock {    // the bedrock at a place, no numbers if there is none
    double z, slope_x, slope_y;
  };
  struct Node {    // of the ground along a line
    double x, z;
    double rock, rock_slope_y;

    double ground_at(const Node &q, double at) const { return z + (q.z - z) * share(q, at); }
    Rock rock_at(const Node &q, double at) const
    {
      if (std::isnan(rock)) return {rock, rock, rock};
      return {rock + (q.rock - rock) * share(q, at), (q.rock - rock) / (q.x - x),
              rock_slope_y + (q.rock_slope_y - rock_slope_y) * share(q, at)};
    }

   private:
    double share(const Node &q, double at) const { return (at - x) / (q.x - x); }
  };
  std::vector<Run> runs;
  std::vector<double> cuts;
  std::vector<char> outside;    // of each column

  SlipSurface surface;
  double cosine, sine;
  ElevationGrid rock;    // in the ground's cells
  const bool rocky;

  void begin(const SlipSurface &, SlipColumns &);
  double depth(double dx, double dy) const;
  bool is_above(double zground, double deep, const Rock &) const;
  void add(SlipColumns &, double dx, double dy, double deep, const Rock &, double zground,
           double area);
  Run &run_from(int line, double lo, const SlipColumns &);

  void coarse_row(SlipColumns &, int j, int stride);

  Rock rock_in_cell(int i, int j) const;
  static double between_rows(const ElevationGrid &, int i, int j, double t);
  Node node(int i, int j, double t) const;
  void row_of(double y, int &j, double &t) const;
  template <typename Work> void along(double y, Work work) const;
  void find_cuts(double y, const Node &, const Node &);
  bool is_cut(double y);
  bool extent_in_y(int lines, double &lo, double &hi);
  void line(SlipColumns &, int number, double y, double width, int parts);
  void piece(SlipColumns &, int number, double y, double width, int parts, const Node &,
             const Node &);

  bool finish(SlipColumns &);
  size_t root(size_t);
  void connect();
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Where ball centres lie so that a ball of radius H around them touches a surface from below and
   nowhere crosses it: the surface eroded by a sphere. At x,y this is the lowest

     s(x + u, y + v) - sqrt(H^2 - u^2 - v^2),  u^2 + v^2 <= H^2

   over the heights s of the surface. Beyond the rim of the surface, see doc/src/surface_sampling.rst.
   No LAMMPS. Lengths are in one unit of the caller's choice (m). */

#ifndef SLOPE_SUNK_SURFACE_H
#define SLOPE_SUNK_SURFACE_H

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace Slope {

// nx by ny values, most of which are one value: only the squares where some are others take memory
template <typename Value> class SparsePlane {
 public:
  void reset(int nx_in, int ny_in, Value rest_in)
  {
    nx = nx_in;
    ny = ny_in;
    rest = rest_in;
    wide = (nx + SIDE - 1) / SIDE;
    squares.clear();
    squares.resize(static_cast<size_t>(wide) * ((ny + SIDE - 1) / SIDE));
  }

  Value get(int i, int j) const
  {
    const Square *square = squares[number(i, j)].get();
    return square ? (*square)[inner(i, j)] : rest;
  }

  Value &at(int i, int j)    // takes memory
  {
    std::unique_ptr<Square> &square = squares[number(i, j)];
    if (!square) square.reset(new Square(SIDE * SIDE, rest));
    return (*square)[inner(i, j)];
  }

  // The values of row j from i on that lie in memory together, before end; nullptr: all of them are the
  // rest. next: where they end.
  const Value *run(int i, int j, int end, int &next) const
  {
    next = std::min(end, static_cast<int>((i / SIDE + 1) * SIDE));
    const Square *square = squares[number(i, j)].get();
    return square ? &(*square)[inner(i, j)] : nullptr;
  }

  // visit(i, j, value), row by row, where the value may be other than the rest
  template <typename Visit> void each(Visit visit) const
  {
    for (int j = 0; j < ny; j++)
      for (int i = 0, next; i < nx; i = next) {
        const Value *value = run(i, j, nx, next);
        if (value)
          for (int k = i; k < next; k++) visit(k, j, value[k - i]);
      }
  }

 private:
  static constexpr unsigned SIDE = 64;
  typedef std::vector<Value> Square;
  int nx = 0, ny = 0, wide = 0;
  Value rest = Value();
  std::vector<std::unique_ptr<Square>> squares;

  // i, j >= 0: without a sign a division by SIDE is a shift
  size_t number(unsigned i, unsigned j) const { return size_t(j / SIDE) * wide + i / SIDE; }
  static size_t inner(unsigned i, unsigned j) { return size_t(j % SIDE) * SIDE + i % SIDE; }
};

// the surface that is sunk, column by column; called only while the sunk one is made
struct Bed {
  double xlo, xhi, ylo, yhi;    // it has no column beyond them

  // height of the surface at x,y, false where it has none; near: where it is to be looked for, the
  // height of a column close by; NaN: anywhere
  typedef std::function<bool(double x, double y, double near, double &z)> Height;
  Height height;

  // The ground that the surface comes out of at its rim: it is continued to meet it. Empty: the
  // surface ends with its columns.
  Height ground;

  // What is above the surface goes with it: the sunk surface reaches as far beyond the rim as a ball
  // of radius H around a point of the surface. Else it ends with the columns of the surface.
  bool body;

  // It is not continued, where it comes out of the ground either.
  bool ends;
};

class SunkSurface {
 public:
  // Looks at the surface in columns that are at most a pitch apart. Needs 0 < pitch <= sink / 2 and
  // xlo <= xhi, ylo <= yhi (else std::invalid_argument), fewer than 2^31 columns (std::length_error).
  SunkSurface(const Bed &, double sink, double pitch);

  // Height of the centres at x,y, false where there are none. Of a body with a ground, centres above
  // the ground are to be left out by the caller.
  bool height(double x, double y, double &z) const;

  double xlo, xhi, ylo, yhi;    // there are no centres beyond them
  double lowest() const;        // height of a centre; infinite if there is none

 private:
  struct Point {
    double x, y, z;
  };
  struct Edge {
    int i, j, di, dj;    // from a column of the surface to its neighbor without
  };

  const double sink;
  double px, py;              // between columns
  int nx, ny, mx, my;         // columns, and how many of them are margin on each side
  SparsePlane<double> z;      // of the columns; infinite: the surface is not there
  std::vector<Point> rims;    // where it ends between columns, by bins of size sink
  std::vector<int> first;     // bin b holds rims first[b] .. first[b+1]-1
  int bins_x, bins_y;

  bool has(int i, int j) const;
  double column_x(int i) const { return xlo + i * px; }
  double column_y(int j) const { return ylo + j * py; }

  void measure(const Bed &);
  bool look_at(const Bed &, int i, int j, double near);
  void trim(const Bed &);
  std::vector<Edge> edges() const;
  bool plane(int i, int j, double &gx, double &gy) const;
  void end_at(const Bed &, const Edge &);
  void add_rim(const Bed &, const Point &, const Point &);
  void go_on(const Bed &, const std::vector<Edge> &);
  void sort_rims();
  bool patch(double x, double y, double &height, double &gx, double &gy) const;
};

}    // namespace Slope

#endif

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
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

namespace Slope {

// Values of a plane, most of which are one value: only the squares where some are others take memory.
template <typename Value> class SparsePlane {
 public:
  static constexpr unsigned SIDE = 64;    // values along a square

  void reset(Value rest_in)
  {
    rest = rest_in;
    squares.clear();
    forget_last();
  }

  Value get(int i, int j) const
  {
    const Square *square = find(i, j);
    return square ? (*square)[inner(i, j)] : rest;
  }

  Value &at(int i, int j)    // takes memory
  {
    std::unique_ptr<Square> &square = squares[number(i, j)];
    if (!square) {
      square.reset(new Square(SIDE * SIDE, rest));
      forget_last();
    }
    return (*square)[inner(i, j)];
  }

  bool has_square(int i, int j) const { return find(i, j) != nullptr; }

  // The values of row j from i on that lie in memory together, before end; nullptr: all of them are the
  // rest. next: where they end.
  const Value *run(int i, int j, int end, int &next) const
  {
    next = std::min(end, static_cast<int>((i / SIDE + 1) * SIDE));
    const Square *square = find(i, j);
    return square ? &(*square)[inner(i, j)] : nullptr;
  }

  // visit(i, j, value), row by row, where the value may be other than the rest
  template <typename Visit> void each(Visit visit) const
  {
    std::map<uint64_t, const Square *> in_order;
    for (const auto &one : squares) in_order[one.first] = one.second.get();
    for (auto row = in_order.begin(); row != in_order.end();) {
      const auto end = in_order.lower_bound(((row->first >> 32) + 1) << 32);
      for (unsigned j = 0; j < SIDE; j++)
        for (auto one = row; one != end; ++one)
          for (unsigned i = 0; i < SIDE; i++)
            visit(static_cast<int>((one->first & 0xffffffffu) * SIDE + i),
                  static_cast<int>((one->first >> 32) * SIDE + j), (*one->second)[j * SIDE + i]);
      row = end;
    }
  }

 private:
  typedef std::vector<Value> Square;
  Value rest = Value();
  std::unordered_map<uint64_t, std::unique_ptr<Square>> squares;

  // the last ones that were asked for, of four that meet
  struct Last {
    uint64_t number;
    const Square *square;
  };
  mutable Last last[4] = {
      {UINT64_MAX, nullptr}, {UINT64_MAX, nullptr}, {UINT64_MAX, nullptr}, {UINT64_MAX, nullptr}};

  void forget_last()
  {
    for (Last &one : last) one = {UINT64_MAX, nullptr};
  }

  // i, j >= 0: without a sign a division by SIDE is a shift
  static uint64_t number(unsigned i, unsigned j) { return uint64_t(j / SIDE) << 32 | i / SIDE; }
  static size_t inner(unsigned i, unsigned j) { return size_t(j % SIDE) * SIDE + i % SIDE; }

  const Square *find(unsigned i, unsigned j) const
  {
    const uint64_t wanted = number(i, j);
    Last &known = last[(i / SIDE & 1) + 2 * (j / SIDE & 1)];
    if (known.number != wanted) {
      const auto found = squares.find(wanted);
      known = {wanted, found == squares.end() ? nullptr : found->second.get()};
    }
    return known.square;
  }
};

// the surface that is sunk, column by column: of a body called while the sunk one is made, else where a height of it is
// asked for first
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
};

class SunkSurface {
 public:
  // Looks at the surface in columns that are at most a pitch apart. Needs 0 < pitch <= sink / 2 and
  // xlo <= xhi, ylo <= yhi (else std::invalid_argument), fewer than 2^31 columns of a body, 1e14 of
  // a ground (std::length_error).
  SunkSurface(const Bed &, double sink, double pitch);

  // Height of the centres at x,y, false where there are none. Of a body with a ground, centres above
  // the ground are to be left out by the caller.
  bool height(double x, double y, double &z) const;

  double xlo, xhi, ylo, yhi;    // there are no centres beyond them
  double lowest() const;        // of a body: height of a centre; infinite if there is none

 private:
  struct Point {
    double x, y, z;
  };
  struct Edge {
    int i, j, di, dj;    // from a column of the surface to its neighbor without
  };

  const double sink;
  Bed bed;               // of a surface that is no body
  double px, py;         // between columns
  int nx, ny, mx, my;    // columns, and how many of them are margin on each side
  // of the columns; infinite: the surface is not there; square by square as heights are asked for, unless it is a body's
  mutable SparsePlane<double> z;
  std::vector<Point> rims;    // where it ends between columns, by bins of size sink
  std::vector<int> first;     // bin b holds rims first[b] .. first[b+1]-1
  int bins_x, bins_y;

  bool has(int i, int j) const;
  double column_x(int i) const { return xlo + i * px; }
  double column_y(int j) const { return ylo + j * py; }

  void measure(const Bed &);
  void look_around(double x, double y) const;
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

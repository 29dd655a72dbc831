// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SPARSE_PLANE_H
#define SLOPE_SPARSE_PLANE_H

#include <algorithm>
#include <cstddef>
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
    next = std::min(end, (i / SIDE + 1) * SIDE);
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
  static constexpr int SIDE = 64;
  typedef std::vector<Value> Square;
  int nx = 0, ny = 0, wide = 0;
  Value rest = Value();
  std::vector<std::unique_ptr<Square>> squares;

  size_t number(int i, int j) const { return static_cast<size_t>(j / SIDE) * wide + i / SIDE; }
  static size_t inner(int i, int j) { return static_cast<size_t>(j % SIDE) * SIDE + i % SIDE; }
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BODY_VOLUME_H
#define SLOPE_BODY_VOLUME_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace Slope {

// Volume of a body, given only a test of whether a point is inside, from columns at
// random places in square cells. Cells that hold some of it, and their neighbours, are split in
// four until the sum no longer changes. A column is searched from a random height on in steps, and
// what begins or ends between two of them by bisection.
//
// Several ranks share the columns; all get the same volume, to the bit, whatever their number.
class BodyVolume {
 public:
  typedef std::function<bool(double x, double y, double z)> Inside;

  struct Box {    // the body is in it
    double lo[3], hi[3];
  };
  struct Ranks {
    int me, number;
    std::function<void(std::vector<double> &)> sum;    // of all ranks, on all ranks; empty: one
  };

  BodyVolume(const Box &, const Inside &, const Ranks & = {0, 1, nullptr});

  // A place (x, y) where the body is likely to be, of this rank: in a box much larger than the
  // body, and so that small parts of it are not missed, columns are searched there too.
  void mark(double x, double y);

  // To 1e-3 of itself, three standard deviations; 0 for no body. std::runtime_error if the sum
  // does not settle.
  double volume();

 private:
  struct Cell {
    int i, j, steps;    // of the search from zlo to zhi
    double zlo, zhi;    // after it: what was found, zlo > zhi: nothing
  };

  Box box;
  Inside inside;
  Ranks ranks;
  std::vector<double> marks;    // x y of this rank's
  bool any_marks;               // on any rank
  double cell;                  // size
  int n[2], level;
  std::vector<Cell> cells;
  size_t filled;    // columns with a part of the body

  int64_t key(int i, int j) const { return (int64_t) j * n[0] + i; }
  bool there(double x, double y, double z) const
  {
    return z >= box.lo[2] && z <= box.hi[2] && inside(x, y, z);
  }
  void set_level(int level);
  void add_up(std::vector<double> &) const;
  double sum();
  double column(Cell &) const;
  double edge(double x, double y, double out, double in) const;
  void split();
  void add_marked(std::vector<Cell> &);
};

}    // namespace Slope

#endif

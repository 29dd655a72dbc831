// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* From a surface, as heights over a plan, to the centres of fixed balls on it, tile by tile: what all patterns ask and
   give. Any tile can be asked for alone, in any order: its balls and their numbers are always the same. Lengths are in one
   unit of the caller's choice (m). */

#ifndef SLOPE_BALL_SAMPLER_H
#define SLOPE_BALL_SAMPLER_H

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace Slope {

// square plan grid: nodes at origin + integers * spacing, those inside the rectangle
struct NodeGrid {
  double xlo, xhi, ylo, yhi;
  double spacing;
  double xorigin, yorigin;
};

// the surface, column by column; called only inside the rectangle of the plan grid
struct GroundHeights {
  // height of the surface at x,y; false where there is none
  std::function<bool(double x, double y, double &z)> height;

  // true where balls are wanted; empty: everywhere
  std::function<bool(double x, double y)> keep;

  // Where keep() is false: height of the ground that other balls make there, below height();
  // false where unknown. The vertical gap at the rim of keep() is closed. Empty: leave it.
  std::function<bool(double x, double y, double &z)> scar;
};

// A ball, and its number, below 2^52: the cell of the plan that it belongs to, and which one of that
// cell it is. Rounding does not change the numbers of others.
struct PlacedBall {
  double x, y, z;
  int64_t number;
  int zone;    // that it lies in, 0: in none

  static constexpr int64_t OF_CELL = 1 << 20;    // numbers of the balls of one cell
  bool first_of_cell() const { return number % OF_CELL == 0; }
};

// sort: the first ones of their cells row by row, then the others cell by cell
inline void in_order(std::vector<PlacedBall> &balls)
{
  std::sort(balls.begin(), balls.end(), [](const PlacedBall &a, const PlacedBall &b) {
    return a.first_of_cell() != b.first_of_cell() ? a.first_of_cell() : a.number < b.number;
  });
}

struct SurfaceCounts {
  int64_t without_surface = 0;    // nodes of the plan grid = without_surface + dropped + base
  int64_t dropped = 0;            // by keep()
  int64_t base = 0;               // balls on nodes, or scattered ones
  int64_t extra = 0;              // balls that close the surface between nodes
};

// nx by ny square tiles of the plan; the first and the last ones reach as far as their balls do. The
// plan may be turned about the origin, counterclockwise.
struct TilePlan {
  double xlo, ylo, size;
  int nx, ny;
  double cosine, sine;

  TilePlan(double _xlo, double _ylo, double _size, int _nx, int _ny) :
      xlo(_xlo), ylo(_ylo), size(_size), nx(_nx), ny(_ny), cosine(1.0), sine(0.0)
  {
  }

  // about a place, by an angle (radians): xlo, ylo are then coordinates that turn with the plan
  void turn(double angle, const double *about)
  {
    cosine = std::cos(angle);
    sine = std::sin(angle);
    xlo += cosine * about[0] + sine * about[1] - about[0];
    ylo += cosine * about[1] - sine * about[0] - about[1];
  }
};

class BallSampler {
 public:
  virtual ~BallSampler() = default;
  virtual TilePlan tiles() const = 0;

  // append the balls of a tile; add to the counts. std::length_error if a cell needs too many.
  virtual void sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts) = 0;

  // whether a tile has balls; a surface without such a tile has no balls
  virtual bool has_balls(int tile) = 0;

  // what was only needed to make the last tiles
  virtual void forget() = 0;
};

}    // namespace Slope

#endif

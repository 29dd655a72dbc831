// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* From a surface to the centres of fixed balls on it: one ball per node of a plan grid, and
   more where the surface is so steep, or ends, that a ball of the same size could pass between
   those. The rule and its derivation: doc/src/surface_sampling.rst. No LAMMPS.

   Any tile of the ground can be asked for alone, in any order: its balls and their numbers are
   always the same, whatever the size of the tiles. */

#ifndef SLOPE_SURFACE_SAMPLER_H
#define SLOPE_SURFACE_SAMPLER_H

#include "plan_nodes.h"
#include "surface_closer.h"

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace Slope {

// A ball, and its number, below 2^52: the cell of the plan grid with the node, or that needed the
// extra ball, and which one of that cell it is. Rounding does not change the numbers of others.
struct PlacedBall {
  double x, y, z;
  int64_t number;
};

bool is_extra(const PlacedBall &ball);    // not on a node

// sort: those on nodes row by row, then the extra ones cell by cell
void in_order(std::vector<PlacedBall> &balls);

struct SurfaceCounts {
  int64_t without_surface = 0;    // nodes of the plan grid = without_surface + dropped + base
  int64_t dropped = 0;            // by keep()
  int64_t base = 0;               // balls on nodes
  int64_t extra = 0;              // balls that close the surface between nodes
};

class SurfaceSampler {
 public:
  // As PlanNodes; radius > 0, else std::invalid_argument. The size of tiles is for tests.
  SurfaceSampler(const NodeGrid &grid, double radius, const Surface &surface,
                 int tile = PlanNodes::TILE);

  int tiles_x() const { return nodes.tiles_x; }
  int tiles_y() const { return nodes.tiles_y; }
  int tiles() const { return nodes.tiles_x * nodes.tiles_y; }
  const PlanNodes &plan() const { return nodes; }

  // append the balls of a tile, those on nodes row by row, then the extra ones; add to the counts.
  // std::length_error if a cell needs 2^20 balls.
  void sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts);

  // whether a tile has balls on nodes; a surface without such a tile has no balls
  bool has_balls(int tile);

  // height of the ball on a node, NaN without; -infinite where rounding may decide on that, at a rim
  double node(int i, int j) const;

  // forget what was looked at, but not which cells need balls
  void forget();

 private:
  PlanNodes nodes;
  SurfaceCloser closer;

  // Cells that need balls, or in which the surface ends, with these balls. A patch of cells that
  // are in reach of one another is closed at once, row by row: cells decide on others' balls.
  typedef std::vector<SurfaceCloser::Point> Points;
  std::unordered_map<int64_t, Points> closed;
  std::unordered_map<int64_t, bool>
      leaky;    // steep cells: do the nodes alone leave a way through?

  struct Member {
    int hidden;    // how many cells the rim has come since its last cell that shows at the corners
    SurfaceCloser::Columns columns;
  };
  std::unordered_map<int64_t, Member> patch;

  bool belongs(int64_t cell);
  bool uniform(int tile_i, int tile_j);
  void close_patch(int64_t seed);
  void collect(int64_t seed);
  typedef std::vector<std::pair<int64_t, int>> Steps;    // cells, and how hidden they are
  void follow_rim(int64_t cell, int hidden, Steps &todo);
  void join_rims(int i, int j, std::unordered_set<int64_t> &blocks, Steps &todo);
  void close_rims_around(int tile_i, int tile_j);
  void remember_less(int tile_j);
};

}    // namespace Slope

#endif

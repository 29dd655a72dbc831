// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Fixed balls on a plan grid: one per node, and more where the surface is so steep, or ends, that a ball
   of the same size could pass between those. The rule and its derivation:
   doc/src/surface_sampling.rst. */

#ifndef SLOPE_SURFACE_SAMPLER_H
#define SLOPE_SURFACE_SAMPLER_H

#include "ball_sampler.h"
#include "plan_nodes.h"
#include "surface_closer.h"

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace Slope {

class SurfaceSampler : public BallSampler {
 public:
  // As PlanNodes; radius > 0, else std::invalid_argument. The size of tiles is for tests.
  SurfaceSampler(const NodeGrid &grid, double radius, const GroundHeights &surface,
                 int tile = PlanNodes::TILE);

  TilePlan tiles() const override;
  void sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts) override;
  bool has_balls(int tile) override;
  void forget() override;    // but not which cells need balls

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

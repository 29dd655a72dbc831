// All balls of a surface, those on nodes row by row, then the extra ones

#ifndef SLOPE_TEST_ALL_BALLS_H
#define SLOPE_TEST_ALL_BALLS_H

#include "surface_sampler.h"

#include <vector>

namespace Slope {

struct SurfaceBalls : SurfaceCounts {
  std::vector<double> xyz;
  int64_t nodes = 0;
};

inline SurfaceBalls sample_surface(const NodeGrid &grid, double radius, const GroundHeights &surface)
{
  SurfaceSampler sampler(grid, radius, surface);
  SurfaceBalls all;
  std::vector<PlacedBall> balls;
  const TilePlan tiles = sampler.tiles();
  for (int tile = 0; tile < tiles.nx * tiles.ny; tile++) sampler.sample(tile, balls, all);
  all.nodes = static_cast<int64_t>(count_nodes(grid));
  in_order(balls);
  for (const PlacedBall &b : balls) all.xyz.insert(all.xyz.end(), {b.x, b.y, b.z});
  return all;
}

}    // namespace Slope

#endif

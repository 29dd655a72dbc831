// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_SEARCH_H
#define SLOPE_SLIP_SEARCH_H

#include "elevation_grid.h"
#include "slip_body.h"

#include <cmath>
#include <functional>
#include <vector>

namespace Slope {

// What a body must keep to, and how many are kept.
struct SlipLimits {
  double volume_lo = 0.0, volume_hi = HUGE_VAL;    // m3; lo 0: what the raster resolves
  double depth_lo = 0.0, depth_hi = HUGE_VAL;
  int keep = 1;
  bool ellipsoids = false;    // the width across the direction of sliding is free, too
};

// Ranks that share a search. least() makes of each value the least of all ranks; progress() is called
// on each rank with the stage and the share of it that is done, first 0.
struct SlipRanks {
  int me, all;
  std::function<void(double *, size_t)> least;
  std::function<void(const char *, double)> progress;
};

// Searches the spheres with the least factor of safety below a terrain: a lattice of centres and radii
// with a column per cell or block of cells, then Nelder and Mead's simplex from the best that
// differ, and, where several bodies are kept, from the best above each place that share no ground,
// then the same with exact columns, and with the width free. Each surface is computed by one rank, and what comes next
// depends on the factors of all: the result does not depend on the ranks.
class SlipSearch {
 public:
  static constexpr double SHARED =
      0.1;    // at most, of the smaller one's plan, by bodies that are kept
  static constexpr double WIDEST = 4.0;    // across the direction of sliding / along it

  SlipSearch(const ElevationGrid &ground, const SlipLimits &, const SlipRanks &, SlipBodyMaker &);

  // The kept bodies, the least factor first, with their yield coefficients; empty if there is no body
  // within the limits.
  std::vector<SlipBody> run();

  // least factor of the lattice's surfaces through each cell
  const ElevationGrid &least() const { return map; }
  // least factor by moments alone of the lattice's surfaces for which the method has none; HUGE_VAL: none
  double least_left_out() const { return left_out; }
  size_t surfaces() const { return static_cast<size_t>(centres[0]) * centres[1] * per_place(); }

 private:
  struct Plan {    // blocks of stride x stride cells
    int stride;
    std::vector<size_t> blocks;
  };

  const ElevationGrid &ground;
  SlipLimits limits;
  SlipRanks ranks;
  SlipBodyMaker &maker;
  ElevationGrid map;
  double left_out = HUGE_VAL;

  double size_lo, size_hi;    // of bodies, in plan
  double origin[2], spacing;
  int centres[2], heights;

  void lay_lattice();
  void centre_on_allowed();
  size_t per_place() const;
  double ground_near(double x, double y) const;
  double nearest(double x, double y, double z, double reach) const;
  void above_place(size_t place, double *factors);
  SlipSurface lattice_surface(size_t number) const;
  struct Best {
    std::vector<SlipBody> of_all, of_places;    // the least factor first
  };
  Best lattice();

  int stride_for(const SlipSurface &) const;
  bool within(const SlipBody &) const;
  bool compute(const SlipSurface &, int lines, SlipBody &);
  void mark(const SlipBody &);
  Plan plan(const SlipSurface &, int stride);
  bool overlap(const Plan &, const Plan &, double share) const;
  std::vector<SlipBody> distinct(std::vector<SlipBody>, size_t most, double share,
                                 int stride = 0);    // of their plans, 0: what is fast
  std::vector<SlipBody> starts();
  std::vector<SlipBody> apart(const std::vector<SlipBody> &);

  bool enter(const SlipBody &, int lines, SlipBody &);
  SlipBody improve(const SlipBody &, bool wide, int lines, int steps);
  std::vector<SlipBody> improve_all(const char *stage, const std::vector<SlipBody> &, bool wide,
                                    int lines, int steps, int again);
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* From a surface to the centres of fixed balls on it: one ball per node of a plan grid, and
   more where the surface is so steep, or ends, that a ball of the same size could pass between
   those. The rule and its derivation: doc/src/surface_sampling.rst. No LAMMPS.

   Lengths are in one unit of the caller's choice (m). */

#ifndef SLOPE_SURFACE_SAMPLER_H
#define SLOPE_SURFACE_SAMPLER_H

#include <cstdint>
#include <functional>
#include <vector>

namespace Slope {

// square plan grid: nodes at origin + integers * spacing, those inside the rectangle
struct PlanGrid {
  double xlo, xhi, ylo, yhi;
  double spacing;
  double xorigin, yorigin;
};

// the surface, column by column; called only inside the rectangle of the plan grid
struct Surface {
  // height of the surface at x,y; false where there is none
  std::function<bool(double x, double y, double &z)> height;

  // true where balls are wanted; empty: everywhere
  std::function<bool(double x, double y)> keep;

  // Where keep() is false: height of the ground that other balls make there, below height();
  // false where unknown. The vertical gap at the rim of keep() is closed. Empty: leave it.
  std::function<bool(double x, double y, double &z)> scar;
};

struct SurfaceBalls {
  std::vector<double> xyz;    // x,y,z of each ball: those on nodes row by row, then the extra ones
  int64_t nodes = 0;          // of the plan grid = without_surface + dropped + base
  int64_t without_surface = 0;
  int64_t dropped = 0;    // by keep()
  int64_t base = 0;       // balls on nodes
  int64_t extra = 0;      // balls that close the surface between nodes
};

// number of nodes of the plan grid; a double, because it may be beyond any integer
double plan_nodes(const PlanGrid &grid);

// every point of the surface lies within this distance of a ball centre (and within that plus
// sampling_slack, since the surface is looked at in samples)
double cover_radius(double spacing, double radius);
double sampling_slack(double radius);

// Balls of this radius on the surface. Needs spacing > 0, radius > 0, xlo <= xhi, ylo <= yhi
// (else std::invalid_argument) and fewer than 2^31 nodes and balls (else std::length_error).
SurfaceBalls sample_surface(const PlanGrid &grid, double radius, const Surface &surface);

}    // namespace Slope

#endif

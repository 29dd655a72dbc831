// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What all patterns of fixed balls ask: a surface as heights over a plan, and its grid. No LAMMPS. Lengths are in one
   unit of the caller's choice (m). */

#ifndef SLOPE_GROUND_HEIGHTS_H
#define SLOPE_GROUND_HEIGHTS_H

#include <functional>

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

}    // namespace Slope

#endif

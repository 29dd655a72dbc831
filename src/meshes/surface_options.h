/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef LMP_SURFACE_OPTIONS_H
#define LMP_SURFACE_OPTIONS_H

#include "pointers.h"

#include "touched_surface.h"

#include <memory>
#include <string>

namespace Slope {
class TerrainSurface;
}

namespace LAMMPS_NS {

// The arguments of fix wall/gran/mesh from TYPE on, and the surface that they name. Wrong ones end the
// run with one line.
class SurfaceOptions : protected Pointers {
 public:
  SurfaceOptions(class LAMMPS *, const std::string &caller, int narg, char **arg);

  std::unique_ptr<Slope::TouchedSurface> surface() const;    // collective: reads the file

  int type;
  Slope::Vector point;    // of the moments, as low as the surface
  std::string output;     // prefix; empty: none
  int every;              // steps between two rows of the output

 private:
  std::string caller, file;
  bool terrain;
  double scale, lower;
  Slope::Vector move;

  void read_keywords(int narg, char **arg);
  std::unique_ptr<Slope::TouchedSurface> read_stl() const;
  std::unique_ptr<Slope::TouchedSurface> read_terrain() const;
  std::unique_ptr<Slope::TouchedSurface> shared(std::unique_ptr<Slope::TerrainSurface>) const;
  void check_place(const Slope::TouchedSurface &) const;
};

}    // namespace LAMMPS_NS

#endif

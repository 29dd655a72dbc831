/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_OPTIONS_H
#define SLOPE_SLIP_OPTIONS_H

#include "pointers.h"

#include "elevation_grid.h"
#include "slip_body.h"
#include "slip_search.h"
#include "slip_soil.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// The arguments of find_slip, and what they name. Wrong ones end the run with one line.
class SlipOptions : protected Pointers {
 public:
  SlipOptions(class LAMMPS *, int narg, char **arg);

  const Slope::ElevationGrid &ground() const;
  Slope::SlipSoil soil() const;         // collective: reads the rasters
  std::vector<char> allowed() const;    // a flag for each cell of the ground, or empty
  const std::string &variable() const { return name; }    // beginning of the variables' names

  Slope::SlipTask task;
  Slope::SlipLimits limits;
  std::string output;            // prefix of the files
  bool lone;                     // one surface, no search
  Slope::SlipSurface surface;    // this one

 private:
  std::string region, within, table, bedrock, name;
  double ru;
  bool has_strength;
  Slope::SlipSoil::Strength top;
  struct Layer {
    std::string file;
    Slope::SlipSoil::Strength strength;
  };
  std::vector<Layer> layers;

  Slope::SlipSoil::Strength strength(const class KeywordReader &, int k) const;
  bool read_soil(KeywordReader &);
  bool read_search(KeywordReader &);
  void read_limits(const KeywordReader &, double &lo, double &hi) const;
  void read_surface(KeywordReader &);
  void check();
  template <class Kind>
  void check_region(const char *what, const std::string &named, const char *style) const;
  Slope::ElevationGrid raster(const std::string &file) const;
};

}    // namespace LAMMPS_NS

#endif

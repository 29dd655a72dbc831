// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_WRITER_H
#define SLOPE_SLIP_WRITER_H

#include "elevation_grid.h"
#include "slip_body.h"

#include <string>
#include <vector>

namespace Slope {

// The files of bodies, all of them or none: PREFIX.slips.csv, PREFIX.factor.asc, PREFIX.N.base.asc.
// Errors are std::runtime_error with one line.
class SlipWriter {
 public:
  static void probe(const std::string &prefix, int bodies);    // whether they could be written

  // least: factor of the surfaces through each cell, to which those of the bodies are added
  static void write(const std::string &prefix, ElevationGrid least, const std::vector<SlipBody> &,
                    SlipBodyMaker &);

  static std::string table(const std::vector<SlipBody> &);
};

}    // namespace Slope

#endif

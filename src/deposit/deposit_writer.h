// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_WRITER_H
#define SLOPE_DEPOSIT_WRITER_H

#include "deposit_rasters.h"

#include <string>
#include <vector>

namespace Slope {

// The raster files of a deposit, as text in parts: a header, then the bands of rows, of which each
// rank has its own, from the last band to the first.
class DepositWriter {
 public:
  struct File {
    std::string path;
    int content;    // a DepositRasters::Name, BASE or SURFACE
    int digits;
  };
  enum { BASE = DepositRasters::KINDS, SURFACE };

  // PREFIX.base.asc, .thickness.asc, ...; number: also PREFIX.NUMBER.thickness.asc, or empty
  static std::vector<File> files(const std::string &prefix, const std::string &number);

  static std::string header(const PlanGrid &);
  static std::string text_of_band(const DepositRasters &, const File &, int band);
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_WRITER_H
#define SLOPE_DEPOSIT_WRITER_H

#include "atomic_file.h"
#include "deposit_rasters.h"

#include <string>
#include <vector>

namespace Slope {

// The raster files of a deposit.
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

  static void write(AtomicFile &, const DepositRasters &, const File &);
};

}    // namespace Slope

#endif

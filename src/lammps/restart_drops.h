/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_RESTART_DROPS_H
#define SLOPE_RESTART_DROPS_H

#include "pointers.h"

#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// What a restart file has for fixes goes to those that are defined before the first command that sets LAMMPS up (run,
// balance, write_restart, ...). Then LAMMPS drops the rest, and a fix that comes later, of the same ID and style, begins
// without its contacts or sums.
class RestartDrops : protected Pointers {
 public:
  explicit RestartDrops(class LAMMPS *lmp) : Pointers(lmp) {}

  // at each set-up, before LAMMPS drops: ends the run if there is such a fix
  void check();

 private:
  typedef std::pair<std::string, std::string> Name;    // ID and style
  std::vector<Name> dropped;
};

}    // namespace LAMMPS_NS

#endif

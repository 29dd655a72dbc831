/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_RESTART_COUNT_H
#define SLOPE_RESTART_COUNT_H

#include "error.h"
#include "lammps.h"

#include <cmath>
#include <string>

namespace LAMMPS_NS {

// How many numbers or records follow in a fix's part of a restart file, twice: LAMMPS hands that part over without its
// length, and in a damaged file one of the two may be anything.
struct RestartCount {
  double number, again;
  explicit RestartCount(double n = 0.0) : number(n), again(-1.0 - n) {}

  // all ranks: the number, if both are the same, whole and from 0 to most
  size_t check(LAMMPS *lmp, const std::string &caller, double most) const
  {
    if (!(number >= 0.0 && number <= most && number == std::floor(number) &&
          again == -1.0 - number))
      lmp->error->all(FLERR,
                      "{}: the number of its data in the restart file must be whole, from 0 to "
                      "{:.0f} and there twice, got "
                      "{:g} and {:g}: the file is damaged, take an earlier one",
                      caller, most, number, -1.0 - again);
    return static_cast<size_t>(number);
  }
};

}    // namespace LAMMPS_NS

#endif

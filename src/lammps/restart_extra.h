/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef LMP_RESTART_EXTRA_H
#define LMP_RESTART_EXTRA_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

// What a restart file has for the balls of a fix, which LAMMPS hands over without its length. In a damaged
// file the numbers in it may be anything: a ball is then left without contacts, and check() ends the run.
class RestartExtra : protected Pointers {
 public:
  explicit RestartExtra(class LAMMPS *lmp) : Pointers(lmp), ball(0), wrong(0.0) {}

  // for ball i, the nth fix: how many numbers there are, the number of contacts, and so on; all fit in what
  // has been read, and are fixed numbers and those of each contact; nullptr: the file is damaged
  const double *find(int i, int nth, int fixed, int each);

  void check(const std::string &caller) const;    // collective

 private:
  tagint ball;     // the last one that is damaged; 0: none
  double wrong;    // the number there

  const double *reject(int i, double number);
};

}    // namespace LAMMPS_NS

#endif

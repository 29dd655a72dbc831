/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SPEED_GUARD_H
#define SLOPE_SPEED_GUARD_H

#include "pointers.h"

#include "contact_law.h"

#include <string>

namespace LAMMPS_NS {

// The guard against balls so fast that they may pass through a surface. A ball that hits along
// the normal goes as deep as the spring lets it, undamped. Up to a quarter of its radius no ball
// passes, whatever the edges that it meets.
class SpeedGuard : protected Pointers {
 public:
  static constexpr double DEEPEST = 0.25;    // overlap over radius

  SpeedGuard(class LAMMPS *, const std::string &caller);

  void start();    // of a run
  void record(int i, double speed,
              const Slope::ContactLaw &);      // towards the surface; warns of the first one
  void report(class ContactGuards &guards);    // at the end of a run; collective

 private:
  std::string caller;
  struct Worst {
    double share;    // of the speed up to which no ball passes
    double speed, ball, step;
  } worst;
  bigint count;
};

}    // namespace LAMMPS_NS

#endif

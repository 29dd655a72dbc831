/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_INITIAL_OVERLAP_H
#define SLOPE_INITIAL_OVERLAP_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

// The guard against balls that are placed inside each other. A linear spring of this
// stiffness turns an overlap of a few per cent of the radius into a shot; a run must not
// start from one. Used by the pair style and by the wall fix at set-up; contacts that come
// with a history (a continued or restarted run) are not looked at.
class InitialOverlap : protected Pointers {
 public:
  static constexpr double LIMIT = 0.05;    // of the smaller radius

  explicit InitialOverlap(class LAMMPS *lmp) : Pointers(lmp), worst(LIMIT), count(0) {}

  // note one overlapping pair; partner names it in the message
  void record(double overlap, double radius, tagint ball, const double *where,
              const std::string &partner);

  // collective: ends the run if any rank saw an overlap above the limit
  void check(const std::string &caller, const std::string &remedy = "see delete_balls");

 private:
  double worst;        // overlap / radius
  bigint count;        // pairs above the limit
  std::string text;    // the worst pair
};

}    // namespace LAMMPS_NS

#endif

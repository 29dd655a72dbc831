/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What moves the balls of a run and what holds them: a ball that nothing moves, or that nothing pulls,
   hangs in the air and counts as one at rest. */

#ifndef SLOPE_MOTION_GUARD_H
#define SLOPE_MOTION_GUARD_H

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class MotionGuard : protected Pointers {
 public:
  explicit MotionGuard(LAMMPS *);

  void start(int freeze_group_bit);    // at the set-up of a run

  // What is not sensible, in words; collective. In the first step of a run: neither run 0 nor rerun moves
  // anything.
  std::vector<std::string> begin_step();
  std::vector<std::string> end_run();    // balls that came since, or that hang

 private:
  int frozen;    // group bits
  bool stepped;
  bigint unmoved;    // balls

  struct Movers {
    int moved, guided;     // group bits
    std::string guides;    // fixes
  };
  Movers movers() const;
  template <typename Test> bigint count_free(Test test) const;
  void check_unmoved(const Movers &, std::vector<std::string> &found);
  void check_gravity(std::vector<std::string> &found) const;
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_GRAVITY_WORK_H
#define SLOPE_GRAVITY_WORK_H

#include "pointers.h"

namespace LAMMPS_NS {

// what fixes tell of themselves: the acceleration of a fix gravity, m/s2; the work of all fixes ground/motion
// so far on this rank's balls, J
const double *acceleration_of(class Fix *gravity);
double shaking_work(class LAMMPS *);

// Work of gravity on the balls during a run, for the energy guard: their weights times their ways, which need neither heights
// nor image flags. Between two neighbor lists no ball comes, goes or is wrapped, so that the places at both ends are enough;
// where gravity or its group varies, each step counts with the velocities of its middle, with which balls move.
class GravityWork : protected Pointers {
 public:
  explicit GravityWork(LAMMPS *lmp) : Pointers(lmp), by_step(false), at_begin(0.0), sum(0.0) {}

  void start();         // at the set-up of a run
  void begin_list();    // of neighbors: places have been wrapped, balls may have come or gone
  void count_way();     // since then, or since the last call
  void count_step();    // in the middle of a step
  double done() const { return sum; }    // since start(), on this rank's balls, J

  double weighed(double **vectors) const;    // sum of vector * weight of each ball

 private:
  bool by_step;
  double at_begin, sum;
};

}    // namespace LAMMPS_NS

#endif

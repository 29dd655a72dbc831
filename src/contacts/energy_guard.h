/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Energy of the balls during a run: motion, height and what the springs hold. Contacts take
   from it and give nothing, so it only falls, but for what a motion of the ground puts in, which
   is counted and taken out; if it grows, the time step is too large or contacts were found late.
   And it is a number, or the run ends. */

#ifndef SLOPE_ENERGY_GUARD_H
#define SLOPE_ENERGY_GUARD_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

class EnergyGuard : protected Pointers {
 public:
  static constexpr int EVERY = 200;    // steps between two checks, multiple of FINITE_EVERY
  static constexpr int FINITE_EVERY = 50;
  // Of the largest of motion and springs: not sensible. At the rule's step two equal balls
  // without dashpots have up to kn dt^2/(4 m) = 3.1 % less while they begin to touch.
  static constexpr double GROWTH = 0.04;

  explicit EnergyGuard(LAMMPS *);

  // at the set-up of a run: whether anything but contacts and gravity does work
  void start();

  // every FINITE_EVERY steps, and by check(); not collective
  void check_finite() const;

  // Collective; elastic: energy of this rank's springs (J). Returns true when the energy has
  // grown more than is sensible for the first time in this run.
  bool check(double elastic);

  double growth() const { return grown; }    // most so far, of the largest of both
  bigint seen() const { return count; }      // checks at which it was not sensible

 private:
  bool known;    // all that does work
  bool begun;
  double lowest, motion;    // energy so far, J; largest of motion and springs
  double grown;
  bigint count;
  bigint number;     // of balls, when lowest began
  double pull[3];    // gravity then

  bool contacts_alone() const;
  static bool does_no_work(const std::string &style, int mask);    // mask: as LAMMPS has it
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Energy of the balls during a run: motion and what the springs hold, less what gravity and a motion
   of the ground have put in, which is counted. Contacts take from it and give nothing, so it only
   falls; if it grows, the time step is too large or contacts were found late. And it is a number, or
   the run ends. */

#ifndef SLOPE_ENERGY_GUARD_H
#define SLOPE_ENERGY_GUARD_H

#include "pointers.h"

#include "gravity_work.h"

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

  // at the set-up of a run
  void start();

  // what does work that is not counted, so that the energy may grow; empty: nothing. For start() and the log.
  std::string unknown_work() const;

  // for the work of gravity: around each new neighbor list, and in the middle of each step
  void begin_list()
  {
    if (known) gravity.begin_list();
  }
  void end_list()
  {
    if (known) gravity.count_way();
  }
  void in_step()
  {
    if (known) gravity.count_step();
  }
  void ball_came() { came++; }

  // every FINITE_EVERY steps, and by check(); not collective
  void check_finite() const;

  // Collective; elastic: energy of this rank's springs (J). Returns true when the energy has
  // grown more than is sensible for the first time in this run.
  bool check(double elastic);

  bool balls_came() const { return new_balls; }    // between the last two checks; of all ranks
  double growth() const { return grown; }          // most so far, of the largest of both
  bigint seen() const { return count; }            // checks at which it was not sensible

 private:
  bool known;    // all that does work
  bool begun;
  GravityWork gravity;
  double lowest, motion;    // energy so far, J; largest of motion and springs
  double grown;
  bigint count;
  double came, all_came;    // balls, from nowhere: to this rank; to all until the last check
  bool new_balls;

  std::string other_forces() const;
  static bool does_no_work(const std::string &style, int mask);    // mask: as LAMMPS has it
};

}    // namespace LAMMPS_NS

#endif

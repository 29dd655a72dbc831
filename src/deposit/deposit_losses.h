/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_LOSSES_H
#define SLOPE_DEPOSIT_LOSSES_H

#include "mass_ledger.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// The ledger of a fix deposit/grid: balls that LAMMPS deletes because they left the box are counted when
// LAMMPS does it, and their places kept.
class DepositLosses : public Slope::MassLedger, protected Pointers {
 public:
  DepositLosses(class LAMMPS *lmp, const class DepositBalls &balls_in, class DepositLeft &left_in) :
      Pointers(lmp), balls(balls_in), left(left_in)
  {
  }

  // write_restart and others move the atoms to their ranks without a call of a fix, and then drop
  // those outside of the box: who was outside before and is gone afterwards was lost in the command;
  // the end is collective
  void begin_command(double now);
  void end_command();

  // LAMMPS is about to send every ball to the rank that owns its place. A ball that is beyond a fixed
  // side of the box has no owner and is deleted without a message.
  void before_exchange(double now);

  // collective: what all ranks lost since the last time; returns lines on the first balls
  std::vector<std::string> add_up();

 private:
  const class DepositBalls &balls;
  class DepositLeft &left;

  Mass mass_of(const std::vector<int> &) const;
};

}    // namespace LAMMPS_NS

#endif

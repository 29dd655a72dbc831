/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(energy/ledger,FixEnergyLedger);
// clang-format on
#else

#ifndef LMP_FIX_ENERGY_LEDGER_H
#define LMP_FIX_ENERGY_LEDGER_H

#include "fix.h"

namespace LAMMPS_NS {

class FixEnergyLedger : public Fix {
 public:
  FixEnergyLedger(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void end_of_step() override;
  double compute_vector(int) override;

 private:
  enum {
    KINETIC,
    GRAVITY,
    OTHERS,
    STORED,
    DASHPOTS,
    SLIDING,
    ROLLING,
    BEGIN_END,
    RESIDUAL,
    GROUND,
    LEFT,
    NITEM
  };

  bool begun;
  bigint balls;          // in the last step
  double shaken;         // work of the ground's motion until then, this rank's, J
  double item[NITEM];    // this rank's, J

  double kinetic() const;
};

}    // namespace LAMMPS_NS

#endif
#endif

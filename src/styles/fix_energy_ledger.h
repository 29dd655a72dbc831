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
  void end_of_step() override;
  double compute_vector(int) override;

 private:
  enum { KINETIC, GRAVITY, OTHERS, STORED, DASHPOTS, SLIDING, ROLLING, BEGIN_END, RESIDUAL, NITEM };

  bool begun;
  double first;                    // kinetic energy when the ledger began, this rank's, J
  double stored_first, springs;    // in normal springs then; their work since, this rank's, J
  double item[NITEM];              // this rank's, J

  double kinetic() const;
  double gravity() const;
};

}    // namespace LAMMPS_NS

#endif
#endif

/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(DEPOSIT_GRID_PART,FixDepositGridPart);
// clang-format on
#else

#ifndef LMP_FIX_DEPOSIT_GRID_PART_H
#define LMP_FIX_DEPOSIT_GRID_PART_H

#include "fix.h"

#include <string>

namespace LAMMPS_NS {

// A piece of what a fix deposit/grid has in restart files. That fix adds it; it does nothing else.
// fix ID all DEPOSIT_GRID_PART FIX-ID PIECE
class FixDepositGridPart : public Fix {
 public:
  FixDepositGridPart(class LAMMPS *, int, char **);
  int setmask() override { return 0; }
  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  std::string deposit_id;
  int piece;

  class FixDepositGrid *deposit() const;
};

}    // namespace LAMMPS_NS

#endif
#endif

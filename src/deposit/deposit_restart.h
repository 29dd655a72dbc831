/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RESTART_H
#define SLOPE_DEPOSIT_RESTART_H

#include "archive.h"
#include "deposit_options.h"
#include "deposit_rasters.h"
#include "deposit_release.h"
#include "mass_ledger.h"
#include "pointers.h"

#include <cstdio>
#include <string>

namespace LAMMPS_NS {

// What fix deposit/grid has in restart files: numbers, and the cells that the mass touched. LAMMPS gives a
// fix at most 2 GB there: cells that need more are left out, with a warning, and such a file is refused.
// write(): by rank 0, the others do nothing; read(): on all ranks, the cells go to rank 0.
class DepositRestart : protected Pointers {
 public:
  struct Saved {    // numbers only
    double started;
    DepositRelease::Released released;
    double bulk;
    Slope::MassLedger::Mass lost;
    double nlogged, elapsed, snapshot_time, change;
  };

  DepositRestart(class LAMMPS *, const DepositOptions &);

  void write(FILE *, const std::string &fix_id, Saved, const Slope::DepositRasters &) const;
  void read(const std::string &fix_id, const char *buffer, Saved &, Slope::DepositRasters &) const;

 private:
  struct Key {
    double cell, nx, ny, xlo, ylo, bulk;
  };

  const Slope::PlanGrid &grid;
  const double bulk;

  void archive(Slope::Archive &, Saved &) const;
  static void check_key(const Key &found, const Key &mine);
};

}    // namespace LAMMPS_NS

#endif

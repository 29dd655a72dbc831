/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_RESTART_H
#define SLOPE_DEPOSIT_RESTART_H

#include "deposit_exchange.h"
#include "deposit_options.h"
#include "deposit_pieces.h"
#include "deposit_rasters.h"
#include "deposit_release.h"
#include "mass_ledger.h"
#include "pointers.h"

#include <cstdio>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// What fix deposit/grid has in restart files: numbers, and the cells that the mass touched. LAMMPS
// gives a fix at most 2 GB there, so the cells of a large grid are in several pieces: the first one is
// the fix's, each other one that of a fix DEPOSIT_GRID_PART, which this class adds and removes.
// All methods are collective.
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

  void add_parts(const std::string &fix_id);
  void remove_parts();

  // saved: in the first piece
  void write(FILE *, int piece, const Saved &, const Slope::DepositRasters &);
  void read(const std::string &fix_id, const char *buffer, int piece, Saved &,
            Slope::DepositRasters &) const;

 private:
  struct Key {
    double format, cell, nx, ny, xlo, ylo, bulk;
  };

  Key key;
  Slope::DepositPieces pieces;
  DepositExchange exchange;
  std::vector<std::string> parts;    // IDs of the fixes

  static double most_bytes(class LAMMPS *);
  void check_key(const std::string &fix_id, const Key &) const;
};

}    // namespace LAMMPS_NS

#endif

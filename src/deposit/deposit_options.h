/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_OPTIONS_H
#define SLOPE_DEPOSIT_OPTIONS_H

#include "plan_grid.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

// The arguments of fix deposit/grid, each checked where it is read; wrong ones end the run.
class DepositOptions : protected Pointers {
 public:
  DepositOptions(class LAMMPS *, int narg, char **arg);

  int nevery, nfreq, window;
  std::string terrain, prefix;    // region of the ground; begins all names of files
  double cell, motion;
  double bulk;         // volume of the ground / volume of the balls; 0: from body
  std::string body;    // region of the released ground; empty: bulk was given
  bool series;
  Slope::PlanGrid grid;

 private:
  int narg, iarg;
  char **arg;
  bool extent_set;
  double extent[4];

  const char *text(int k) const;
  double positive() const;
  int keyword();
  int read_bulk();
  int read_window();
  int read_series();
  int read_extent();
  void check() const;
  void make_grid();
};

}    // namespace LAMMPS_NS

#endif

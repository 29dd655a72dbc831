/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_OPTIONS_H
#define SLOPE_DEPOSIT_OPTIONS_H

#include "pointers.h"

#include "constants.h"
#include "plan_grid.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// What the arguments of fix deposit/grid say. Wrong ones end the run with one line.
class DepositOptions : protected Pointers {
 public:
  DepositOptions(class LAMMPS *, int narg, char **arg);

  int nevery, nfreq, window = 0;
  std::string terrain, prefix;          // region of the ground; begins all names of files
  double cell = 0.0, motion = 0.1;      // m, m/s
  double rest = 0.01;                   // of the released volume: less is fast in a mass at rest
  double bulk = Slope::SIMPLE_CUBIC;    // volume of the ground / volume of the balls; 0: from body
  std::string body;                     // region of the released ground; empty: bulk was given
  bool series = false;
  Slope::PlanGrid grid;

 private:
  std::vector<double> extent;    // empty: that of the terrain

  void read_keywords(int narg, char **arg);
  void check() const;
  void make_grid();
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_REPORT_H
#define SLOPE_DEPOSIT_REPORT_H

#include "archive.h"
#include "contact_guards.h"
#include "deposit_options.h"
#include "deposit_rasters.h"
#include "deposit_release.h"
#include "deposit_summary.h"
#include "pointers.h"
#include "prefix_lock.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// State of the mass after a sample of fix deposit/grid, the same on all ranks.
struct DepositResults {
  enum {    // the fix's vector
    RELEASED,
    ON_GRID,
    OFF_GRID,
    LOST,
    RESIDUAL,
    CHANGE,
    FRONT,
    REACH,
    CENTROID,
    NLOST,
    FAST_SHARE,
    NUMBER
  };
  static bool extensive(int k) { return k <= RESIDUAL || k == NLOST; }

  double vector[NUMBER];
  double present;    // number of balls
  double time;
  DepositRelease::Released released;
};

// The output of fix deposit/grid: warnings, rasters and summary. All methods are collective.
class DepositReport : protected Pointers {
 public:
  DepositReport(class LAMMPS *, const std::string &fix_id, const DepositOptions &,
                const class DepositBalls &);

  // files that cannot be written end the run before it begins, not at its end
  void begin_run();

  // what the guards of the contacts found: begin at the set-up of a run, which they begin with nothing; note
  // when it is asked for; nullptr: no such guards
  void begin_guards();
  void note_guards(const ContactGuards *);

  // why a run ended
  std::string reason() const;

  // to the screen, the log and the summary
  void warn(const std::string &);

  // all files, or none; rasters, left (the text of PREFIX.left.csv): those of rank 0
  void write(const std::string &reason, const DepositResults &, const Slope::DepositRasters &,
             const std::string &left, const ContactGuards *);

  void archive(Slope::Archive &);    // members of a restart file

 private:
  const std::string fix_id;
  const DepositOptions &options;
  const class DepositBalls &balls;
  double limit, limit_set;    // wall time that the run has, when that was known; s
  std::vector<std::string> warnings, of_guards;    // so far, on rank 0
  ContactGuards::Found before;                     // in the runs before
  ContactGuards::Found last;                       // in this one, when it was noted last

  Slope::PrefixLock lock;    // on rank 0

  Slope::DepositSummary summary(const std::string &reason, const DepositResults &) const;
  void add_lost(Slope::DepositSummary &) const;
};

}    // namespace LAMMPS_NS

#endif

/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(deposit/grid,FixDepositGrid);
// clang-format on
#else

#ifndef LMP_FIX_DEPOSIT_GRID_H
#define LMP_FIX_DEPOSIT_GRID_H

#include "fix.h"

#include "deposit_balls.h"
#include "deposit_bins.h"
#include "deposit_options.h"
#include "deposit_rasters.h"
#include "deposit_release.h"
#include "deposit_summary.h"
#include "mass_ledger.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixDepositGrid : public Fix {
 public:
  FixDepositGrid(class LAMMPS *, int, char **);
  ~FixDepositGrid() override;
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup(int) override;
  void pre_exchange() override;
  void end_of_step() override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

  // for fix control/line
  double bulk() const { return balls.bulk(); }    // bulk volume / volume of a ball; 0: not known yet
  const std::string &terrain() const { return options.terrain; }    // region of the ground

 private:
  static constexpr int NRESULT = 11;

  const DepositOptions options;
  DepositBalls balls;

  // --- what was released: the group at the first set-up ---

  struct Released {
    DepositRelease::Mass mass;
    double volume;    // bulk
    double body;      // volume of the region that the balls stand for; 0 without
    double front;     // plan distance of the farthest ball from the top
  };
  Released released;
  bool started, fresh;    // fresh: nothing was sampled yet

  void start();
  void log_release() const;

  // --- balls that LAMMPS deletes because they left the box ---

  Slope::MassLedger ledger;

  void settle_outside();
  void log_losses(double before);

  // --- sampling: every rank bins its balls, rank 0 adds up ---

  Slope::DepositBins bins;
  Slope::DepositRasters rasters;    // on rank 0 only, but for times and change
  bigint sampled;                   // step of the last sample
  double result[NRESULT];           // the fix's vector
  double present;                   // number of balls
  bool warned;

  void sample(bool record);
  void tell_balance();
  double add_windows(bool record);
  void take_snapshot();

  // --- time since the first set-up, whatever the deck does to steps and time step ---

  double elapsed, offset;
  double clock() const;
  double now() const { return offset + clock(); }

  // --- files ---

  double limit, limit_set;              // wall time that the run has, when that was known; s
  std::vector<std::string> warnings;    // so far, on rank 0

  template <typename... Args> void warn(const char *format, const Args &...args);
  void check_folder();
  std::string reason() const;
  void write_files(const std::string &reason);
  Slope::DepositSummary summary(const std::string &reason) const;
  void add_guards(Slope::DepositSummary &) const;

  // --- restart: this, and the cells that the mass touched ---

  struct Key {
    double format, cell, nx, ny, xlo, ylo, bulk;
  };
  struct Saved {
    double started;
    Released released;
    double bulk;
    Slope::MassLedger::Mass lost;
    double nlogged, elapsed, snapshot_step, snapshot_time, change;
  };
  Key restart_key() const;
  void check_key(const Key &) const;
};

}    // namespace LAMMPS_NS

#endif
#endif

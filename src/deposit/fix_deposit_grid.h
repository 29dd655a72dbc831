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

#include "archive.h"
#include "deposit_balls.h"
#include "deposit_bins.h"
#include "deposit_left.h"
#include "deposit_options.h"
#include "deposit_rasters.h"
#include "deposit_release.h"
#include "deposit_report.h"

#include <string>

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

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

  // for fix control/line
  // bulk volume / volume of a ball; 0: not known yet
  double bulk() const { return balls.bulk(); }
  const std::string &terrain() const { return options.terrain; }    // region of the ground

 private:
  const DepositOptions options;
  DepositBalls balls;
  DepositLeft left;
  DepositReport report;

  Slope::DepositBins bins;          // of the balls of this rank
  Slope::DepositRasters rasters;    // on rank 0
  DepositResults results;

  bool started, fresh;    // the mass was released; and nothing was sampled yet
  bigint set_up = -1;     // step of the last set-up
  bigint sampled;         // step of the last sample
  bool warned;            // that the balance does not close
  bool kept_by_atom;

  void make_rasters();
  void start();
  void sample(bool record);
  double add_bins(bool record);
  double of_rank_zero(double) const;
  void find_travel(const DepositBalls::Sums &);
  void check_balance();
  void take_snapshot();
  void write_files(const std::string &reason);
  const ContactGuards *guards() const;    // of the contacts; nullptr: another pair style
  void archive(Slope::Archive &);         // members of a restart file

  // --- time since the first set-up, whatever the deck does to steps and time step ---

  double elapsed, offset;
  double clock() const;
  double now() const { return offset + clock(); }
};

}    // namespace LAMMPS_NS

#endif
#endif

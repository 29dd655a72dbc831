/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(control/line,FixControlLine);
// clang-format on
#else

#ifndef LMP_FIX_CONTROL_LINE_H
#define LMP_FIX_CONTROL_LINE_H

#include "fix.h"

#include "archive.h"
#include "crossing_log.h"
#include "plan_line.h"
#include "prefix_lock.h"
#include "run_clock.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixControlLine : public Fix {
 public:
  FixControlLine(class LAMMPS *, int, char **);
  ~FixControlLine() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_integrate() override;
  void end_of_step() override;
  void post_run() override;
  void reset_dt() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  static constexpr int NRESULT = 5;

  std::string file, prefix, deposit_id;
  double lower;              // the balls lie so much lower than their ground
  Slope::PrefixLock lock;    // on rank 0
  Slope::PlanLine line;
  Slope::RunClock clock;
  class FixDepositGrid *deposit;
  bigint set_up = -1;    // step of the last set-up
  std::unique_ptr<class RegionSurface> ground;

  // balls of this rank that may cross before the neighbor lists are built again, and where they were at
  // the end of the last step; the order of the atoms stays until balls have moved in the next one
  std::vector<int> watched;
  std::vector<double> places;
  int number = 0;           // of the balls of this rank when they were chosen
  bool some = false;        // not all of them are watched
  double skin = 0.0;        // of the neighbor lists in this run
  double farthest = 0.0;    // that a ball which is not watched may move in a step

  std::vector<Slope::PlanLine::Crossing> found;    // of one path
  std::vector<Slope::CrossingLog::Event> fresh;    // of this rank, since collect()
  Slope::CrossingLog log;                          // of all ranks, on rank 0
  double result[NRESULT];

  void read_keywords(int, char **);
  void read_line();
  void find_deposit();
  void check_line() const;
  bool lists_follow_motion() const;
  void watch();
  void remember();
  void test(int, const double *from);
  void test_fast();
  void note(int, const double *, const double *, const Slope::PlanLine::Crossing &);
  void collect();
  void write_files();
  std::string summary() const;
  void archive(Slope::Archive &,
               std::vector<Slope::CrossingLog::Event> &);    // members of a restart file
};

}    // namespace LAMMPS_NS

#endif
#endif

/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(ground/motion,FixGroundMotion);
// clang-format on
#else

#ifndef LMP_FIX_GROUND_MOTION_H
#define LMP_FIX_GROUND_MOTION_H

#include "fix.h"

#include "archive.h"
#include "continuation.h"
#include "motion_record.h"
#include "run_clock.h"

#include <string>

namespace LAMMPS_NS {

class FixGroundMotion : public Fix, public Kick {
 public:
  FixGroundMotion(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_pre_force(int) override;
  void initial_integrate(int) override;
  void post_integrate() override;
  void final_integrate() override;
  void reset_dt() override;
  double compute_vector(int) override;
  void *extract(const char *, int &) override;
  void take_back_kick() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  std::string file;
  double scale, start;
  Slope::MotionRecord record;
  Slope::RunClock clock;

  int kicked;    // group bits of the balls that follow: nve integrates them
  int placed;    // of those that have been moved already when this fix has its turn
  int frozen;    // of fix freeze

  double ground[3];       // velocity up to which the balls have been kicked
  double last_kick[3];    // over the second half of the last step
  double work;            // of the motion on balls of this rank, J

  void read_keywords(int, char **);
  void read_record();
  void announce() const;
  bool follows(int mask) const { return (mask & groupbit) && (mask & kicked) && !(mask & frozen); }
  void check_integrators();
  void kick_until(double time, bool first_half);
  void archive(Slope::Archive &);    // members of a restart file
};

}    // namespace LAMMPS_NS

#endif
#endif

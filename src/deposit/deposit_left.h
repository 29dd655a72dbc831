/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_LEFT_H
#define SLOPE_DEPOSIT_LEFT_H

#include "pointers.h"

#include "archive.h"
#include "ball_path.h"
#include "deposit_bins.h"
#include "restart_archive.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Which balls of fix deposit/grid left the ground of its rasters, the edge of the grid or of the terrain's data,
// and where; and which left the box, and are lost. Looked at at each sample of the maxima, so that a run that was cut
// sees the same; what is asked for in between is found from the places of that moment.
class DepositLeft : protected Pointers {
 public:
  DepositLeft(class LAMMPS *, const class DepositBalls &, const class DepositOptions &);
  ~DepositLeft() override;

  void begin_run();           // the ground as it is now; collective
  void sample(double now);    // all balls of this rank

  // --- what LAMMPS deletes ---

  // LAMMPS is about to send every ball to the rank that owns its place. A ball that is beyond a fixed
  // side of the box has no owner and is deleted without a message.
  void before_exchange(double now);

  // write_restart and others move the atoms to their ranks without a call of a fix, and then drop
  // those outside of the box: who was outside before and is gone afterwards was lost in the command;
  // the end is collective
  void begin_command(double now);
  void end_command();

  // collective: adds what all ranks lost since the last time; returns lines on the first balls
  std::vector<std::string> add_up_lost();
  double lost_number, lost_volume;    // so far; bulk
  int nlogged;                        // losses that got a line so far

  // of all ranks, on rank 0; collective
  std::string csv(double now) const;

  // --- storage by atom, exchange, restart files ---

  void grow(int nmax) { paths.resize(nmax); }
  void copy(int i, int j) { paths[j] = paths[i]; }
  void clear(int i) { paths[i] = Slope::BallPath(); }
  int pack(int i, double *buf) const;
  int unpack(int i, const double *buf);
  static constexpr int RESTART = 1 + Slope::BallPath::NUMBERS;
  int pack_restart(int i, double *buf) const;
  void unpack_restart(int i, int nth);
  void check_restart(const std::string &caller) const { extra.check(caller); }    // collective
  void collect();                    // for archive(), which rank 0 writes; collective
  void archive(Slope::Archive &);    // members of a restart file

  double bytes() const;

 private:
  const class DepositBalls &balls;
  const class DepositOptions &options;
  std::unique_ptr<class RegionSurface> ground;
  RestartExtra extra;

  std::vector<Slope::BallPath> paths;       // of the atoms of this rank
  double sampled;                           // time of the last sample; NaN: none yet
  std::vector<Slope::LeftBall> gone;        // no longer there; on any rank
  std::vector<Slope::LeftBall> doubtful;    // may be gone when the command ends

  double lost_here[2];    // number, volume, of this rank since add_up_lost()
  struct Place {          // numbers only, so that ranks can send them
    double tag, x[3], step;
  };
  std::vector<Place> first_lost;    // of this rank, as many as get a line

  // of a ground that is no raster, whose height takes long: whether there is ground everywhere in a cell
  enum { UNKNOWN = -1, SOMEWHERE, EVERYWHERE };
  mutable Slope::DepositBlocks<1> cells;

  bool over_ground(const double *x) const;
  bool everywhere(int i, int j) const;
  Slope::BallPath path_now(int i, double now) const;
  Slope::LeftBall left_ball(int i, const Slope::BallPath &) const;
  Slope::LeftBall lost_ball(int i, double now) const;
  void wrap(double *x) const;
};

}    // namespace LAMMPS_NS

#endif

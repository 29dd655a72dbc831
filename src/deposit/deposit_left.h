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
// and where. Looked at at each sample of the maxima, so that a run that was cut sees the same; what is asked for in
// between is found from the places of that moment.
class DepositLeft : protected Pointers {
 public:
  DepositLeft(class LAMMPS *, const class DepositBalls &, const struct DepositOptions &);
  ~DepositLeft() override;

  void begin_run();           // the ground as it is now; collective
  void sample(double now);    // all balls of this rank

  // --- what LAMMPS deletes ---

  void lose(int i, double now);    // a ball of this rank, which is about to go

  // balls that are outside of the box when a command begins, and may be gone when it ends; collective: still are
  // those that are there then
  void begin_command(const std::vector<int> &outside, double now);
  void end_command(const std::vector<int> &still);

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
  const struct DepositOptions &options;
  std::unique_ptr<class RegionSurface> ground;
  RestartExtra extra;

  std::vector<Slope::BallPath> paths;       // of the atoms of this rank
  double sampled;                           // time of the last sample; NaN: none yet
  std::vector<Slope::LeftBall> gone;        // no longer there; on any rank
  std::vector<Slope::LeftBall> doubtful;    // may be gone when the command ends

  // of a ground that is no raster, whose height takes long: whether there is ground everywhere in a cell
  enum { UNKNOWN = -1, SOMEWHERE, EVERYWHERE };
  mutable Slope::DepositBlocks<1> cells;

  bool over_ground(const double *x) const;
  bool everywhere(int i, int j) const;
  Slope::BallPath path_now(int i, double now) const;
  Slope::LeftBall left_ball(int i, const Slope::BallPath &) const;
  void wrap(double *x) const;
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_BALLS_H
#define SLOPE_DEPOSIT_BALLS_H

#include "deposit_bins.h"
#include "deposit_summary.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

// The balls of the group of fix deposit/grid, where they are now. A ball represents a cube of
// ground, whose volume is that of the ball times the bulk factor.
class DepositBalls : protected Pointers {
 public:
  static constexpr double BALANCE = 1.0e-9;    // rounding, of the released volume

  DepositBalls(class LAMMPS *, int groupbit, double bulk);

  void set_bulk(double);
  double bulk() const { return factor; }    // 0: not known yet, the balls have no volume

  // --- of this rank ---

  bool selected(int i) const;             // whether an atom is in the group
  void unwrap(int i, double *x) const;    // its place, which does not jump at periodic sides

  double volume_of(int i) const;    // bulk

  std::vector<int> outside() const;    // those that are outside of the box

  // --- of all ranks; collective ---

  // those of this rank into the cells of a grid; what those of all ranks add up to
  struct Sums {
    double number, off_grid, mass, mass_x, mass_y, fast;    // fast: volume of the fast ones
  };
  Sums bin(Slope::DepositBins &) const;

  double volume() const;    // bulk

  // plan distance of the ball that is farthest from a place, and its height; false, and 0, if
  // there is no ball
  bool farthest(const double *place, double &distance, double &z) const;

  // distance and reach angle, seen from a place, that shares of the released volume stay within; lost: how much
  // of it is no longer there, and went farther
  std::vector<Slope::DepositSummary::Quantile> quantiles(const double *place, double lost) const;

  // all but the shares; moving: volume of the balls faster than threshold
  Slope::DepositSummary::Motion motion(double threshold, double &moving) const;

 private:
  int groupbit;
  double factor;         // bulk
  double side_factor;    // side of a cube / diameter
  const double fast;     // speed

  double side_of(int i) const;
  double speed_of(int i) const;
  void seen_from(const double *place, int i, double &distance, double &angle) const;
};

}    // namespace LAMMPS_NS

#endif

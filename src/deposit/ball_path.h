// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BALL_PATH_H
#define SLOPE_BALL_PATH_H

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace Slope {

// A ball that left the ground and did not return, in plan. Numbers only, so that ranks can send them.
struct LeftBall {
  double tag, volume;    // bulk
  double time, x[2];     // when, and where, it left
  double from[2];        // where it started
};

// PREFIX.left.csv, by time and ball: the same whatever ranks there were
std::string left_csv(std::vector<LeftBall>);

// What is kept of a ball in plan, to know where it leaves the ground: numbers only, NUMBERS of them. One that returns is
// as one that never left.
struct BallPath {
  static constexpr int NUMBERS = 5;
  double start[2];    // NaN: not seen yet
  double at[2];       // where it was last seen above ground, or where it left
  double left;        // when; NaN: it is above ground

  BallPath() : start{NONE(), NONE()}, at{NONE(), NONE()}, left(NONE()) {}
  bool is_out() const { return !std::isnan(left); }

  // It is now at x; it was last seen at the time before. over_ground(x): whether there is any. Where it left is
  // the last place above ground on the straight way from where it was seen there.
  template <typename Ground>
  void move(const double *x, double before, double now, const Ground &over_ground)
  {
    if (std::isnan(start[0])) take(start, x);
    if (over_ground(x)) {
      take(at, x);
      left = NONE();
    } else if (!is_out()) {
      left = now;
      if (std::isnan(at[0]))
        take(at, x);
      else
        left = before + (now - before) * leave(x, over_ground);
    }
  }

 private:
  static constexpr int HALVINGS = 40;

  static double NONE() { return std::numeric_limits<double>::quiet_NaN(); }
  static void take(double *to, const double *from)
  {
    to[0] = from[0];
    to[1] = from[1];
  }

  // moves it to the edge; returns the part of the way
  template <typename Ground> double leave(const double *x, const Ground &over_ground)
  {
    const double way[2] = {x[0] - at[0], x[1] - at[1]};
    double above = 0.0, beyond = 1.0;
    for (int k = 0; k < HALVINGS; k++) {
      const double part = 0.5 * (above + beyond);
      const double place[2] = {at[0] + part * way[0], at[1] + part * way[1]};
      (over_ground(place) ? above : beyond) = part;
    }
    at[0] += above * way[0];
    at[1] += above * way[1];
    return above;
  }
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CROSSING_LOG_H
#define SLOPE_CROSSING_LOG_H

#include <string>
#include <vector>

namespace Slope {

// What has crossed a control line, and what a designer needs to know of it.
class CrossingLog {
 public:
  // One ball crosses once. Numbers only, so that ranks can send them.
  struct Event {
    double time, step, tag;
    double direction;    // 1: forward, -1: back
    double along, x[3];
    double height;    // of the ball's centre above the ground; NaN: no ground there
    double v[3], speed;
    double energy;    // of motion and spin
    double volume;    // bulk
    double diameter;
  };

  struct Way {
    double crossings, balls, volume;    // balls: each counts once
  };
  struct Largest {
    double speed, height, energy;
  };

  std::vector<Event> events;    // in any order until sort()

  // by time and ball: the same order whatever ranks there were, and if steps are counted anew
  void sort();

  Way way(int direction) const;

  // the way that more volume went, 1 or -1: forward unless more went back
  int main_direction() const;

  // Of the crossings in the main direction: what a share of them (0 to 1) stays at or below; 1: the
  // largest. Heights without ground do not count. 0 if there are none.
  Largest quantile(double share) const;

  std::string csv() const;     // a line for each event
  std::string yaml() const;    // volumes, largest values, quantiles
};

}    // namespace Slope

#endif

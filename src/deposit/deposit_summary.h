// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DEPOSIT_SUMMARY_H
#define SLOPE_DEPOSIT_SUMMARY_H

#include "plan_grid.h"

#include <cstdint>
#include <string>
#include <vector>

namespace Slope {

static constexpr double SHARES[] = {0.5, 0.9, 0.95, 0.99};    // that quantiles are of

// Content of PREFIX.summary.yaml. Units are those of the run, angles in degrees,
// volumes are bulk unless stated otherwise.
struct DepositSummary {
  static constexpr double MOVING_SHARE = 0.1;    // of the volume: more is a mass in motion
  static constexpr double FAST = 0.1;    // m/s: faster than this is fast, in other units too

  // --- versions, the run ---

  std::string slope_version, lammps_version, fix;
  int64_t step;
  double time, dt;
  int ranks;
  std::string reason;    // why the run ended: "halted", "time limit", "run completed"; "running"
  PlanGrid grid;

  // --- what was released ---

  struct Released {    // numbers only, for restart files
    struct Mass {
      double number;
      double solid;     // volume of the balls
      double x, y;      // centre of mass
      double top[3];    // place of the highest ball, of several the one with the lowest ID
    } mass;
    double volume;              // bulk
    double body;                // volume of the region that the balls stand for; 0 without
    double thick;               // largest vertical thickness of it
    double front;               // plan distance of the farthest ball from the top
    double stiffness_number;    // K of the contacts; 0: unknown
  } released;
  std::string region;    // that body, empty: the bulk factor was given
  double bulk_factor;
  double from_cubic() const;    // bulk_factor / (6/pi) - 1

  // --- where it is ---

  double present, lost;    // numbers of balls
  struct Volume {
    double on_grid, off_grid, lost, residual;
  } volume;

  struct Reach {
    double distance, angle;
  };
  struct Quantile {
    double share;    // of the released volume stays within; infinite: unknown, balls were lost
    Reach reach;
  };
  struct Travel {
    double centroid;
    Reach farthest;
    std::vector<Quantile> quantiles;
  } travel;

  struct Largest {
    double thickness, max_thickness, max_speed, max_energy;
  } largest;

  // --- how it moves now ---

  struct Motion {
    double threshold, largest, median, moving_share, fast_volume;
    double fast_share;    // of the released volume
    double fast;          // speed from which on a ball is fast
  } motion;
  double change_rate;
  double rest_share;    // of the released volume: less may be fast in a mass at rest

  // the run ended by its criterion of rest and little is fast; a run that was cut never is at rest
  bool at_rest() const { return reason == "halted" && motion.fast_share < rest_share; }

  // --- findings of the guards, warnings ---

  struct Guards {
    bool known;
    double deepest, energy_growth;
    int64_t deep, dangerous_builds;
  } guards;
  std::vector<std::string> warnings, files;

  std::string text() const;    // YAML

 private:
  void write_run(std::string &) const;
  void write_release(std::string &) const;
  void write_travel(std::string &) const;
  void write_motion(std::string &) const;
  void write_findings(std::string &) const;
};

}    // namespace Slope

#endif

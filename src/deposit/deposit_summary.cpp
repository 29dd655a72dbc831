// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_summary.h"

#include "constants.h"
#include "yaml_text.h"

using namespace Slope;
using namespace Slope::yaml;

/* ---------------------------------------------------------------------- */

double DepositSummary::from_cubic() const
{
  return bulk_factor / SIMPLE_CUBIC - 1.0;
}

/* ----------------------------------------------------------------------
   Some values stand in it twice, as readers of it know both: bulk_factor, released balls, step and time (stop),
   front and reach_angle (farthest), largest_speed (fast_speed).
------------------------------------------------------------------------- */

std::string DepositSummary::text() const
{
  std::string s;
  write_run(s);
  write_release(s);
  write_travel(s);
  write_motion(s);
  write_findings(s);
  return s;
}

/* ---------------------------------------------------------------------- */

void DepositSummary::write_run(std::string &s) const
{
  s += "# fix deposit/grid of the SLOPE package for LAMMPS; units of the run, angles in degrees\n";
  line(s, "slope_version", quoted(slope_version));
  line(s, "lammps_version", quoted(lammps_version));
  line(s, "fix", quoted(fix));
  line(s, "step", std::to_string(step));
  line(s, "time", real(time));
  line(s, "dt", real(dt));
  line(s, "ranks", std::to_string(ranks));
  line(s, "bulk_factor", real(bulk_factor));
  s += "grid:\n";
  line(s, "  cell", real(grid.cell));
  line(s, "  columns", std::to_string(grid.n[0]));
  line(s, "  rows", std::to_string(grid.n[1]));
  line(s, "  extent",
       "[" + real(grid.lo[0]) + ", " + real(grid.hi[0]) + ", " + real(grid.lo[1]) + ", " +
           real(grid.hi[1]) + "]");
}

/* ---------------------------------------------------------------------- */

void DepositSummary::write_release(std::string &s) const
{
  const bool body = !region.empty();
  s += "release:  # from_cubic: bulk_factor / (6/pi) - 1; ball_volume: solid\n";
  line(s, "  region", body ? quoted(region) : "null");
  line(s, "  body_volume", body ? real(released.body) : "null");
  line(s, "  ball_volume", real(released.mass.solid));
  line(s, "  balls", count(released.mass.number));
  line(s, "  bulk_factor", real(bulk_factor));
  line(s, "  from_cubic", real(from_cubic()));
  line(s, "  thickness", body ? real(released.thick) : "null");
  line(s, "  stiffness_number",
       (released.stiffness_number > 0.0 ? real(released.stiffness_number) : "null") +
           "  # kn / (density of the ground x gravity x thickness x diameter)");
  s += "balls:\n";
  line(s, "  released", count(released.mass.number));
  line(s, "  present", count(present));
  line(s, "  lost", count(lost));
  s += "volume:  # bulk; released = on_grid + off_grid + lost + residual\n";
  line(s, "  released", real(released.volume));
  line(s, "  on_grid", real(volume.on_grid));
  line(s, "  off_grid", real(volume.off_grid));
  line(s, "  lost", real(volume.lost));
  line(s, "  residual", real(volume.residual));
}

/* ---------------------------------------------------------------------- */

void DepositSummary::write_travel(std::string &s) const
{
  s += "travel:  # in plan, from top, the highest released ball; front: of the farthest ball\n";
  const double *top = released.mass.top;
  line(s, "  top", "[" + real(top[0]) + ", " + real(top[1]) + ", " + real(top[2]) + "]");
  line(s, "  front", real(travel.farthest.distance));
  line(s, "  front_at_release", real(released.front));
  line(s, "  centroid", real(travel.centroid));
  line(s, "  reach_angle", real(travel.farthest.angle));
  line(s, "  farthest",
       "{distance: " + real(travel.farthest.distance) +
           ", reach_angle: " + real(travel.farthest.angle) + "}");
  s += "  quantiles:  # this share of the released volume stays within; null: beyond where balls "
       "were lost\n";
  for (const Quantile &q : travel.quantiles)
    s += "    - {share: " + real(q.share) + ", distance: " + real(q.reach.distance) +
        ", reach_angle: " + real(q.reach.angle) + "}\n";
  s += "largest:\n";
  line(s, "  thickness", real(largest.thickness));
  line(s, "  max_thickness", real(largest.max_thickness));
  line(s, "  max_speed", real(largest.max_speed));
  line(s, "  max_energy", real(largest.max_energy));
}

/* ---------------------------------------------------------------------- */

void DepositSummary::write_motion(std::string &s) const
{
  s += "motion:  # of the balls now; moving_share: of the volume, faster than threshold; fast: "
       "than " +
      real(motion.fast) + "\n";
  line(s, "  threshold", real(motion.threshold));
  line(s, "  largest_speed", real(motion.largest));
  line(s, "  median_speed", real(motion.median));
  line(s, "  moving_share", real(motion.moving_share));
  line(s, "  fast_share", real(motion.fast_share) + "  # of the released volume");
  line(s, "  fast_volume", real(motion.fast_volume));
  line(s, "  fast_speed", real(motion.largest));
  line(s, "  rest_share", real(rest_share) + "  # at rest, fast_share is below it");
  line(s, "change_rate",
       real(change_rate) + "  # share of the volume that changes cell, per second");
  line(s, "moving", motion.moving_share > MOVING_SHARE ? "true" : "false");
  line(s, "at_rest",
       std::string(at_rest() ? "true" : "false") + "  # ended by its halt, and fast_share < " +
           real(rest_share));
}

/* ---------------------------------------------------------------------- */

void DepositSummary::write_findings(std::string &s) const
{
  if (guards.known) {
    s += "guards:  # overlap: of the smaller radius; growth: of the largest kinetic and spring "
         "energy\n";
    line(s, "  largest_overlap", real(guards.deepest));
    line(s, "  deep_contacts", std::to_string(guards.deep));
    line(s, "  energy_growth", real(guards.energy_growth));
    line(s, "  dangerous_builds", std::to_string(guards.dangerous_builds));
  }
  s += warnings.empty() ? "warnings: []\n" : "warnings:\n";
  for (const std::string &warning : warnings) s += "  - " + quoted(warning) + "\n";
  s += "stop:\n";
  line(s, "  step", std::to_string(step));
  line(s, "  time", real(time));
  line(s, "  reason", quoted(reason));
  s += "files:\n";
  for (const std::string &file : files) s += "  - " + quoted(file) + "\n";
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "crossing_log.h"

#include "deposit_summary.h"
#include "yaml_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

using namespace Slope;
using namespace Slope::yaml;

static constexpr double ROUNDING = 1.0e-12;    // 0.95 of 20 is the 19th

/* ---------------------------------------------------------------------- */

void CrossingLog::sort()
{
  std::sort(events.begin(), events.end(), [](const Event &a, const Event &b) {
    if (a.time != b.time) return a.time < b.time;
    if (a.tag != b.tag) return a.tag < b.tag;
    return a.along < b.along;
  });
}

/* ---------------------------------------------------------------------- */

CrossingLog::Way CrossingLog::way(int direction) const
{
  Way found = {0.0, 0.0, 0.0};
  std::set<double> balls;
  for (const Event &e : events) {
    if (e.direction * direction < 0.0) continue;
    found.crossings++;
    found.volume += e.volume;
    balls.insert(e.tag);
  }
  found.balls = (double) balls.size();
  return found;
}

int CrossingLog::main_direction() const
{
  return way(-1).volume > way(1).volume ? -1 : 1;
}

/* ---------------------------------------------------------------------- */

static double value_at(std::vector<double> &values, double share)
{
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil((share - ROUNDING) * values.size());
  return values[(size_t) std::min(std::max(rank - 1.0, 0.0), values.size() - 1.0)];
}

CrossingLog::Largest CrossingLog::quantile(double share) const
{
  std::vector<double> speeds, heights, energies;
  const int direction = main_direction();
  for (const Event &e : events) {
    if (e.direction * direction < 0.0) continue;
    speeds.push_back(e.speed);
    energies.push_back(e.energy);
    if (std::isfinite(e.height)) heights.push_back(e.height);
  }
  return {value_at(speeds, share), value_at(heights, share), value_at(energies, share)};
}

/* ---------------------------------------------------------------------- */

std::string CrossingLog::csv() const
{
  std::string s =
      "time,step,ball,direction,along,x,y,z,height,vx,vy,vz,speed,energy,volume,diameter\n";
  for (const Event &e : events) {
    char text[512];
    snprintf(text, sizeof(text), "%.10g,%.0f,%.0f,%.0f,%.10g,%.10g,%.10g,%.10g,", e.time, e.step,
             e.tag, e.direction, e.along, e.x[0], e.x[1], e.x[2]);
    s += text;
    if (std::isfinite(e.height)) {
      snprintf(text, sizeof(text), "%.10g", e.height);
      s += text;
    }
    snprintf(text, sizeof(text), ",%.10g,%.10g,%.10g,%.10g,%.10g,%.15g,%.10g\n", e.v[0], e.v[1],
             e.v[2], e.speed, e.energy, e.volume, e.diameter);
    s += text;
  }
  return s;
}

/* ---------------------------------------------------------------------- */

static std::string three(const CrossingLog::Largest &values)
{
  return "speed: " + real(values.speed) + ", height: " + real(values.height) +
      ", energy: " + real(values.energy) + "}\n";
}

std::string CrossingLog::yaml() const
{
  std::string s;
  const Way ways[2] = {way(1), way(-1)};
  for (int k = 0; k < 2; k++)
    s += std::string(k ? "back" : "forward") + ": {crossings: " + count(ways[k].crossings) +
        ", balls: " + count(ways[k].balls) + ", volume: " + real(ways[k].volume) + "}\n";
  line(s, "net_volume", real(ways[0].volume - ways[1].volume));

  const int direction = main_direction();
  double first = HUGE_VAL, last = -HUGE_VAL;
  for (const Event &e : events)
    if (e.direction * direction > 0.0) {
      first = std::min(first, e.time);
      last = std::max(last, e.time);
    }
  line(s, "first_time", real(first));
  line(s, "last_time", real(last));
  s +=
      "# of the crossings in the direction that more volume went: first_time to quantiles; speed,\n"
      "# height of the ball's centre above the ground, energy of motion and spin; quantiles: this\n"
      "# share of the crossings stays at or below\n";
  line(s, "direction", direction > 0 ? "forward" : "back");
  s += "largest: {" + three(quantile(1.0));
  const bool any = !events.empty();
  s += any ? "quantiles:\n" : "quantiles: []\n";
  for (const double share : SHARES)
    if (any) s += "  - {share: " + real(share) + ", " + three(quantile(share));
  return s;
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_path.h"

#include <algorithm>
#include <cstdio>

using namespace Slope;

/* ---------------------------------------------------------------------- */

std::string Slope::left_csv(std::vector<LeftBall> balls)
{
  std::sort(balls.begin(), balls.end(), [](const LeftBall &a, const LeftBall &b) {
    return a.time < b.time || (a.time == b.time && a.tag < b.tag);
  });
  std::string s = "ball,volume,time,x,y,from_x,from_y\n";
  for (const LeftBall &b : balls) {
    char text[256];
    snprintf(text, sizeof(text), "%.0f,%.15g,%.10g,%.10g,%.10g,%.10g,%.10g\n", b.tag, b.volume,
             b.time, b.x[0], b.x[1], b.from[0], b.from[1]);
    s += text;
  }
  return s;
}

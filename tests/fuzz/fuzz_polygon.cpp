/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Any file is rings with an area, or an error of one line

#include "fuzz_file.h"
#include "polygon.h"

#include <cmath>

using Slope::Polygon;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static FuzzFile file;
  const std::string &path = file.of(data, size);
  try {
    const Polygon polygon = Polygon::read(path);
    const double dx = polygon.xhi - polygon.xlo, dy = polygon.yhi - polygon.ylo;
    const double area = polygon.area();
    must(dx > 0.0 && dy > 0.0, "an extent");
    must(area > 0.0 && area <= 1.000001 * dx * dy, "an area, at most that of the box around it");
    for (const double f : {-0.1, 0.0, 0.3, 0.5, 1.0, 1.1})
      for (const double g : {-0.1, 0.0, 0.3, 0.5, 1.0, 1.1}) {
        const double x = polygon.xlo + f * dx, y = polygon.ylo + g * dy;
        const bool inside = polygon.inside(x, y);
        must(!inside || (f >= 0.0 && f <= 1.0 && g >= 0.0 && g <= 1.0) || x <= polygon.xhi,
             "inside only in the box");
      }
    must(!polygon.inside(NAN, INFINITY), "no inside at NaN");
  } catch (std::runtime_error &e) {
    must_be_one_line(e, path);
  }
  return 0;
}

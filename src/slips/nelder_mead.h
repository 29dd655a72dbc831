// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NELDER_MEAD_H
#define SLOPE_NELDER_MEAD_H

#include <algorithm>
#include <cmath>
#include <vector>

namespace Slope {

// Nelder and Mead's simplex for the least of value(point), which is infinite where there is none and
// keeps the best point itself. The first simplex is a point and one a step away along each variable,
// on the other side if there is no value. Ends where its values agree within a share of 1e-7.
template <typename Value>
void nelder_mead(const std::vector<double> &first, const std::vector<double> &step, int steps,
                 Value value)
{
  typedef std::vector<double> Point;
  const size_t dim = first.size();
  std::vector<Point> simplex(dim + 1, first);
  std::vector<double> f(dim + 1);
  for (size_t k = 0; k <= dim; k++) {
    if (k > 0) simplex[k][k - 1] += step[k - 1];
    f[k] = value(simplex[k]);
    if (k > 0 && f[k] == HUGE_VAL) {
      simplex[k][k - 1] -= 2.0 * step[k - 1];
      f[k] = value(simplex[k]);
    }
  }
  for (int n = 0; n < steps; n++) {
    const size_t low = std::min_element(f.begin(), f.end()) - f.begin();
    const size_t high = std::max_element(f.begin(), f.end()) - f.begin();
    if (f[high] - f[low] < 1.0e-7 * f[low]) break;
    double second = f[low];
    for (size_t k = 0; k <= dim; k++)
      if (k != high) second = std::max(second, f[k]);
    const auto along = [&](double by) {
      Point p(dim);
      for (size_t d = 0; d < dim; d++) {
        double middle = 0.0;
        for (size_t k = 0; k <= dim; k++)
          if (k != high) middle += simplex[k][d] / dim;
        p[d] = middle + by * (simplex[high][d] - middle);
      }
      return p;
    };
    const auto take = [&](const Point &p, double fp) {
      simplex[high] = p;
      f[high] = fp;
    };
    const Point mirror = along(-1.0);
    const double fm = value(mirror);
    if (fm < f[low]) {
      const Point far = along(-2.0);
      const double ff = value(far);
      ff < fm ? take(far, ff) : take(mirror, fm);
    } else if (fm < second)
      take(mirror, fm);
    else {
      const Point near = along(fm < f[high] ? -0.5 : 0.5);
      const double fn = value(near);
      if (fn < std::min(fm, f[high]))
        take(near, fn);
      else
        for (size_t k = 0; k <= dim; k++) {
          if (k == low) continue;
          for (size_t d = 0; d < dim; d++) simplex[k][d] = 0.5 * (simplex[k][d] + simplex[low][d]);
          f[k] = value(simplex[k]);
        }
    }
  }
}

}    // namespace Slope

#endif

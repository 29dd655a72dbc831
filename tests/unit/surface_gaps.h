/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Surfaces with fixed balls of radius R, and how far their points are from the balls

#ifndef SLOPE_TEST_SURFACE_GAPS_H
#define SLOPE_TEST_SURFACE_GAPS_H

#include "plan_nodes.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

namespace Slope {

constexpr double PI = 3.14159265358979323846;
constexpr double R = 0.5;    // radius of the balls

// distance to the nearest of many points

class Nearest {
 public:
  explicit Nearest(const std::vector<double> &xyz, size_t nballs = -1)
  {
    for (size_t k = 0; k < std::min(xyz.size() / 3, nballs); k++)
      bins[bin(xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2])].push_back(
          {xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2]});
  }

  // in radii; 4 stands for everything farther than the bins tell
  double operator()(double x, double y, double z) const
  {
    const std::array<int, 3> b = bin(x, y, z);
    if (b != last) {    // queries come in rows
      last = b;
      around.clear();
      for (int i = -1; i <= 1; i++)
        for (int j = -1; j <= 1; j++)
          for (int k = -1; k <= 1; k++) {
            const auto found = bins.find({b[0] + i, b[1] + j, b[2] + k});
            if (found != bins.end())
              around.insert(around.end(), found->second.begin(), found->second.end());
          }
    }
    double d2 = 16.0 * R * R;
    for (const auto &p : around) {
      const double dx = p[0] - x, dy = p[1] - y, dz = p[2] - z;
      d2 = std::min(d2, dx * dx + dy * dy + dz * dz);
    }
    return std::sqrt(d2) / R;
  }

 private:
  typedef std::vector<std::array<double, 3>> Points;
  static std::array<int, 3> bin(double x, double y, double z)
  {
    const double w = 4.0 * R;
    return {static_cast<int>(std::floor(x / w)), static_cast<int>(std::floor(y / w)),
            static_cast<int>(std::floor(z / w))};
  }
  std::map<std::array<int, 3>, Points> bins;
  mutable std::array<int, 3> last = {{INT_MAX, 0, 0}};
  mutable Points around;    // balls in the bins around the last query
};

// the largest distance of a point of the surface to the nearest ball, over columns so close that
// neighboring points are no farther apart than 0.07 R on a slope of this gradient

inline double worst_gap(const GroundHeights &surface, const Nearest &nearest, double xlo, double xhi, double ylo,
                 double yhi, double gradient = 0.0)
{
  const double pitch = 0.07 * R / std::sqrt(1.0 + gradient * gradient);
  double worst = 0.0;
  for (double y = ylo; y <= yhi; y += pitch)
    for (double x = xlo; x <= xhi; x += pitch) {
      double z;
      if (!surface.height(x, y, z) || (surface.keep && !surface.keep(x, y))) continue;
      worst = std::max(worst, nearest(x, y, z));
    }
  return worst;
}

inline GroundHeights plane(double degrees, double azimuth)
{
  const double g = std::tan(degrees * PI / 180.0), a = azimuth * PI / 180.0;
  GroundHeights s;
  s.height = [=](double x, double y, double &z) {
    z = g * (std::cos(a) * x + std::sin(a) * y);
    return true;
  };
  return s;
}

inline bool in_polygon(const std::vector<std::array<double, 2>> &corner, double x, double y)
{
  bool in = false;
  for (size_t c = 0; c < corner.size(); c++) {
    const auto &a = corner[c], &b = corner[(c + 1) % corner.size()];
    if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) in = !in;
  }
  return in;
}

}    // namespace Slope

#endif

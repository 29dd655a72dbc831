/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_TEST_BALL_FLOOD_H
#define SLOPE_TEST_BALL_FLOOD_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

// A box that is filled from its top, voxel by voxel, wherever the centre of a moving ball touches no
// fixed ball.
class BallFlood {
 public:
  BallFlood(const std::array<double, 3> &lo, const std::array<double, 3> &hi, double voxel) :
      lo(lo), voxel(voxel)
  {
    for (int d = 0; d < 3; d++) n[d] = static_cast<int>((hi[d] - lo[d]) / voxel);
    full.assign(static_cast<size_t>(n[0]) * n[1] * n[2], 0);
  }

  // fixed balls x y z, contact: distance of the centres when the moving ball touches one
  void add(const std::vector<double> &xyz, double contact)
  {
    const double reach = 0.98 * contact;
    for (size_t b = 0; b < xyz.size(); b += 3) {
      int first[3], last[3];
      for (int d = 0; d < 3; d++) {
        first[d] = std::max(0, static_cast<int>((xyz[b + d] - reach - lo[d]) / voxel));
        last[d] = std::min(n[d] - 1, static_cast<int>((xyz[b + d] + reach - lo[d]) / voxel));
      }
      for (int k = first[2]; k <= last[2]; k++)
        for (int j = first[1]; j <= last[1]; j++)
          for (int i = first[0]; i <= last[0]; i++) {
            const double dx = lo[0] + (i + 0.5) * voxel - xyz[b];
            const double dy = lo[1] + (j + 0.5) * voxel - xyz[b + 1];
            const double dz = lo[2] + (k + 0.5) * voxel - xyz[b + 2];
            if (dx * dx + dy * dy + dz * dz < reach * reach) full[index(i, j, k)] = 1;
          }
    }
  }

  // does the moving ball get from the top of the box to its bottom? Once only.
  bool gets_through()
  {
    std::vector<std::array<int, 3>> todo;
    auto enter = [&](int i, int j, int k) {
      if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2]) return;
      if (full[index(i, j, k)]) return;
      full[index(i, j, k)] = 1;
      todo.push_back({{i, j, k}});
    };
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++) enter(i, j, n[2] - 1);
    while (!todo.empty()) {
      const int i = todo.back()[0], j = todo.back()[1], k = todo.back()[2];
      if (k == 0) return true;
      todo.pop_back();
      for (int step : {-1, 1}) {
        enter(i + step, j, k);
        enter(i, j + step, k);
        enter(i, j, k + step);
      }
    }
    return false;
  }

 private:
  std::array<double, 3> lo;
  double voxel;
  int n[3];
  std::vector<char> full;

  size_t index(int i, int j, int k) const { return (static_cast<size_t>(k) * n[1] + j) * n[0] + i; }
};

inline bool ball_gets_through(const std::vector<double> &xyz, double contact,
                              const std::array<double, 3> &lo, const std::array<double, 3> &hi)
{
  BallFlood flood(lo, hi, 0.075 * contact);
  flood.add(xyz, contact);
  return flood.gets_through();
}

#endif

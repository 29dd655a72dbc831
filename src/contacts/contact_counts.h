// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* How many contacts each ball has; ranks share them for the balls that they have in common. No LAMMPS. */

#ifndef SLOPE_CONTACT_COUNTS_H
#define SLOPE_CONTACT_COUNTS_H

#include <algorithm>
#include <vector>

namespace Slope {

struct ContactCounts {
  std::vector<unsigned char> now;    // of each ball, ghosts included; up to 255

  void clear(int balls) { now.assign(balls, 0); }    // before the contacts of a step are counted

  // buffers: one value per ball
  int pack_forward(int n, const int *list, double *buf) const
  {
    for (int k = 0; k < n; k++) buf[k] = now[list[k]];
    return n;
  }
  void unpack_forward(int n, int begin, const double *buf)
  {
    for (int k = 0; k < n; k++) now[begin + k] = static_cast<unsigned char>(buf[k]);
  }
  int pack_reverse(int n, int begin, double *buf) const
  {
    for (int k = 0; k < n; k++) buf[k] = now[begin + k];
    return n;
  }
  void unpack_reverse(int n, const int *list, const double *buf)
  {
    for (int k = 0; k < n; k++)
      now[list[k]] = static_cast<unsigned char>(std::min(255.0, now[list[k]] + buf[k]));
  }
};

}    // namespace Slope

#endif

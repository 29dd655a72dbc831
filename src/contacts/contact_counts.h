/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* How many contacts each ball has, now and a step ago, and whether its force at set-up could only be
   estimated; ranks share them for the balls that they have in common. No LAMMPS. */

#ifndef SLOPE_CONTACT_COUNTS_H
#define SLOPE_CONTACT_COUNTS_H

#include <algorithm>
#include <vector>

namespace Slope {

struct ContactCounts {
  using Counts = std::vector<unsigned char>;    // of each ball, ghosts included; up to 255

  // what is communicated. The numbers of a step ago are complete already, unless they have been
  // counted again with a new list.
  enum Which { NOW, BOTH, ESTIMATED };

  Counts now, before, estimated;
  Which shared = NOW;

  // before the contacts of a step are counted
  void clear(int balls, bool lists_new, bool starting)
  {
    if (lists_new)
      before.assign(balls, 0);
    else
      before.swap(now);
    now.assign(balls, 0);
    if (starting) estimated.assign(balls, 0);
  }

  bool is_estimated(int i) const { return i < static_cast<int>(estimated.size()) && estimated[i]; }

  // buffers: one value per ball, two of BOTH
  int pack_forward(int n, const int *list, double *buf) const
  {
    int m = 0;
    for (int k = 0; k < n; k++) {
      buf[m++] = first()[list[k]];
      if (shared == BOTH) buf[m++] = before[list[k]];
    }
    return m;
  }

  void unpack_forward(int n, int begin, const double *buf)
  {
    int m = 0;
    for (int i = begin; i < begin + n; i++) {
      first()[i] = static_cast<unsigned char>(buf[m++]);
      if (shared == BOTH) before[i] = static_cast<unsigned char>(buf[m++]);
    }
  }

  int pack_reverse(int n, int begin, double *buf) const
  {
    int m = 0;
    for (int i = begin; i < begin + n; i++) {
      buf[m++] = first()[i];
      if (shared == BOTH) buf[m++] = before[i];
    }
    return m;
  }

  void unpack_reverse(int n, const int *list, const double *buf)
  {
    int m = 0;
    for (int k = 0; k < n; k++) {
      add(first()[list[k]], buf[m++]);
      if (shared == BOTH) add(before[list[k]], buf[m++]);
    }
  }

  double memory_usage() const { return now.capacity() + before.capacity() + estimated.capacity(); }

 private:
  Counts &first() { return shared == ESTIMATED ? estimated : now; }
  const Counts &first() const { return shared == ESTIMATED ? estimated : now; }

  static void add(unsigned char &sum, double more)
  {
    sum = static_cast<unsigned char>(std::min(255.0, sum + more));
  }
};

}    // namespace Slope

#endif

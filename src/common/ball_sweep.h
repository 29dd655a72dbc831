// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Sweeps over all balls of a rank, four at a time (SIMD): LAMMPS keeps vectors one after the
   other, so that those of four balls are twelve numbers in a row */

#ifndef SLOPE_BALL_SWEEP_H
#define SLOPE_BALL_SWEEP_H

#include "simd4.h"

namespace Slope {

// calls four(i) for balls i to i + 3 that are all in the group, one(i) for the others of the group
template <class FourBalls, class OneBall>
SLOPE_INLINE void sweep(int n, const int *mask, int groupbit, FourBalls four, OneBall one)
{
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    if (mask[i] & mask[i + 1] & mask[i + 2] & mask[i + 3] & groupbit)
      four(i);
    else
      for (int k = i; k < i + 4; k++)
        if (mask[k] & groupbit) one(k);
  }
  for (; i < n; i++)
    if (mask[i] & groupbit) one(i);
}

// a number of each of four balls, for the components of their vectors
struct OfComponents {
  Four first, second, third;

  SLOPE_INLINE explicit OfComponents(Four s) :
      first(SLOPE_SHUFFLE(s, s, 0, 0, 0, 1)), second(SLOPE_SHUFFLE(s, s, 1, 1, 2, 2)),
      third(SLOPE_SHUFFLE(s, s, 2, 3, 3, 3))
  {
  }
};

// to += factor * by, for the vectors of four balls
SLOPE_INLINE void add_four(double *to, const OfComponents &factor, const double *by)
{
  four(to) += factor.first * four(by);
  four(to + 4) += factor.second * four(by + 4);
  four(to + 8) += factor.third * four(by + 8);
}

// sum = to + factor * by
SLOPE_INLINE void sum_four(double *sum, const double *to, const OfComponents &factor,
                           const double *by)
{
  four(sum) = four(to) + factor.first * four(by);
  four(sum + 4) = four(to + 4) + factor.second * four(by + 4);
  four(sum + 8) = four(to + 8) + factor.third * four(by + 8);
}

// to += factor * by, for one ball
SLOPE_INLINE void add_one(double *to, double factor, const double *by)
{
  for (int d = 0; d < 3; d++) to[d] += factor * by[d];
}

}    // namespace Slope

#endif

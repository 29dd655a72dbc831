// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "histogram.h"

#include <algorithm>

using namespace Slope;

static constexpr double ROUNDING = 1.0e-12;    // of the weight, when ranks add up in another order

/* ---------------------------------------------------------------------- */

Histogram::Histogram(double lo_in, double hi_in) :
    weights(BINS, 0.0), lo(lo_in), hi(hi_in), width((hi_in - lo_in) / BINS)
{
}

/* ---------------------------------------------------------------------- */

void Histogram::add(double value, double weight)
{
  const double at = width > 0.0 ? (value - lo) / width : 0.0;
  weights[(int) std::min(std::max(at, 0.0), BINS - 1.0)] += weight;
}

/* ---------------------------------------------------------------------- */

double Histogram::quantile(double share) const
{
  double total = 0.0;
  for (const double weight : weights) total += weight;
  if (!(total > 0.0)) return lo;

  const double wanted = (share - ROUNDING) * total;
  double below = 0.0;
  for (int k = 0; k < BINS; k++) {
    below += weights[k];
    if (below > 0.0 && below >= wanted) return k == BINS - 1 ? hi : lo + (k + 1) * width;
  }
  return hi;
}

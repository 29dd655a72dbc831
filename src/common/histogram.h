// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_HISTOGRAM_H
#define SLOPE_HISTOGRAM_H

#include <vector>

namespace Slope {

// Weights over a range in equal bins, for quantiles of values that are too many to gather: of
// several ranks the weights are added up, bin by bin.
class Histogram {
 public:
  static constexpr int BINS = 8192;

  // range lo < hi; lo == hi: all values are the same
  Histogram(double lo, double hi);

  void add(double value, double weight);    // a value beyond the range counts in the bin at its end

  // The value that a share of the weight (0 to 1) lies at or below, to one bin and never too
  // small: the upper edge of the bin where the share is reached. lo if there is no weight.
  double quantile(double share) const;

  double bin() const { return width; }    // size of a bin: 1/BINS of the range

  std::vector<double> weights;    // of the bins; public for those who add up those of ranks

 private:
  double lo, hi, width;
};

}    // namespace Slope

#endif

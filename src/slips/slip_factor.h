// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_FACTOR_H
#define SLOPE_SLIP_FACTOR_H

#include "slip_columns.h"

#include <vector>

namespace Slope {

// Factor of safety of a body by the balance of moments about the surface's axis, and with Spencer's method
// of horizontal forces, too; doc/src/slip_analysis.rst has the equations.
class SlipFactor {
 public:
  enum Method { ORDINARY, BISHOP, SPENCER };
  static constexpr double LEAST_M = 0.2;    // bound of m_alpha (Whitman and Bailey 1967)
  static constexpr double PRECISION = 1.0e-10;

  // coefficients of inertia: in the direction of sliding, and upwards
  struct Seismic {
    double horizontal, vertical;
  };

  // moments, the resisting one times the factor; horizontal forces likewise, with Spencer's method only
  struct Balance {
    double resisting, driving;
    double holding, pushing;
  };

  explicit SlipFactor(Method _method) :
      method(_method), columns(nullptr), bounded(0.0), pulled(0.0), inclined(0.0), weight(0.0),
      weight_u(0.0), weight_arm(0.0)
  {
  }

  // the columns of a surface, for sliding in its direction; they must exist while the others are asked
  void take(const SlipColumns &, const SlipSurface &);

  // infinite if nothing drives the body; NaN if no inclination of the forces between columns balances it
  double factor(const Seismic &, double precision = PRECISION) const;

  // by the moments about the axis alone: Bishop's where the method is Spencer's
  double of_moments(const Seismic &, double precision) const;

  // horizontal coefficient at which the factor is 1, with this vertical one; negative if the body
  // slides without an earthquake; NaN if no coefficient does it
  double yield(double vertical) const;

  // tangent of the inclination of the forces between columns at the last factor() or yield()
  double inclination() const { return inclined; }

  // shares of the weight at the last factor(), not with the ordinary method: in columns whose m_alpha was below
  // its bound; in columns whose effective normal force was negative, which is left as it is
  double share_bounded() const { return bounded; }
  double share_pulled() const { return pulled; }

  // with this factor and this inclination in the normal forces
  Balance balance(double factor, const Seismic &, double inclination) const;

  // direction of sliding, radians, in which the weight's moment about the centre is largest
  static double steepest(const SlipColumns &);

 private:
  Method method;
  const SlipColumns *columns;
  mutable double bounded, pulled, inclined;
  double weight;
  double weight_u, weight_arm;    // sums of W u, and of W x arm

  // of each column
  struct Base {
    double sine, cosine;      // of the dip in the direction of sliding
    double up;                // cosine of the true dip
    double lever, normal;     // of the shear force; of the normal force, which drives
    double cohesive, lift;    // c A and u A, over the area of the base
  };
  std::vector<Base> bases;

  double factor_at(double inclination, const Seismic &, double precision, double start) const;
  double yield_at(double inclination, double vertical) const;
  template <typename Solve, typename Excess> double inclined_to(Solve, Excess, double) const;
};

}    // namespace Slope

#endif

/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(gravity/slope,FixGravitySlope);
// clang-format on
#else

#ifndef LMP_FIX_GRAVITY_SLOPE_H
#define LMP_FIX_GRAVITY_SLOPE_H

#include "fix_gravity.h"

namespace LAMMPS_NS {

// fix gravity, four balls at a time; its energy on request
class FixGravitySlope : public FixGravity {
 public:
  using FixGravity::FixGravity;
  void post_force(int) override;
  double compute_scalar() override;

 private:
  bool energy_due = false;
};

}    // namespace LAMMPS_NS

#endif
#endif

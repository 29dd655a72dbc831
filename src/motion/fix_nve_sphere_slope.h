/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(nve/sphere/slope,FixNVESphereSlope);
// clang-format on
#else

#ifndef LMP_FIX_NVE_SPHERE_SLOPE_H
#define LMP_FIX_NVE_SPHERE_SLOPE_H

#include "fix_nve_sphere.h"

namespace LAMMPS_NS {

// fix nve/sphere, four balls at a time
class FixNVESphereSlope : public FixNVESphere {
 public:
  using FixNVESphere::FixNVESphere;
  void initial_integrate(int) override;
  void final_integrate() override;

 private:
  template <bool MOVE> void integrate();
};

}    // namespace LAMMPS_NS

#endif
#endif

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
  void init() override;
  void initial_integrate(int) override;
  void final_integrate() override;

 private:
  class Continuation *contacts = nullptr;    // whose velocities ahead this fix finds on its way

  template <bool MOVE, bool LOOK> void integrate();
};

}    // namespace LAMMPS_NS

#endif
#endif

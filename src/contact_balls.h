/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The balls of a contact as the contact lists see them: arrays of those that move, and the partners
   that they meet, which move, too, or are fixed. No LAMMPS. */

#ifndef SLOPE_CONTACT_BALLS_H
#define SLOPE_CONTACT_BALLS_H

namespace Slope {

struct Vector {
  double x, y, z;
};

// all that moves; positions in m, velocities at the middle of the step in m/s and rad/s
struct MovingBalls {
  const Vector *x, *v, *omega;
  const double *radius, *mass;
  Vector *f, *torque;
  unsigned char *count, *count_before;    // contacts of each ball now, a step ago; up to 255
  unsigned char *estimated;               // at set-up: 1 where a force could only be estimated
};

// The partners of the moving balls: other moving balls ...
struct MovingPartners {
  static constexpr bool MOVE = true;
  const MovingBalls &balls;
  int nforce;    // partners below this number get their force, and count their contacts

  const Vector &x(int j) const { return balls.x[j]; }
  double share(int j) const
  {
    return j < nforce ? 1.0 : 0.5;
  }    // of the contact that is this rank's
  bool gets_force(int j) const { return j < nforce; }
  void prefetch(int j) const
  {
    __builtin_prefetch(&balls.v[j]);
    __builtin_prefetch(&balls.omega[j]);
    __builtin_prefetch(&balls.f[j], 1);
    __builtin_prefetch(&balls.torque[j], 1);
  }
  const Vector &v(int j) const { return balls.v[j]; }
  const Vector &omega(int j) const { return balls.omega[j]; }
  double radius(int j) const { return balls.radius[j]; }
  double mass(int j) const { return balls.mass[j]; }
};

// ... or fixed ones of one radius (m)
struct FixedPartners {
  static constexpr bool MOVE = false;
  const Vector *position;
  double radius_all;
  Vector still = {0.0, 0.0, 0.0};

  FixedPartners(const Vector *positions, double radius) : position(positions), radius_all(radius) {}

  const Vector &x(int j) const { return position[j]; }
  double share(int) const { return 1.0; }
  bool gets_force(int) const { return false; }
  void prefetch(int) const {}
  const Vector &v(int) const { return still; }
  const Vector &omega(int) const { return still; }
  double radius(int) const { return radius_all; }
  double mass(int) const { return 1.0; }
};

// ... or fixed ones of their own radii (m), which stand for a smooth surface: see fix wall/gran/mesh
struct PhantomPartners {
  static constexpr bool MOVE = false;
  const Vector *position;
  const double *radii;
  Vector still = {0.0, 0.0, 0.0};

  PhantomPartners(const Vector *positions, const double *radii_in) :
      position(positions), radii(radii_in)
  {
  }

  const Vector &x(int j) const { return position[j]; }
  double share(int) const { return 1.0; }
  bool gets_force(int) const { return false; }
  void prefetch(int) const {}
  const Vector &v(int) const { return still; }
  const Vector &omega(int) const { return still; }
  double radius(int j) const { return radii[j]; }
  double mass(int) const { return 1.0; }
};

}    // namespace Slope

#endif

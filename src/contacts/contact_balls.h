// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The balls of a contact as the contact lists see them: arrays of those that move, and the partners
   that they meet, which move, too, or are fixed. No LAMMPS. */

#ifndef SLOPE_CONTACT_BALLS_H
#define SLOPE_CONTACT_BALLS_H

#include "instruction_set.h"
#include "vector3.h"

namespace Slope {

// the contacts of a ball with fixed ones: the sum of their unit normals, and how many there are
struct FixedContacts {
  Vector normals;
  double number;
};

// which balls have a fixed contact: those whose sums are not 0; room for all
struct BallsOnFixed {
  int *numbers;
  int size;
};

// all that moves; positions in m, velocities at the middle of the step in m/s and rad/s
struct MovingBalls {
  const Vector *x, *v, *omega;
  const double *radius, *mass;
  Vector *f, *torque;
  const Vector *ahead;       // velocities that normal dashpots act on: Continuation::look_ahead()
  unsigned char *count;      // contacts of each ball now; up to 255
  FixedContacts *fixed;      // of each ball of this rank; of ghosts, too, where ranks share them
  BallsOnFixed *on_fixed;    // nullptr: not asked for
};

// The partners of the moving balls: other moving balls ...
struct MovingPartners {
  static constexpr bool MOVE = true;
  const MovingBalls &balls;
  int nforce;    // partners below this number get their force, and count their contacts

  SLOPE_INLINE const Vector &x(int j) const { return balls.x[j]; }
  SLOPE_INLINE double share(int j) const
  {
    return j < nforce ? 1.0 : 0.5;
  }    // of the contact that is this rank's
  SLOPE_INLINE bool gets_force(int j) const { return j < nforce; }
  SLOPE_INLINE void prefetch(int j) const
  {
    __builtin_prefetch(&balls.x[j]);
    __builtin_prefetch(&balls.v[j]);
    __builtin_prefetch(&balls.omega[j]);
    __builtin_prefetch(&balls.ahead[j]);
    __builtin_prefetch(&balls.f[j], 1);
    __builtin_prefetch(&balls.torque[j], 1);
  }
  SLOPE_INLINE const Vector &v(int j) const { return balls.v[j]; }
  SLOPE_INLINE const Vector &omega(int j) const { return balls.omega[j]; }
  SLOPE_INLINE const Vector &ahead(int j) const { return balls.ahead[j]; }
  SLOPE_INLINE double radius(int j) const { return balls.radius[j]; }
  SLOPE_INLINE double mass(int j) const { return balls.mass[j]; }
};

// ... or fixed ones, all of one radius (m), or each of its own
struct FixedPartners {
  enum Radii { ONE = 0, EACH = 1 };
  static constexpr bool MOVE = false;
  const Vector *position;
  const double *radii;
  Radii known;
  Vector still = {0.0, 0.0, 0.0};

  SLOPE_INLINE FixedPartners(const Vector *positions, const double *_radii, Radii _known) :
      position(positions), radii(_radii), known(_known)
  {
  }

  SLOPE_INLINE const Vector &x(int j) const { return position[j]; }
  SLOPE_INLINE double share(int) const { return 1.0; }
  SLOPE_INLINE bool gets_force(int) const { return false; }
  SLOPE_INLINE void prefetch(int) const {}
  SLOPE_INLINE const Vector &v(int) const { return still; }
  SLOPE_INLINE const Vector &omega(int) const { return still; }
  SLOPE_INLINE const Vector &ahead(int) const { return still; }
  SLOPE_INLINE double radius(int j) const { return radii[known * j]; }
  SLOPE_INLINE double mass(int) const { return 1.0; }
};

}    // namespace Slope

#endif

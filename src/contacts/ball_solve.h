/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What the dashpots of all contacts of a ball do to its own motion, and the velocity that follows. No LAMMPS.
   Derivation: doc/src/theory.rst, Several contacts.

   A contact's dashpots, times half a step, resist a velocity v and a spin w of the ball with
     normal      bn n (n.v)
     tangential  bt (v + R n x w) in the tangent plane
     rolling     br Rr^2 w, taken the same about all axes
   which is a symmetric 6 x 6 matrix. Only sums over the contacts are kept. */

#ifndef SLOPE_BALL_SOLVE_H
#define SLOPE_BALL_SOLVE_H

#include "simd4.h"

namespace Slope {

// sums over the contacts of a ball, kg; symmetric matrices as xx, yy, zz, yz, xz, xy
struct BallDashpots {
  double normal[6];          // (bn - bt) n n
  double tangential[6];      // bt n n
  double n[3];               // bt n
  double t;                  // bt
  double roll;               // br Rr^2, kg m^2
  double f[3], torque[3];    // forces (N) and torques (N m) of the contacts
  double spare;

  static constexpr int SIZE = 24, FORCE = 17;    // numbers, and where f begins
  double *row(int k) { return normal + k; }
};

inline namespace SLOPE_INSTRUCTIONS {

// symmetric 3 x 3 matrix
template <class T> struct Symmetric {
  T xx, yy, zz, yz, xz, xy;

  SLOPE_INLINE void times(const T *v, T *out) const
  {
    out[0] = xx * v[0] + xy * v[1] + xz * v[2];
    out[1] = xy * v[0] + yy * v[1] + yz * v[2];
    out[2] = xz * v[0] + yz * v[1] + zz * v[2];
  }

  SLOPE_INLINE Symmetric inverse() const
  {
    const T a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const T per = 1.0 / (xx * a + xy * b + xz * c);
    return {per * a,
            per * (xx * zz - xz * xz),
            per * (xx * yy - xy * xy),
            per * (xy * xz - xx * yz),
            per * c,
            per * b};
  }
};

// Change of velocity dv and spin dw that half a step of the impulse (force p, torque q, times dt/2) gives to a
// solid sphere of mass m (kg) and radius r (m) whose dashpots resist it. dashpots: rows of BallDashpots up to roll.
template <class T>
SLOPE_INLINE void solve_ball(T m, T r, const T *normal, const T *tangential, const T *n, T t,
                             T roll, const T *p, const T *q, T *dv, T *dw)
{
  const T r2 = r * r, own = 0.4 * m * r2 + r2 * t + roll;
  const Symmetric<T> spin = {own - r2 * tangential[0], own - r2 * tangential[1],
                             own - r2 * tangential[2], -r2 * tangential[3],
                             -r2 * tangential[4],      -r2 * tangential[5]};
  const Symmetric<T> w = spin.inverse();

  // coupling: B_vw = r [n]x; v from its Schur complement, M + B_vv + r^2 [n]x W [n]x

  const T nx = r * n[0], ny = r * n[1], nz = r * n[2];
  // rows of [n]x = (0 -nz ny; nz 0 -nx; -ny nx 0); a = [n]x W
  const T a[3][3] = {{ny * w.xz - nz * w.xy, ny * w.yz - nz * w.yy, ny * w.zz - nz * w.yz},
                     {nz * w.xx - nx * w.xz, nz * w.xy - nx * w.yz, nz * w.xz - nx * w.zz},
                     {nx * w.xy - ny * w.xx, nx * w.yy - ny * w.xy, nx * w.yz - ny * w.xz}};
  // a [n]x: columns of [n]x are (0 nz -ny), (-nz 0 nx), (ny -nx 0)
  const T mt = m + t;
  const Symmetric<T> s = {
      mt + normal[0] + a[0][1] * nz - a[0][2] * ny, mt + normal[1] + a[1][2] * nx - a[1][0] * nz,
      mt + normal[2] + a[2][0] * ny - a[2][1] * nx, normal[3] + a[1][0] * ny - a[1][1] * nx,
      normal[4] + a[0][0] * ny - a[0][1] * nx,      normal[5] + a[0][2] * nx - a[0][0] * nz};
  T rhs[3];
  for (int d = 0; d < 3; d++) rhs[d] = p[d] - (a[d][0] * q[0] + a[d][1] * q[1] + a[d][2] * q[2]);
  s.inverse().times(rhs, dv);
  // transposed [n]x is its negative: q - B_wv dv = q + r n x dv
  const T rest[3] = {q[0] + (ny * dv[2] - nz * dv[1]), q[1] + (nz * dv[0] - nx * dv[2]),
                     q[2] + (nx * dv[1] - ny * dv[0])};
  w.times(rest, dw);
}

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

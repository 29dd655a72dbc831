/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Touching contacts of one law, side by side, so that the compiler evaluates the contact law
   for several at a time (SIMD). Few contacts touch among those listed: gathering them first
   keeps the branch out of the arithmetic. A block stays within the first-level cache. */

#ifndef SLOPE_CONTACT_BLOCK_H
#define SLOPE_CONTACT_BLOCK_H

#include "contact_law.h"

namespace Slope {

struct ContactBlock {
  static constexpr int SIZE = 64;

  int count;

  // whose contact it is: the meaning is the caller's

  int i[SIZE], j[SIZE];
  double radius_i[SIZE], radius_j[SIZE];
  double *history_of[SIZE];

  // fields of Contact and ContactForce

  double n[3][SIZE];
  double overlap[SIZE];
  double v[3][SIZE];
  double rw[3][SIZE];
  double w[3][SIZE];
  double rolling_radius[SIZE];
  double mass[SIZE];
  double inverse_mass[SIZE];
  double fresh[SIZE];
  double f[3][SIZE];
  double t[3][SIZE];
  double m[3][SIZE];
  double history[HISTORY][SIZE];

  ContactBlock() : count(0) {}

  // forces of all contacts; the histories change in the block only
  void evaluate(const ContactLaw &law, double dt)
  {
    if (law.rolling > 0.0) evaluate<true>(law, dt);
    else evaluate<false>(law, dt);
  }

  // the histories back to where they came from
  void store_history()
  {
    for (int k = 0; k < count; k++)
      for (int h = 0; h < HISTORY; h++) history_of[k][h] = history[h][k];
  }

 private:
  template <bool ROLLING> void evaluate(const ContactLaw &law_in, double dt)
  {
    const ContactLaw law = law_in;    // a copy: no store below can change it
    const int end = count;
#pragma GCC ivdep
    for (int k = 0; k < end; k++) {
      Contact c;
      ContactForce out;
      double values[HISTORY];
      for (int d = 0; d < 3; d++) {
        c.n[d] = n[d][k];
        c.v[d] = v[d][k];
        c.rw[d] = rw[d][k];
        c.w[d] = w[d][k];
      }
      c.overlap = overlap[k];
      c.rolling_radius = rolling_radius[k];
      c.mass = mass[k];
      c.inverse_mass = inverse_mass[k];
      c.fresh = fresh[k];
      for (int h = 0; h < HISTORY; h++) values[h] = history[h][k];
      contact_force<ROLLING>(law, c, dt, values, out);
      for (int h = 0; h < HISTORY; h++) history[h][k] = values[h];
      for (int d = 0; d < 3; d++) {
        f[d][k] = out.f[d];
        t[d][k] = out.t[d];
        m[d][k] = out.m[d];
      }
    }
  }
};

}    // namespace Slope

#endif

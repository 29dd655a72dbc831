/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A contact of two balls that touch nothing else: an impact. Normal and sliding motion follow
   the contact law in continuous time, into and out of sliding, and begin and end within a
   step. Velocity Verlet hands over the paths of the last half step; what comes back is the change
   ("kick") that makes the next path the one that the law has. No LAMMPS.
   Derivation: doc/src/theory.rst, Lone contacts.

   Lengths in m, time in steps, forces per contact mass: F dt^2 / m, in m. */

#ifndef SLOPE_LONE_CONTACT_H
#define SLOPE_LONE_CONTACT_H

#include "oscillator.h"

#include <algorithm>
#include <cmath>

namespace Slope {

enum Life { BEGINS, LASTS, ENDS };    // within the step that has just been made

// a solid sphere's contact point moves as 2/7 of the mass: translation and spin together
static constexpr double POINT = 3.5;

struct LoneContact {
  static constexpr int PARTS = 4;    // of a step, where sliding begins or ends

  double friction;
  Oscillator normal, sliding;
  Motion step_n, step_t, part_n, part_t;    // over a step, over a part of it
  double left_n, left_t;                    // exp(-2 h)
  double cn, kt, ct;                        // law: fn = a d + cn d', Ft = kt xi + ct xi'
  double fast;                              // see kick()

  // law: the contact's oscillators, normal and tangential
  LoneContact(const Oscillator &law_n, const Oscillator &law_t, double tan_friction) :
      normal(true_at_rest(law_n)), sliding(law_t)
  {
    fast = 1.0 + normal.stiffness() / 12.0;
    friction = tan_friction / fast;

    // the sliding motion keeps step with the normal one

    const double faster = law_n.a > 0.0 ? normal.a / law_n.a : 1.0;
    sliding.a *= faster;
    sliding.h *= std::sqrt(faster);
    step_n = normal.after(1.0);
    step_t = sliding.after(1.0);
    part_n = normal.after(1.0 / PARTS);
    part_t = sliding.after(1.0 / PARTS);
    left_n = std::exp(-2.0 * normal.h);
    left_t = std::exp(-2.0 * sliding.h);
    cn = 2.0 * normal.h;
    kt = sliding.a / POINT;
    ct = 2.0 * sliding.h / POINT;
  }

  // Overlap d at the end of a step (< 0 if the contact ends in it) in which it grew by V; path U[3]
  // of the contact point in the tangent plane; spring xi[3] a step ago, in the plane.
  // Out: normal and tangential kick, spring now. again: the kick of this very step once more, with
  // xi as the step has left it: exact unless the contact slid in the step (slid), an estimate then.
  // Returns whether it slid in a step that it lasted.
  bool kick(Life life, bool again, bool slid, double d, double V, const double *U, double *xi,
            double &kick_n, double *kick_t) const
  {
    State s;
    if (life == BEGINS) {
      const double t = normal.since_zero(d, fast * V);
      s = {0.0, fast * V, {0.0, 0.0, 0.0}, {U[0], U[1], U[2]}};
      cut_spring(s, xi);    // the dashpot may slide at once
      follow(s, normal.after(t / PARTS), sliding.after(t / PARTS));
      s.d = d;
    } else {
      const double d0 = d - V, r0 = (d - step_n.xx * d0) / step_n.xr;
      if (life == ENDS) {
        kick_n = kick_t[0] = kick_t[1] = kick_t[2] = 0.0;
        if (!(d0 > 0.0)) return false;    // a normal that turns: it ended at once
        const double t = std::min(normal.until_zero(d0, r0), 1.0);
        s = start(d0, r0, V, U, xi);
        follow(s, normal.after(t / PARTS), sliding.after(t / PARTS));
        kick_n = V - s.r / fast;
        for (int k = 0; k < 3; k++) kick_t[k] = (U[k] - s.u[k]) / POINT;
        return false;
      }
      if (again) recall(s, slid, d0, r0, V, U, xi);
      else slid = last(s, d0, r0, V, U, xi);
    }

    // the next step, if nothing changes: the force of its first half

    const double next = (step_n.xx - 1.0) * s.d + step_n.xr * s.r;
    double dv[3];
    for (int k = 0; k < 3; k++) dv[k] = s.u[k] - ((step_t.xx - 1.0) * s.xi[k] + step_t.xr * s.u[k]);
    const double share = cut(dv, POINT * friction * std::max(s.r - next, 0.0));
    kick_n = V - next;
    for (int k = 0; k < 3; k++) {
      kick_t[k] = (U[k] - s.u[k] + share * dv[k]) / POINT;
      xi[k] = s.xi[k];
    }
    return slid && life == LASTS;
  }

 private:
  struct State {
    double d, r;           // overlap and its rate
    double xi[3], u[3];    // spring, rate of the contact point
  };

  // factor that brings a vector to a length
  static double cut(const double *f, double limit)
  {
    const double f2 = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
    return f2 > limit * limit ? limit / std::sqrt(f2) : 1.0;
  }

  double limit(const State &s) const { return friction * std::max(normal.a * s.d + cn * s.r, 0.0); }

  // the spring of a contact that begins, with the force on its limit where the dashpot alone is more
  void cut_spring(State &s, double *xi) const
  {
    double f[3];
    for (int k = 0; k < 3; k++) f[k] = ct * s.u[k];
    const double share = cut(f, limit(s));
    for (int k = 0; k < 3; k++) xi[k] = s.xi[k] = share < 1.0 && kt > 0.0 ? (share - 1.0) * f[k] / kt : 0.0;
  }

  // state a step ago: the rate of the contact point from its path in the step
  State start(double d0, double r0, double V, const double *U, const double *xi) const
  {
    State s = {d0, r0, {xi[0], xi[1], xi[2]}, {U[0], U[1], U[2]}};
    double dv[3];
    for (int k = 0; k < 3; k++)
      dv[k] = ((1.0 - step_t.xr) * U[k] + (1.0 - step_t.xx) * xi[k]) / step_t.xr;
    const double share = cut(dv, POINT * friction * std::max(r0 - V, 0.0));
    for (int k = 0; k < 3; k++) s.u[k] += share * dv[k];
    return s;
  }

  // the state after a step of sticking, from the springs before and after it; the force in f
  void stuck(State &s, double d0, double r0, double V, const double *U, const double *xi_now,
             double *f) const
  {
    s.d = d0 + V;
    s.r = step_n.rate(d0, r0);
    for (int k = 0; k < 3; k++) {
      s.xi[k] = xi_now[k];
      s.u[k] = (step_t.rr * xi_now[k] - left_t * (xi_now[k] - U[k])) / step_t.xr;
      f[k] = kt * s.xi[k] + ct * s.u[k];
    }
  }

  // state after a step that the contact lasted; returns whether it slid
  bool last(State &s, double d0, double r0, double V, const double *U, const double *xi) const
  {
    const State before = start(d0, r0, V, U, xi);
    const double xi_now[3] = {xi[0] + U[0], xi[1] + U[1], xi[2] + U[2]};
    double f[3], held[3];
    stuck(s, d0, r0, V, U, xi_now, f);
    for (int k = 0; k < 3; k++) held[k] = kt * before.xi[k] + ct * before.u[k];
    if (cut(f, limit(s)) == 1.0 && cut(held, (1.0 + 1.0e-9) * limit(before)) == 1.0) return false;
    s = before;
    follow(s, part_n, part_t);
    return true;
  }

  // the same from the spring after the step
  void recall(State &s, bool slid, double d0, double r0, double V, const double *U, const double *xi) const
  {
    double f[3];
    stuck(s, d0, r0, V, U, xi, f);
    if (!slid) return;
    double dv[3];
    for (int k = 0; k < 3; k++) dv[k] = U[k] - s.u[k];
    const double share = cut(dv, POINT * friction * std::max(V - s.r, 0.0));
    for (int k = 0; k < 3; k++) s.u[k] = U[k] - share * dv[k];
  }

  // the law over PARTS times the time of p and q: stick, or slide with the force on the limit
  void follow(State &s, const Motion &p, const Motion &q) const
  {
    for (int part = 0; part < PARTS; part++) {
      const double r = s.r;
      s.r = p.rate(s.d, r);
      s.d = p.x(s.d, r);
      double xi[3], u[3], f[3];
      for (int k = 0; k < 3; k++) {
        xi[k] = q.x(s.xi[k], s.u[k]);
        u[k] = q.rate(s.xi[k], s.u[k]);
        f[k] = kt * xi[k] + ct * u[k];
      }
      const double share = cut(f, limit(s));
      if (share < 1.0) {
        double dv[3];
        for (int k = 0; k < 3; k++) dv[k] = s.u[k] - u[k];
        const double held = cut(dv, POINT * friction * std::max(r - s.r, 0.0));
        for (int k = 0; k < 3; k++) {
          u[k] = s.u[k] - held * dv[k];
          xi[k] = (share * f[k] - ct * u[k]) / kt;
        }
      }
      for (int k = 0; k < 3; k++) {
        s.xi[k] = xi[k];
        s.u[k] = u[k];
      }
    }
  }
};

}    // namespace Slope

#endif

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
inline namespace SLOPE_INSTRUCTIONS {

enum Life { BEGINS, LASTS, ENDS };    // within the step that has just been made

// a solid sphere's contact point moves as 2/7 of the mass: translation and spin together
static constexpr double POINT = 3.5;

// rolling of the two spheres on each other, per contact mass
struct Rolling {
  Oscillator law;
  double limit;      // mu_r
  double inverse;    // what a rolling force does to the rolling rate
  double across;     // and to the rate of the contact point; a sliding force to the rolling rate
};

struct LoneContact {
  static constexpr double MOST = 100.0;

  int parts;    // of a step: sliding begins and ends at one; more where rolling acts on sliding

  double friction, resistance;
  Oscillator normal, sliding, rolling;
  Motion step_n, step_t, part_n, part_t, part_r;    // over a step, over a part of it
  double left_t;                                    // exp(-2 h)
  double cn, kt, ct, kr, cr;    // law: fn = a d + cn d', ft = kt xi + ct xi', fr alike
  double inverse_r, across;
  double fast;       // see kick()
  double longest;    // steps that an impact lasts at most

  // what a kick needs and changes
  struct Springs {
    double slide[3], roll[3];    // m, in the tangent plane
  };
  struct Kick {
    double n, slide[3],
        roll[3];    // on the overlap, the contact point, the rolling; per contact mass, m
  };

  // law: the contact's oscillators, normal and tangential
  LoneContact(const Oscillator &law_n, const Oscillator &law_t, double tan_friction,
              const Rolling &law_r) :
      normal(true_at_rest(law_n)),
      sliding(law_t), rolling(law_r.law)
  {
    fast = 1.0 + normal.stiffness() / 12.0;
    friction = tan_friction / fast;
    resistance = law_r.limit / fast;
    parts = resistance > 0.0 && law_r.across != 0.0 ? 12 : 4;

    // sliding and rolling keep step with the normal motion

    const double faster = law_n.a > 0.0 ? normal.a / law_n.a : 1.0;
    for (Oscillator *o : {&sliding, &rolling}) {
      o->a *= faster;
      o->h *= std::sqrt(faster);
    }
    step_n = normal.after(1.0);
    step_t = sliding.after(1.0);
    part_n = normal.after(1.0 / parts);
    part_t = sliding.after(1.0 / parts);
    part_r = rolling.after(1.0 / parts);
    left_t = std::exp(-2.0 * sliding.h);
    const double q2 = normal.a - normal.h * normal.h;
    longest = 2.0 + std::min(std::acos(-1.0) / std::sqrt(std::max(q2, 1.0e-6)), MOST);
    inverse_r = law_r.inverse;
    across = law_r.across;
    cn = 2.0 * normal.h;
    kt = sliding.a / POINT;
    ct = 2.0 * sliding.h / POINT;
    kr = inverse_r > 0.0 ? rolling.a / inverse_r : 0.0;
    cr = inverse_r > 0.0 ? 2.0 * rolling.h / inverse_r : 0.0;
  }

  // Overlap d at the end of a step (< 0 if the contact ends in it) in which it grew by V; paths in the
  // tangent plane of the contact point, U[3], and of the rolling, Y[3], turned by 90 degrees so
  // that both count alike (n x Rr (wi - wj)). springs: those a step ago, replaced. BEGINS needs V > 0.
  // repeat: the kick of this very step once more, with the springs as the step has left them: exact
  // unless the contact slid or rolled in the step (slid), an estimate then. Returns whether it did.
  //
  // fast: a contact that begins or ends in company has no closed form, and gains or loses energy with
  // the moment within the step; on average it begins with 1 - a/6 of its energy, and ends with
  // as much more. Lone contacts do the same, so that those which begin alone and end in company, or the
  // reverse, neither heat nor cool.
  bool kick(Life life, bool repeat, bool slid, double d, double V, const double *U, const double *Y,
            Springs &springs, Kick &out) const
  {
    State s;
    Kick before = {
        0.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};    // the part of the step's force given already
    out = before;
    if (life == BEGINS) {
      slid = false;
      const double t = normal.since_zero(d, fast * V);
      s = {0.0, fast * V, {0.0, 0.0, 0.0}, {U[0], U[1], U[2]}, {0.0, 0.0, 0.0}, {Y[0], Y[1], Y[2]}};
      cut_spring(kt, ct, limit(s, friction), s.u, s.xi);    // the dashpot may slide at once
      cut_spring(kr, cr, limit(s, resistance), s.y, s.rho);
      follow(s, normal.after(t / parts), sliding.after(t / parts), rolling.after(t / parts), out);
      s.d = d;
    } else {
      const double d0 = d - V, r0 = (d - step_n.xx * d0) / step_n.xr;
      if (life == ENDS && !(d0 > 0.0)) return false;    // a normal that turns: it ended at once
      if (life == LASTS && repeat) {
        recall(s, slid, d0, r0, V, U, Y, springs, out);
      } else {
        s = start(d0, r0, V, U, Y, springs, before.slide);
        if (life == ENDS) {
          const double t = std::min(normal.until_zero(d0, r0), 1.0) / parts;
          follow(s, normal.after(t), sliding.after(t), rolling.after(t), out);
          out.n = V - s.r / fast;
          for (int k = 0; k < 3; k++) out.slide[k] -= before.slide[k];
          return false;
        }
        slid = last(s, d0, r0, V, U, springs, out);
      }
    }

    // the next step, if nothing changes: the force of its first half

    const double next = (step_n.xx - 1.0) * s.d + step_n.xr * s.r;
    double dv[3];
    for (int k = 0; k < 3; k++) dv[k] = s.u[k] - ((step_t.xx - 1.0) * s.xi[k] + step_t.xr * s.u[k]);
    const double share = cut(dv, POINT * friction * std::max(s.r - next, 0.0));
    out.n = V - next;
    for (int k = 0; k < 3; k++) {
      out.slide[k] += share * dv[k] / POINT - before.slide[k];
      springs.slide[k] = s.xi[k];
      springs.roll[k] = s.rho[k];
    }
    return slid;
  }

 private:
  struct State {
    double d, r;            // overlap and its rate
    double xi[3], u[3];     // sliding spring, rate of the contact point
    double rho[3], y[3];    // rolling
  };

  // factor that brings a vector to a length
  static double cut(const double *f, double limit)
  {
    const double f2 = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
    return f2 > limit * limit ? limit / std::sqrt(f2) : 1.0;
  }

  double limit(const State &s, double factor) const
  {
    return factor * std::max(normal.a * s.d + cn * s.r, 0.0);
  }

  // the spring of a contact that begins, with the force on its limit where the dashpot alone is more
  static void cut_spring(double k, double c, double limit, const double *u, double *xi)
  {
    double f[3];
    for (int d = 0; d < 3; d++) f[d] = c * u[d];
    const double share = cut(f, limit);
    for (int d = 0; d < 3; d++) xi[d] = k > 0.0 ? (share - 1.0) * f[d] / k : 0.0;
  }

  // State a step ago, with the rates from the paths in the step; given: the force then, as in kick()
  State start(double d0, double r0, double V, const double *U, const double *Y,
              const Springs &springs, double *given) const
  {
    State s;
    s.d = d0;
    s.r = r0;
    double dv[3];
    for (int k = 0; k < 3; k++)
      dv[k] = ((1.0 - step_t.xr) * U[k] + (1.0 - step_t.xx) * springs.slide[k]) / step_t.xr;
    const double share = cut(dv, POINT * friction * std::max(r0 - V, 0.0));
    for (int k = 0; k < 3; k++) {
      given[k] = share * dv[k] / POINT;
      s.xi[k] = springs.slide[k];
      s.u[k] = U[k] + share * dv[k];
      s.rho[k] = springs.roll[k];
      s.y[k] = Y[k] + across * given[k];
    }
    return s;
  }

  // the state after a step of sticking, from the spring after it; the force in f
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

  // state after a step that the contact lasted; returns whether it slid or rolled
  bool last(State &s, double d0, double r0, double V, const double *U, const Springs &springs,
            Kick &out) const
  {
    if (resistance == 0.0) {
      State now = s;
      double xi_now[3], f[3], held[3];
      for (int k = 0; k < 3; k++) {
        xi_now[k] = springs.slide[k] + U[k];
        held[k] = kt * s.xi[k] + ct * s.u[k];
      }
      stuck(now, d0, r0, V, U, xi_now, f);
      if (cut(f, limit(now, friction)) == 1.0 &&
          cut(held, (1.0 + 1.0e-9) * limit(s, friction)) == 1.0) {
        for (int k = 0; k < 3; k++) out.slide[k] = (s.u[k] - now.u[k]) / POINT;
        s = now;
        return false;
      }
    }
    follow(s, part_n, part_t, part_r, out);
    return true;
  }

  // the same, and the force given before, from the springs after the step
  void recall(State &s, bool slid, double d0, double r0, double V, const double *U, const double *Y,
              const Springs &springs, Kick &out) const
  {
    double f[3], dv[3];
    stuck(s, d0, r0, V, U, springs.slide, f);
    for (int k = 0; k < 3; k++) dv[k] = U[k] - s.u[k];
    const double share = slid ? cut(dv, POINT * friction * std::max(V - s.r, 0.0)) : 1.0;
    for (int k = 0; k < 3; k++) {
      out.slide[k] = share * dv[k] / POINT;
      s.u[k] = U[k] - share * dv[k];
      s.rho[k] = springs.roll[k];
      s.y[k] = Y[k];
    }
  }

  // Spring and dashpot over a part of a step: they stick, or slide with the force on the limit at the end
  // of the part. left: the normal rate that the part takes; adds the impulse to sum, returns it in given.
  static void part(double k, double c, double inverse, const Motion &q, double limit, double most,
                   double *x, double *u, double *sum, double *given)
  {
    double x1[3], u1[3], f[3], dv[3];
    for (int d = 0; d < 3; d++) {
      x1[d] = q.x(x[d], u[d]);
      u1[d] = q.rate(x[d], u[d]);
      f[d] = k * x1[d] + c * u1[d];
      dv[d] = u[d] - u1[d];
    }
    const double share = cut(f, limit);
    const bool alone = !(k > 0.0);    // a dashpot may have slid, and hold at the end
    if (share < 1.0 || alone) {
      const double held = cut(dv, inverse * most);
      for (int d = 0; d < 3; d++) {
        u1[d] = u[d] - held * dv[d];
        x1[d] = alone ? 0.0 : (share * f[d] - c * u1[d]) / k;
      }
    }
    for (int d = 0; d < 3; d++) {
      given[d] = (u[d] - u1[d]) / inverse;
      sum[d] += given[d];
      x[d] = x1[d];
      u[d] = u1[d];
    }
  }

  // the law over parts times the time of the motions; adds the impulses to out
  void follow(State &s, const Motion &n, const Motion &t, const Motion &r, Kick &out) const
  {
    for (int k = 0; k < parts; k++) {
      const double rate = s.r;
      s.r = n.rate(s.d, rate);
      s.d = n.x(s.d, rate);
      const double taken = std::max(rate - s.r, 0.0);
      // in turns: that is as good as both at once, to the second order

      double given[3];
      for (int turn = 0; turn < 2; turn++) {
        if ((turn + k) % 2 == 0) {
          part(kt, ct, POINT, t, limit(s, friction), friction * taken, s.xi, s.u, out.slide, given);
          for (int d = 0; d < 3; d++) s.y[d] -= across * given[d];
        } else if (resistance > 0.0) {
          part(kr, cr, inverse_r, r, limit(s, resistance), resistance * taken, s.rho, s.y, out.roll,
               given);
          for (int d = 0; d < 3; d++) s.u[d] -= across * given[d];
        }
      }
    }
  }
};

}    // namespace SLOPE_INSTRUCTIONS
}    // namespace Slope

#endif

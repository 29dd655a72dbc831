"""One impact of two balls by the contact law of doc/src/theory.rst in continuous time: what a step should give.

Written from the equations of that page, not from src/: Fn = kn d - cn vn while d > 0; Ft = -kt xi - ct vt, xi' = vt
while it sticks, cut to mu max(Fn, 0), where xi follows the cut force; rolling likewise, with the arm R_r. In the plane
of the impact, and in frozen geometry: the normal keeps its direction and the balls their radii as arms. That is the
limit of a small speed; at the speed v of an impact the normal turns by about v/(R w), w = sqrt(kn/m).

The law is linear in the speed, so all is in units of the ball: its mass, its radius, kn and its speed are 1.

`impacts` takes many cases at once by small steps of the implicit midpoint rule. `one_impact` solves one case piecewise,
by scipy, from one change between sticking and sliding to the next. A test holds the two against each other.
"""
import math
from typing import Any, NamedTuple

import numpy as np

STEPS = 1000        # in a contact: beta is right to 2e-4


class Case(NamedTuple):
    """What hits what, and how: numbers, or arrays that broadcast."""
    angle: Any                      # degrees between velocity and normal
    friction: Any                   # degrees
    e: Any                          # restitution
    tangential: Any = 1.0        # kt/kn, and kr/kn
    mass: Any = math.inf         # of the partner; infinite: fixed
    radius: Any = 1.0            # of the partner
    spin: Any = 0.0              # R w/v of the ball before the impact, the partner has none
    rolling: Any = 0.0           # rolling resistance coefficient


class Outcome(NamedTuple):
    """After the impact."""
    beta: Any                       # tangential velocity at the contact, after / before
    spin: Any                       # of the ball: R w over the size of that velocity before
    partner_spin: Any               # of the partner: R_j w_j over the same
    restitution: Any                # normal velocity after / before
    energy: Any                     # of motion and spin, after / before


class _Motion:
    """The numbers of a case: inertia, springs, dashpots, and the normal motion, which is known in closed form."""

    def __init__(self, case):
        arrays = np.broadcast_arrays(*(np.asarray(value, float) for value in case))
        self.case = case = Case(*arrays)
        log_e = np.log(case.e)
        self.zeta = -log_e / np.hypot(math.pi, log_e)
        self.inverse_j = 1 / case.mass
        self.mass = 1 / (1 + self.inverse_j)            # of the contact
        self.omega = np.sqrt(1 / self.mass)
        self.damped = self.omega * np.sqrt(1 - self.zeta ** 2)
        self.time = math.pi / self.damped               # of the contact
        self.mu = np.tan(np.radians(case.friction))
        self.arm = 2 * case.radius / (1 + case.radius)  # of the rolling resistance
        self.kt, self.ct = case.tangential, 2 * self.zeta * np.sqrt(case.tangential * self.mass)
        # accelerations of (vt, vr) by (Ft, Fr): a sphere's inertia is 2/5 m R^2
        self.spin_i, self.spin_j = 2.5, 2.5 * self.inverse_j / case.radius ** 2
        self.tt = 3.5 / self.mass
        self.tr = self.arm * (case.radius * self.spin_j - self.spin_i)
        self.rr = self.arm ** 2 * (self.spin_i + self.spin_j)
        # before
        self.un = np.cos(np.radians(case.angle))
        self.ut = np.sin(np.radians(case.angle))
        self.vt = self.ut - case.spin
        self.vr = self.arm * case.spin

    def pressing(self, t):
        """max(Fn, 0), and its rate."""
        decay = self.un * np.exp(-self.zeta * self.omega * t)
        s, c = np.sin(self.damped * t) / self.damped, np.cos(self.damped * t)
        d = decay * s
        rate = decay * (c - self.zeta * self.omega * s)
        cn = 2 * self.zeta * self.omega * self.mass
        force = d + cn * rate
        change = rate + cn * (-d - cn * rate) / self.mass
        return np.maximum(force, 0.0), np.where(force > 0, change, 0.0)

    def outcome(self, vt, impulse_t, impulse_r):
        """From the tangential velocity at the end and the two impulses."""
        case = self.case
        ut = self.ut + impulse_t / self.mass            # relative velocity of the centres
        wi = case.spin + self.spin_i * (self.arm * impulse_r - impulse_t)
        wj = -self.spin_j * (case.radius * impulse_t + self.arm * impulse_r)
        un = case.e * self.un
        # in the frame in which the partner was at rest: the centre of mass moves as before
        share = np.where(np.isinf(case.mass), 0.0, 1 - self.mass)       # m_i/(m_i + m_j)
        before = 1 + 0.4 * case.spin ** 2
        centre = share * 1.0
        with np.errstate(invalid="ignore"):
            spin_j = np.where(np.isinf(case.mass), 0.0, case.mass * (case.radius * wj) ** 2)
        after = centre + self.mass * (un ** 2 + ut ** 2) + 0.4 * (wi ** 2 + spin_j)
        size = np.abs(self.vt)
        return Outcome(vt / self.vt, wi / size, case.radius * wj / size, case.e + 0 * vt, after / before)


def impacts(case, steps=STEPS):
    """The Outcome of each of many cases, by small steps."""
    m = _Motion(case)
    h = m.time / steps
    vt, vr = m.vt.copy(), m.vr.copy()
    impulse_t, impulse_r, force_r = (np.zeros_like(vt) for _ in range(3))
    # the dashpots act at once: where they pass the limit, the springs give way at once
    start, _ = m.pressing(0.0)
    xi, rho = (-(np.clip(-m.ct * v, -limit * start, limit * start) + m.ct * v) / m.kt
               for v, limit in ((vt, m.mu), (vr, m.case.rolling)))
    drag = 0.5 * h * m.kt + m.ct
    mobility_t, mobility_r = (1 / (1 + 0.5 * h * drag * b) for b in (m.tt, m.rr))
    rolls = np.any(m.case.rolling > 0)
    for k in range(steps):
        middle, _ = m.pressing((k + 0.5) * h)
        end, _ = m.pressing((k + 1) * h)
        for _ in range(3 if rolls else 1):              # the two springs act on one spin
            wanted_t = -(m.kt * xi + drag * (vt + 0.5 * h * m.tr * force_r)) * mobility_t
            force_t = np.clip(wanted_t, -m.mu * middle, m.mu * middle)
            if rolls:
                wanted_r = -(m.kt * rho + drag * (vr + 0.5 * h * m.tr * force_t)) * mobility_r
                limit = m.case.rolling * middle
                force_r = np.clip(wanted_r, -limit, limit)
        new_t = vt + h * (m.tt * force_t + m.tr * force_r)
        new_r = vr + h * (m.tr * force_t + m.rr * force_r)
        xi = np.where(force_t == wanted_t, xi + 0.5 * h * (vt + new_t),
                      -(np.sign(force_t) * m.mu * end + m.ct * new_t) / m.kt)
        if rolls:
            rho = np.where(force_r == wanted_r, rho + 0.5 * h * (vr + new_r),
                           -(np.sign(force_r) * m.case.rolling * end + m.ct * new_r) / m.kt)
        impulse_t += h * force_t
        impulse_r += h * force_r
        vt, vr = new_t, new_r
    return m.outcome(vt, impulse_t, impulse_r)


# --- one case, piecewise ---

class _Direction(NamedTuple):
    """Sliding or rolling: where its velocity and spring stand among the unknowns, its limit over max(Fn, 0)."""
    v: int
    s: int
    limit: float


def one_impact(case, tolerance=1e-11):
    """The Outcome of one case (numbers): regimes of sticking and sliding, solved by scipy from event to event.

    A direction slides with the sign of its force as long as the force of its spring and dashpot would grow faster than
    the limit does. Where the dashpot pulls (Fn < 0) there is no tangential force.
    """
    from scipy.integrate import solve_ivp
    m = _Motion(Case(*(float(value) for value in case)))
    k, c = float(m.kt), float(m.ct)
    inertia = np.array([[m.tt, m.tr], [m.tr, m.rr]], float)
    directions = (_Direction(0, 2, float(m.mu)), _Direction(1, 3, float(m.case.rolling)))
    y = np.array([m.vt, m.vr, 0, 0, 0, 0], float)       # vt, vr, their springs, impulses

    def forces(t, y, sliding):
        pressing, _ = m.pressing(t)
        return np.array([sign * d.limit * pressing if sign else -k * y[d.s] - c * y[d.v]
                         for d, sign in zip(directions, sliding)])

    def rates(t, y, sliding):
        f = forces(t, y, sliding)
        a = inertia @ f
        _, change = m.pressing(t)
        # of a spring that follows the cut force: k s + c v = -sign limit max(Fn, 0)
        springs = [-(sign * d.limit * change + c * a[i]) / k if sign else y[d.v]
                   for i, (d, sign) in enumerate(zip(directions, sliding))]
        return np.array([*a, *springs, *f])

    def room(t, y, sliding, i):
        """What is left to the change of the regime of direction i: below 0, it has passed."""
        d, sign = directions[i], sliding[i]
        if not d.limit:         # slides for ever
            return 1.0
        pressing, change = m.pressing(t)
        if not sign:
            return d.limit * pressing - abs(k * y[d.s] + c * y[d.v])
        a = inertia @ forces(t, y, sliding)
        return sign * (-k * y[d.v] - c * a[i]) - d.limit * change

    def settled(t, y, sliding):
        """The regimes now, with springs cut to what they can hold."""
        y, sliding = y.copy(), list(sliding)
        for i, d in enumerate(directions):
            force = -k * y[d.s] - c * y[d.v]
            limit = d.limit * m.pressing(t)[0]
            small = 1e-12 * (abs(force) + limit)
            sign = np.sign(force) if abs(force) > small else np.sign(-y[d.v]) or 1.0
            if abs(force) >= limit - 1e-9 * max(limit, 1e-3):
                sliding[i] = sign
                y[d.s] = -(sign * limit + c * y[d.v]) / k
        for i in range(2):      # does it go on?
            if sliding[i] and room(t, y, sliding, i) < 0:
                sliding[i] = 0
        return y, sliding

    cn = float(2 * m.zeta * m.omega * m.mass)
    # Fn = 0: tan(damped t) = -cn damped/(1 - cn zeta omega), in the second quarter turn
    last = float(math.atan2(cn * m.damped, cn * m.zeta * m.omega - 1) / m.damped) if cn > 0 else float(m.time)
    t = 0.0
    y, sliding = settled(t, y, [0, 0])
    for _ in range(100):
        events = []
        for i in range(2):
            def event(t, y, i=i):
                return room(t, y, sliding, i)
            event.terminal, event.direction = True, -1      # type: ignore[attr-defined]  # of solve_ivp
            events.append(event)
        solution = solve_ivp(lambda t, y: rates(t, y, sliding), (t, last), y, method="DOP853", rtol=tolerance,
                             atol=tolerance, events=events, max_step=last / 50)
        t, y = solution.t[-1], solution.y[:, -1]
        if solution.status == 0 or t > (1 - 1e-9) * last:
            return m.outcome(y[0], y[4], y[5])
        for i in range(2):
            if len(solution.t_events[i]):
                d = directions[i]
                sliding[i] = 0 if sliding[i] else np.sign(-k * y[d.s] - c * y[d.v])
    raise RuntimeError(f"more than 100 changes of regime in {case}")

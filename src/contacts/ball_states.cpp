/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_states.h"

#include "atom.h"
#include "force.h"
#include "lammps_compat.h"

#include <climits>
#include <cstring>

using namespace LAMMPS_NS;
using namespace Slope;

/* ----------------------------------------------------------------------
   At the set-up of a new run the velocities of the end of the step are known, and the force is not.
------------------------------------------------------------------------- */

void BallStates::begin_step(Continuation &last, bool repeat, bool exact, bool held)
{
  continuation = &last;
  if (repeat)
    last.find_half_step();
  else
    last.forget_half_step();

  counts.clear(atom->nlocal + atom->nghost);
  clear_fixed(held);
  ahead_known = exact && (!last.v.empty() || !repeat);
}

// Most balls lie on none: only those that did in the last step have a sum

void BallStates::clear_fixed(bool held)
{
  for (int k = 0; k < on_fixed.size; k++) fixed[on_fixed.numbers[k]] = FixedContacts();
  on_fixed.size = 0;
  if (held || shared) fixed.clear();
  shared = held;
  fixed.resize(atom->nlocal + (shared ? atom->nghost : 0));
  numbers_on_fixed.resize(atom->nlocal);
  on_fixed.numbers = numbers_on_fixed.data();
}

/* ---------------------------------------------------------------------- */

void BallStates::share_counts(Pair *pair)
{
  if (force->newton_pair) compat::reverse_comm(comm, pair);
  compat::forward_comm(comm, pair);
}

int BallStates::pack_forward(int n, const int *list, double *buf) const
{
  int m = counts.pack_forward(n, list, buf);
  for (int k = 0; k < n && ahead_known; k++, m += 3)
    memcpy(&buf[m], &continuation->ahead()[list[k]], sizeof(Vector));
  for (int k = 0; k < n && shared; k++, m += 4)
    memcpy(&buf[m], &fixed[list[k]], sizeof(FixedContacts));
  return m;
}

void BallStates::unpack_forward(int n, int begin, const double *buf)
{
  counts.unpack_forward(n, begin, buf);
  buf += n;
  if (ahead_known) {
    memcpy(&continuation->ahead()[begin], buf, n * sizeof(Vector));
    buf += 3 * n;
  }
  if (shared) memcpy(&fixed[begin], buf, n * sizeof(FixedContacts));
}

int BallStates::pack_reverse(int n, int begin, double *buf) const
{
  int m = counts.pack_reverse(n, begin, buf);
  if (!shared) return m;
  memcpy(&buf[m], &fixed[begin], n * sizeof(FixedContacts));
  return m + 4 * n;
}

void BallStates::unpack_reverse(int n, const int *list, const double *buf)
{
  counts.unpack_reverse(n, list, buf);
  buf += n;
  for (int k = 0; k < n && shared; k++, buf += 4) {
    FixedContacts &sum = fixed[list[k]];
    sum.normals.x += buf[0];
    sum.normals.y += buf[1];
    sum.normals.z += buf[2];
    sum.number += buf[3];
  }
}

/* ---------------------------------------------------------------------- */

MovingBalls BallStates::balls()
{
  const bool half = continuation && !continuation->v.empty();
  const Vector *const v = half ? continuation->v.data() : vectors(atom->v);
  return {vectors(atom->x),
          v,
          half ? continuation->omega.data() : vectors(atom->omega),
          atom->radius,
          atom->rmass,
          vectors(atom->f),
          vectors(atom->torque),
          ahead_known ? continuation->ahead() : v,
          counts.now.data(),
          fixed.data(),
          shared ? nullptr : &on_fixed};
}

MovingPartners BallStates::partners(const MovingBalls &balls) const
{
  return {balls, force->newton_pair ? INT_MAX : atom->nlocal};
}

double BallStates::memory_usage() const
{
  return counts.now.capacity() + fixed.capacity() * sizeof(FixedContacts) +
      numbers_on_fixed.capacity() * sizeof(int);
}

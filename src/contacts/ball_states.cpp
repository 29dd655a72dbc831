/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_states.h"

#include "atom.h"
#include "contact_force.h"
#include "continuation.h"
#include "force.h"
#include "lammps_compat.h"
#include "update.h"

#include <climits>
#include <cstring>

using namespace LAMMPS_NS;
using namespace Slope;

/* ----------------------------------------------------------------------
   The velocities of the middle of the step, and a part of what the last step's force adds to them until
   its end. At the set-up of a new run those of the end are known, and the force is not.
------------------------------------------------------------------------- */

void BallStates::begin_step(Continuation &last, bool repeat, bool exact, bool held)
{
  continuation = &last;
  if (repeat)
    last.find_half_step();
  else
    last.forget_half_step();

  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  counts.clear(nall);
  shared = held;
  fixed.assign(shared ? nall : nlocal, FixedContacts());
  ahead_known = exact && (!last.v.empty() || !repeat);
  if (!ahead_known) return;
  const Vector *const v = last.v.empty() ? vectors(atom->v) : last.v.data();
  if (static_cast<int>(ahead.size()) <= nall)
    ahead.resize(atom->nmax + 1);    // read beyond the last: see PairLists::build()
  for (int i = 0; i < nlocal; i++) {
    const double *f = last.before[i];
    const double a = AHEAD * update->dt / atom->rmass[i];
    ahead[i] = {v[i].x + a * f[0], v[i].y + a * f[1], v[i].z + a * f[2]};
  }
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
    memcpy(&buf[m], &ahead[list[k]], sizeof(Vector));
  for (int k = 0; k < n && shared; k++, m += 4)
    memcpy(&buf[m], &fixed[list[k]], sizeof(FixedContacts));
  return m;
}

void BallStates::unpack_forward(int n, int begin, const double *buf)
{
  counts.unpack_forward(n, begin, buf);
  buf += n;
  if (ahead_known) {
    memcpy(&ahead[begin], buf, n * sizeof(Vector));
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
          ahead_known ? ahead.data() : v,
          counts.now.data(),
          fixed.data()};
}

MovingPartners BallStates::partners(const MovingBalls &balls) const
{
  return {balls, force->newton_pair ? INT_MAX : atom->nlocal};
}

double BallStates::memory_usage() const
{
  return counts.now.capacity() + fixed.capacity() * sizeof(FixedContacts) +
      ahead.capacity() * sizeof(Vector);
}

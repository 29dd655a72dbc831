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

void BallStates::begin_step(Continuation &last, bool repeat, bool exact)
{
  continuation = &last;
  if (repeat)
    last.find_half_step();
  else
    last.forget_half_step();

  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  counts.clear(nall);
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
  return m;
}

void BallStates::unpack_forward(int n, int begin, const double *buf)
{
  counts.unpack_forward(n, begin, buf);
  if (ahead_known) memcpy(&ahead[begin], &buf[n], n * sizeof(Vector));
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
          counts.now.data()};
}

MovingPartners BallStates::partners(const MovingBalls &balls) const
{
  return {balls, force->newton_pair ? INT_MAX : atom->nlocal};
}

double BallStates::memory_usage() const
{
  return counts.now.capacity() + ahead.capacity() * sizeof(Vector);
}

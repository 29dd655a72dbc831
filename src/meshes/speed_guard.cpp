/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "speed_guard.h"

#include "atom.h"
#include "contact_guards.h"
#include "error.h"
#include "large_messages.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

SpeedGuard::SpeedGuard(LAMMPS *lmp, const std::string &_caller) : Pointers(lmp), caller(_caller)
{
  start();
}

void SpeedGuard::start()
{
  worst = {0.0, 0.0, 0.0, 0.0};
  count = 0;
}

/* ---------------------------------------------------------------------- */

void SpeedGuard::record(int i, double speed, const Slope::ContactLaw &law)
{
  const double radius = atom->radius[i], deep = law.depth(atom->rmass[i], radius, speed);
  const double share = deep / (DEEPEST * radius);
  if (!(share > 1.0)) return;
  if (count++ == 0)
    error->warning(
        FLERR,
        "{}: ball {} hits at {:.4g} m/s at step {}, {:.3g} times the speed up to which no ball "
        "passes, {:g} R sqrt(kn/m): the contacts need a larger stiffness",
        caller, atom->tag[i], speed, update->ntimestep, share, +DEEPEST);
  if (share > worst.share)
    worst = {share, speed, static_cast<double>(atom->tag[i]),
             static_cast<double>(update->ntimestep)};
}

/* ---------------------------------------------------------------------- */

void SpeedGuard::report(ContactGuards &guards)
{
  bigint all;
  MPI_Allreduce(&count, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all == 0) return;
  with_largest(world, worst.share, worst);
  guards.say(fmt::format(
      "{}: balls hit it too fast {} times, the worst at {:.4g} m/s (ball {:.0f}, step "
      "{:.0f}), {:.3g} times the speed up to which no ball passes, {:g} R sqrt(kn/m): the "
      "contacts need a larger stiffness",
      caller, all, worst.speed, worst.ball, worst.step, worst.share, +DEEPEST));
}

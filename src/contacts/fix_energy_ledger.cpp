/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Where the energy goes: works of all forces from step to step, such that they sum up to what velocity
   Verlet changes the kinetic energy of the middles of the steps by. */

#include "fix_energy_ledger.h"

#include "gravity_work.h"
#include "pair_gran_restitution.h"
#include "requirements.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::ContactWorks;
using Slope::Vector;

/* ---------------------------------------------------------------------- */

FixEnergyLedger::FixEnergyLedger(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), begun(false), balls(0), shaken(0.0)
{
  if (narg != 3) error->all(FLERR, "Fix energy/ledger takes no arguments, got {}", arg[3]);
  if (igroup != 0) error->all(FLERR, "Fix energy/ledger: the group must be all, got {}", arg[1]);
  nevery = 1;
  vector_flag = 1;
  size_vector = NITEM;
  global_freq = 1;
  extvector = 1;
  std::fill(item, item + NITEM, 0.0);
}

int FixEnergyLedger::setmask()
{
  return END_OF_STEP;
}

/* ---------------------------------------------------------------------- */

void FixEnergyLedger::init()
{
  if (!PairGranRestitution::of(lmp))
    error->all(FLERR, "Fix energy/ledger requires pair_style gran/restitution");
  require_run(lmp, "Fix energy/ledger");
}

// of fixes that are there in this run

void FixEnergyLedger::setup(int)
{
  shaken = shaking_work(lmp);
}

/* ----------------------------------------------------------------------
   of the middle of the step that comes next
------------------------------------------------------------------------- */

double FixEnergyLedger::kinetic() const
{
  const double half = 0.5 * update->dt;
  auto later = [half](const Vector &v, const Vector &f, double m) -> Vector {
    return {v.x + half * f.x / m, v.y + half * f.y / m, v.z + half * f.z / m};
  };
  double energy = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    const double m = atom->rmass[i], r = atom->radius[i], inertia = 0.4 * m * r * r;
    const Vector v = later(vectors(atom->v)[i], vectors(atom->f)[i], m);
    const Vector w = later(vectors(atom->omega)[i], vectors(atom->torque)[i], inertia);
    energy += 0.5 * (m * dot(v, v) + inertia * dot(w, w));
  }
  return energy;
}

/* ---------------------------------------------------------------------- */

void FixEnergyLedger::end_of_step()
{
  comm->forward_comm();    // the velocities of the end of the step to the ghosts
  const ContactWorks::Sum c =
      PairGranRestitution::of(lmp)->works.work(update->dt, vectors(atom->v), vectors(atom->omega));
  const double moving = kinetic(), motion = shaking_work(lmp);
  const bigint before = balls;
  bigint mine = atom->nlocal;    // LAMMPS' stand-in for MPI takes no const
  MPI_Allreduce(&mine, &balls, 1, MPI_LMP_BIGINT, MPI_SUM, world);

  if (begun) {
    double on_places = 0.0, on_spins = 0.0;
    for (int i = 0; i < atom->nlocal; i++) {
      on_places += update->dt * dot(vectors(atom->f)[i], vectors(atom->v)[i]);
      on_spins += update->dt * dot(vectors(atom->torque)[i], vectors(atom->omega)[i]);
    }
    const double fallen =
        update->dt * GravityWork(lmp).weighed(atom->v);    // 0 of balls that fix freeze holds
    const double ground = motion - shaken;
    item[GRAVITY] += fallen;
    item[OTHERS] += on_places - fallen - (c.spring + c.dashpot + c.sliding - c.by_torque);
    item[GROUND] += ground;
    item[DASHPOTS] -= c.dashpot;
    item[SLIDING] -= c.sliding;
    item[ROLLING] -= on_spins - c.by_torque;

    // what springs gave less than they lost; what is missing in all, that less

    const double begin_end = item[STORED] - c.spring - c.stored;
    const double missing = item[KINETIC] + on_places + on_spins + ground - moving;
    if (balls == before) {
      item[BEGIN_END] += begin_end;
      item[RESIDUAL] -= missing;
    } else
      item[LEFT] += begin_end + missing;
  }
  begun = true;
  shaken = motion;
  item[KINETIC] = moving;
  item[STORED] = c.stored;
}

/* ---------------------------------------------------------------------- */

double FixEnergyLedger::compute_vector(int n)
{
  double sum;
  MPI_Allreduce(&item[n], &sum, 1, MPI_DOUBLE, MPI_SUM, world);
  return sum;
}

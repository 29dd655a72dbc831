/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What pair gran/restitution remembers: LAMMPS' own neighbor history for the contacts and, for
   each ball, force and torque of the last step, so that a continued run starts from those, and
   from the half-step velocities, with which the one before ended. Made by the pair style. */

#include "fix_contact_history.h"

#include "atom.h"
#include "comm.h"
#include "contact_guards.h"
#include "contact_history_owner.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

static constexpr double ROUNDING = 1.0e-10;    // of the largest force

/* ---------------------------------------------------------------------- */

FixContactHistory::FixContactHistory(LAMMPS *lmp, int narg, char **arg) :
    FixNeighHistory(lmp, narg, arg), owner(nullptr), lists_new(true), lists_used(false),
    force(nullptr), forces_taken_back(false), force_step(-1), force_dt(0.0), restart_extra(lmp)
{
  nevery = ContactGuards::EVERY;
  maxexchange += FORCE;    // until pre_exchange() knows how many contacts there are
  FixContactHistory::grow_arrays(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) FixContactHistory::set_arrays(i);
}

FixContactHistory::~FixContactHistory()
{
  memory->destroy(force);
}

/* ----------------------------------------------------------------------
   From the lists to storage by atom. Only when the lists have been used since: after
   write_restart has moved atoms between ranks, they name atoms that are no longer there.
------------------------------------------------------------------------- */

void FixContactHistory::pre_exchange()
{
  if (!lists_used) return;
  lists_used = false;
  owner->store_flags();
  FixNeighHistory::pre_exchange();
  maxexchange += FORCE;
}

void FixContactHistory::post_neighbor()
{
  FixNeighHistory::post_neighbor();
  lists_new = true;
}

/* ----------------------------------------------------------------------
   guards
------------------------------------------------------------------------- */

int FixContactHistory::setmask()
{
  return FixNeighHistory::setmask() | INITIAL_INTEGRATE | END_OF_STEP;
}

void FixContactHistory::init()
{
  restart_extra.check("Pair gran/restitution");
  FixNeighHistory::init();
}

void FixContactHistory::setup(int)
{
  owner->watch_energy();
}

void FixContactHistory::end_of_step()
{
  owner->watch_energy();
}

void FixContactHistory::post_run()
{
  FixNeighHistory::post_run();
  if (!forces_known()) keep_forces();
  if (update->ntimestep % nevery) owner->watch_energy();
  owner->report_guards();
}

/* ----------------------------------------------------------------------
   forces of a step that ends a run or goes into a restart file
------------------------------------------------------------------------- */

void FixContactHistory::keep_forces()
{
  for (int i = 0; i < atom->nlocal; i++) {
    memcpy(force[i], atom->f[i], 3 * sizeof(double));
    memcpy(&force[i][3], atom->torque[i], 3 * sizeof(double));
  }
  force_step = update->ntimestep;
  force_dt = update->dt;
}

/* ----------------------------------------------------------------------
   Before the first step of a continued run: the set-up has found the forces of the last step
   once more, to rounding. With the very same ones the run is the uncut one to the bit. If they
   differ by more, something has been changed in between, and those of the set-up stand.
------------------------------------------------------------------------- */

void FixContactHistory::initial_integrate(int)
{
  take_back_forces();
  for (int i = 0; i < atom->nlocal; i++) memcpy(&force[i][BEFORE], atom->f[i], 3 * sizeof(double));
}

void FixContactHistory::take_back_forces()
{
  forces_taken_back = false;
  const bool kept = force_step == update->ntimestep - 1 && force_step == update->firststep;
  force_step = -1;    // a step of this number may come again: reset_timestep
  if (!kept) return;
  double mine[4] = {0.0, 0.0, 0.0, 0.0}, most[4];    // largest force, torque; differences
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      mine[0] = std::max(mine[0], std::fabs(force[i][d]));
      mine[1] = std::max(mine[1], std::fabs(force[i][3 + d]));
      mine[2] = std::max(mine[2], std::fabs(force[i][d] - atom->f[i][d]));
      mine[3] = std::max(mine[3], std::fabs(force[i][3 + d] - atom->torque[i][d]));
    }
  MPI_Allreduce(mine, most, 4, MPI_DOUBLE, MPI_MAX, world);
  if (most[2] > ROUNDING * most[0] || most[3] > ROUNDING * most[1]) return;
  forces_taken_back = true;
  for (int i = 0; i < atom->nlocal; i++) {
    memcpy(atom->f[i], force[i], 3 * sizeof(double));
    memcpy(atom->torque[i], &force[i][3], 3 * sizeof(double));
  }
}

bool FixContactHistory::forces_known() const
{
  return force_step == update->ntimestep && force_dt == update->dt;
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

double FixContactHistory::memory_usage()
{
  return FixNeighHistory::memory_usage() + static_cast<double>(atom->nmax) * FORCE * sizeof(double);
}

void FixContactHistory::grow_arrays(int nmax)
{
  FixNeighHistory::grow_arrays(nmax);
  memory->grow(force, nmax, FORCE, "contact_history:force");
}

void FixContactHistory::copy_arrays(int i, int j, int delflag)
{
  FixNeighHistory::copy_arrays(i, j, delflag);
  memcpy(force[j], force[i], FORCE * sizeof(double));
}

void FixContactHistory::set_arrays(int i)
{
  FixNeighHistory::set_arrays(i);
  memset(force[i], 0, FORCE * sizeof(double));
}

int FixContactHistory::pack_exchange(int i, double *buf)
{
  const int m = FixNeighHistory::pack_exchange(i, buf);
  memcpy(&buf[m], force[i], FORCE * sizeof(double));
  return m + FORCE;
}

int FixContactHistory::unpack_exchange(int i, double *buf)
{
  const int m = FixNeighHistory::unpack_exchange(i, buf);
  memcpy(force[i], &buf[m], FORCE * sizeof(double));
  return m + FORCE;
}

/* ----------------------------------------------------------------------
   restart file
------------------------------------------------------------------------- */

void FixContactHistory::write_restart(FILE *fp)
{
  pre_exchange();
  if (!forces_known() && update->whichflag == 1) keep_forces();    // in a run: forces are known
  if (comm->me == 0) {
    const double list[2] = {static_cast<double>(force_step), force_dt};
    const int size = sizeof(list);
    fwrite(&size, sizeof(int), 1, fp);
    fwrite(list, sizeof(double), 2, fp);
  }
}

void FixContactHistory::restart(char *buf)
{
  double list[2];
  memcpy(list, buf, sizeof(list));
  force_step = static_cast<bigint>(list[0]);
  force_dt = list[1];
}

int FixContactHistory::pack_restart(int i, double *buf)
{
  int m = FixNeighHistory::pack_restart(i, buf);
  memcpy(&buf[m], force[i], FORCE * sizeof(double));
  m += FORCE;
  buf[0] = m;
  return m;
}

void FixContactHistory::unpack_restart(int i, int nth)
{
  const double *list = restart_extra.find(i, nth, 2 + FORCE, 1 + dnum);
  if (!list) return;
  FixNeighHistory::unpack_restart(i, nth);
  memcpy(force[i], list + static_cast<int>(list[0]) - FORCE, FORCE * sizeof(double));
}

int FixContactHistory::size_restart(int i)
{
  return FixNeighHistory::size_restart(i) + FORCE;
}

int FixContactHistory::maxsize_restart()
{
  return FixNeighHistory::maxsize_restart() + FORCE;
}

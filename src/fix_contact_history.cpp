/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What pair gran/restitution remembers: LAMMPS' own neighbor history for the contacts and, for
   each ball, the velocities of the last half step, so that a run that goes on starts from the
   forces with which the one before ended. Made by the pair style, not by users. */

#include "fix_contact_history.h"

#include "atom.h"
#include "comm.h"
#include "memory.h"
#include "pair_gran_restitution.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

FixContactHistory::FixContactHistory(LAMMPS *lmp, int narg, char **arg) :
    FixNeighHistory(lmp, narg, arg), lists_new(true), lists_used(false), kick(nullptr),
    kick_step(-1)
{
  FixContactHistory::grow_arrays(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) FixContactHistory::set_arrays(i);
}

FixContactHistory::~FixContactHistory()
{
  memory->destroy(kick);
}

/* ----------------------------------------------------------------------
   From the lists to storage by atom. Only when the lists have been used since: after
   write_restart has moved atoms between ranks, they name atoms that are no longer there.
------------------------------------------------------------------------- */

void FixContactHistory::pre_exchange()
{
  if (!lists_used) return;
  lists_used = false;
  static_cast<PairGranRestitution *>(pair)->store_flags();
  FixNeighHistory::pre_exchange();
  maxexchange += KICK;
}

void FixContactHistory::post_neighbor()
{
  FixNeighHistory::post_neighbor();
  lists_new = true;
}

void FixContactHistory::post_run()
{
  FixNeighHistory::post_run();
  find_kicks();
  static_cast<PairGranRestitution *>(pair)->report_overlaps();
}

/* ----------------------------------------------------------------------
   velocity Verlet's second half step, for solid balls
------------------------------------------------------------------------- */

void FixContactHistory::find_kicks()
{
  const double half = 0.5 * update->dt;
  for (int i = 0; i < atom->nlocal; i++) {
    const double per_mass = half / atom->rmass[i];
    const double per_inertia = per_mass / (0.4 * atom->radius[i] * atom->radius[i]);
    for (int d = 0; d < 3; d++) {
      kick[i][d] = per_mass * atom->f[i][d];
      kick[i][3 + d] = per_inertia * atom->torque[i][d];
    }
  }
  kick_step = update->ntimestep;
}

bool FixContactHistory::kicks_known() const
{
  return kick_step == update->ntimestep;
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

double FixContactHistory::memory_usage()
{
  return FixNeighHistory::memory_usage() + static_cast<double>(atom->nmax) * KICK * sizeof(double);
}

void FixContactHistory::grow_arrays(int nmax)
{
  FixNeighHistory::grow_arrays(nmax);
  memory->grow(kick, nmax, KICK, "contact_history:kick");
}

void FixContactHistory::copy_arrays(int i, int j, int delflag)
{
  FixNeighHistory::copy_arrays(i, j, delflag);
  memcpy(kick[j], kick[i], KICK * sizeof(double));
}

void FixContactHistory::set_arrays(int i)
{
  FixNeighHistory::set_arrays(i);
  memset(kick[i], 0, KICK * sizeof(double));
}

int FixContactHistory::pack_exchange(int i, double *buf)
{
  const int m = FixNeighHistory::pack_exchange(i, buf);
  if (!kicks_known()) return m;
  memcpy(&buf[m], kick[i], KICK * sizeof(double));
  return m + KICK;
}

int FixContactHistory::unpack_exchange(int i, double *buf)
{
  const int m = FixNeighHistory::unpack_exchange(i, buf);
  if (!kicks_known()) return m;
  memcpy(kick[i], &buf[m], KICK * sizeof(double));
  return m + KICK;
}

/* ----------------------------------------------------------------------
   restart file
------------------------------------------------------------------------- */

void FixContactHistory::write_restart(FILE *fp)
{
  pre_exchange();
  if (!kicks_known() && update->whichflag == 1) find_kicks();    // in a run: forces are known
  if (comm->me == 0) {
    const double step = kick_step;
    const int size = sizeof(step);
    fwrite(&size, sizeof(int), 1, fp);
    fwrite(&step, sizeof(step), 1, fp);
  }
}

void FixContactHistory::restart(char *buf)
{
  double step;
  memcpy(&step, buf, sizeof(step));
  kick_step = static_cast<bigint>(step);
}

int FixContactHistory::pack_restart(int i, double *buf)
{
  int m = FixNeighHistory::pack_restart(i, buf);
  memcpy(&buf[m], kick[i], KICK * sizeof(double));
  m += KICK;
  buf[0] = m;
  return m;
}

void FixContactHistory::unpack_restart(int i, int nth)
{
  FixNeighHistory::unpack_restart(i, nth);
  const double *extra = atom->extra[i];
  int m = 0;
  for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
  m += static_cast<int>(extra[m]) - KICK;
  memcpy(kick[i], &extra[m], KICK * sizeof(double));
}

int FixContactHistory::size_restart(int i)
{
  return FixNeighHistory::size_restart(i) + KICK;
}

int FixContactHistory::maxsize_restart()
{
  return FixNeighHistory::maxsize_restart() + KICK;
}

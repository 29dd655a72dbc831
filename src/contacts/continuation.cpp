/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "continuation.h"

#include "atom.h"
#include "ball_sweep.h"
#include "comm.h"
#include "contact_step.h"
#include "fix.h"
#include "lammps_compat.h"
#include "memory.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using Slope::Vector;

static constexpr double ROUNDING = 1.0e-10;    // of the largest force
static constexpr int ALL = 63;                 // velocities and spins, by bits
static constexpr double CAME = HUGE_VAL;       // for a velocity ahead: the ball came in this step

/* ---------------------------------------------------------------------- */

Continuation::Continuation(LAMMPS *lmp) :
    Pointers(lmp), force(nullptr), ahead_now(nullptr), looked(-1), step(-1), dt(0.0), guided(false)
{
}

Continuation::~Continuation()
{
  memory->destroy(force);
  memory->destroy(ahead_now);
}

/* ---------------------------------------------------------------------- */

bool Continuation::forces_known() const
{
  return step == update->ntimestep && dt == update->dt;
}

void Continuation::keep_forces()
{
  for (int i = 0; i < atom->nlocal; i++) {
    memcpy(force[i], atom->f[i], 3 * sizeof(double));
    memcpy(&force[i][3], atom->torque[i], 3 * sizeof(double));
    force[i][CHANGED] = changed(i);
  }
  step = update->ntimestep;
  dt = update->dt;
  keep_ahead();
}

/* ----------------------------------------------------------------------
   Which velocities the second half of the step has changed: none that fix move prescribes, none of fix
   nve/noforce. Fixes do not tell.
------------------------------------------------------------------------- */

bool Continuation::others_move() const
{
  int known = 0, mine = 0, any;
  for (const Fix *fix : compat::fixes(lmp)) {
    const bool integrates = Slope::is_style(fix->style, "nve/sphere");
    if (fix->time_integrate && !integrates) return true;
    if (integrates || Slope::is_style(fix->style, "freeze")) known |= fix->groupbit;
  }
  for (int i = 0; i < atom->nlocal; i++)
    if (!(atom->mask[i] & known)) mine = 1;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

void Continuation::note_half_step()
{
  if (!guided || atom->nlocal == 0) return;
  const auto *const now = reinterpret_cast<const Vector *>(atom->v[0]);
  const auto *const spin = reinterpret_cast<const Vector *>(atom->omega[0]);
  v_half.assign(now, now + atom->nlocal);
  omega_half.assign(spin, spin + atom->nlocal);
}

int Continuation::changed(int i) const
{
  if (!guided || i >= static_cast<int>(v_half.size())) return ALL;
  int bits = 0;
  for (int d = 0; d < 3; d++) {
    if (atom->v[i][d] != (&v_half[i].x)[d]) bits |= 1 << d;
    if (atom->omega[i][d] != (&omega_half[i].x)[d]) bits |= 8 << d;
  }
  return bits;
}

/* ----------------------------------------------------------------------
   less velocity Verlet's second half step, for solid balls
------------------------------------------------------------------------- */

void Continuation::find_half_step()
{
  forget_half_step();
  guided = others_move();
  v_half.clear();
  omega_half.clear();
  if (!forces_known()) return;

  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  v.reserve(nall + 1);    // contacts are read 32 bytes at a time, 8 beyond a vector
  omega.reserve(nall + 1);
  ahead_again.reserve(nall + 1);
  take_back_half_step();
  ahead_again.resize(nall);
  for (int i = 0; i < nlocal; i++) {
    const double *const u = atom->v[i], *const beyond = &force[i][BEYOND];
    ahead_again[i] = {u[0] + beyond[0], u[1] + beyond[1], u[2] + beyond[2]};
  }
  comm->forward_comm();    // to the ghosts
  swap_velocities();
}

void Continuation::forget_half_step()
{
  v.clear();
  omega.clear();
  ahead_again.clear();
}

// v and omega: what LAMMPS has; then LAMMPS has those of the middle, of this rank's balls

void Continuation::take_back_half_step()
{
  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  v.assign(vectors(atom->v), vectors(atom->v) + nall);
  omega.assign(vectors(atom->omega), vectors(atom->omega) + nall);
  for (Fix *fix : compat::fixes_of_style(lmp, "ground/motion"))
    dynamic_cast<Kick *>(fix)->take_back_kick();
  for (int i = 0; i < nlocal; i++) {
    const double *const f = force[i];
    const double a = 0.5 * dt / atom->rmass[i];
    const double b = a / (0.4 * atom->radius[i] * atom->radius[i]);
    const int bits = static_cast<int>(f[CHANGED]);
    for (int d = 0; d < 3; d++) {
      if (bits >> d & 1) atom->v[i][d] -= a * f[d];
      if (bits >> d & 8) atom->omega[i][d] -= b * f[3 + d];
    }
  }
}

void Continuation::swap_velocities()
{
  std::swap_ranges(v.begin(), v.end(), vectors(atom->v));
  std::swap_ranges(omega.begin(), omega.end(), vectors(atom->omega));
}

/* ---------------------------------------------------------------------- */

Vector *Continuation::to_look_ahead()
{
  return vectors(ahead_now);
}

void Continuation::note_looked()
{
  looked = update->ntimestep;
}

void Continuation::look_ahead()
{
  if (looked == update->ntimestep) return;
  const double part = Slope::AHEAD * update->dt;
  const Vector *const u = vectors(atom->v), *const f = vectors(atom->f);
  const double *const mass = atom->rmass;
  Vector *const to = vectors(ahead_now);
  const int n = atom->nlocal;
  int i = 0;
  for (; i + 4 <= n; i += 4)
    Slope::sum_four(&to[i].x, &u[i].x, Slope::OfComponents(part / Slope::four(&mass[i])), &f[i].x);
  for (; i < n; i++) {
    const double a = part / mass[i];
    to[i] = {u[i].x + a * f[i].x, u[i].y + a * f[i].y, u[i].z + a * f[i].z};
  }
  looked = update->ntimestep;
}

void Continuation::look_ahead_of_new_balls()
{
  for (int i = 0; i < atom->nlocal; i++)
    if (ahead_now[i][0] == CAME) std::copy_n(atom->v[i], 3, ahead_now[i]);
}

Vector *Continuation::ahead()
{
  return v.empty() ? vectors(ahead_now) : ahead_again.data();
}

// In a step that has looked ahead. Velocities may be changed until the set-up: what they are more than others is kept.

void Continuation::keep_ahead()
{
  if (looked != step) {
    for (int i = 0; i < atom->nlocal; i++) std::fill_n(&force[i][BEYOND], 3, 0.0);
    return;
  }
  take_back_half_step();
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) force[i][BEYOND + d] = ahead_now[i][d] - atom->v[i][d];
  swap_velocities();
  forget_half_step();
}

/* ---------------------------------------------------------------------- */

void Continuation::begin_step()
{
  const bool kept = step == update->ntimestep - 1 && step == update->firststep;
  step = looked = -1;                   // a step of this number may come again: reset_timestep
  double mine[4] = {}, most[4] = {};    // largest force, torque; differences
  for (int i = 0; i < atom->nlocal && kept; i++)
    for (int d = 0; d < 3; d++) {
      mine[0] = std::max(mine[0], std::fabs(force[i][d]));
      mine[1] = std::max(mine[1], std::fabs(force[i][3 + d]));
      mine[2] = std::max(mine[2], std::fabs(force[i][d] - atom->f[i][d]));
      mine[3] = std::max(mine[3], std::fabs(force[i][3 + d] - atom->torque[i][d]));
    }
  if (kept) MPI_Allreduce(mine, most, 4, MPI_DOUBLE, MPI_MAX, world);
  const bool same = kept && most[2] <= ROUNDING * most[0] && most[3] <= ROUNDING * most[1];
  for (int i = 0; i < atom->nlocal && same; i++) {
    memcpy(atom->f[i], force[i], 3 * sizeof(double));
    memcpy(atom->torque[i], &force[i][3], 3 * sizeof(double));
  }
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

void Continuation::grow(int nmax)
{
  memory->grow(force, nmax, KEPT, "continuation:force");
  memory->grow(ahead_now, nmax, 3, "continuation:ahead");
}

void Continuation::copy(int from, int to)
{
  memcpy(force[to], force[from], KEPT * sizeof(double));
  memcpy(ahead_now[to], ahead_now[from], 3 * sizeof(double));
}

void Continuation::clear(int i)
{
  memset(force[i], 0, KEPT * sizeof(double));
  ahead_now[i][0] = CAME;
}

int Continuation::pack(int i, double *buf) const
{
  memcpy(buf, force[i], KEPT * sizeof(double));
  memcpy(buf + KEPT, ahead_now[i], 3 * sizeof(double));
  return STORED;
}

int Continuation::unpack(int i, const double *buf)
{
  memcpy(force[i], buf, KEPT * sizeof(double));
  memcpy(ahead_now[i], buf + KEPT, 3 * sizeof(double));
  return STORED;
}

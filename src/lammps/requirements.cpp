/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "requirements.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "inserted_balls.h"
#include "lammps_compat.h"
#include "update.h"

#include <cmath>
#include <functional>
#include <vector>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   Contacts remember the steps before, which those of minimize do not have; r-RESPA asks each style for the
   forces of a level, which ours do not have: balls would fall through the ground
------------------------------------------------------------------------- */

void LAMMPS_NS::require_run(LAMMPS *lmp, const std::string &caller)
{
  const Update *update = lmp->update;
  if (update->whichflag == 2) lmp->error->all(FLERR, "{} needs run, got minimize", caller);
  if (utils::strmatch(update->integrate_style, "^respa"))
    lmp->error->all(FLERR, "{} needs run_style verlet, got {}", caller, update->integrate_style);
  if (!(update->dt > 0.0 && std::isfinite(update->dt)))
    lmp->error->all(FLERR, "{} needs timestep > 0, got {:g}", caller, update->dt);
}

/* ----------------------------------------------------------------------
   rerun sets up each snapshot and ends a step there, in which nothing has moved
------------------------------------------------------------------------- */

void LAMMPS_NS::require_step(LAMMPS *lmp, const std::string &caller, bigint set_up)
{
  if (lmp->update->ntimestep == set_up)
    lmp->error->all(FLERR, "{} needs run, got rerun: unfix it before, its files stay as they are",
                    caller);
}

/* ---------------------------------------------------------------------- */

bool LAMMPS_NS::in_si(const LAMMPS *lmp)
{
  return strcmp(lmp->update->unit_style, "si") == 0;
}

// micrometers per microsecond, and so on, are meters per second

double LAMMPS_NS::from_si_speed(const LAMMPS *lmp, double speed)
{
  return strcmp(lmp->update->unit_style, "cgs") == 0 ? 100.0 * speed : speed;
}

/* ----------------------------------------------------------------------
   the law takes stiffness times length for a force, and mass times velocity squared for an energy
------------------------------------------------------------------------- */

void LAMMPS_NS::require_plain_units(LAMMPS *lmp, const std::string &caller)
{
  const Force *force = lmp->force;
  if (force->ftm2v != 1.0 || force->mvv2e != 1.0)
    lmp->error->all(FLERR, "{} units must be si, cgs, lj, micro or nano, got {}", caller,
                    lmp->update->unit_style);
}

/* ----------------------------------------------------------------------
   The law takes mass and inertia of each ball as those of a solid sphere that moves by itself. In a
   rigid body dashpots, the exact scheme and the velocities at set-up would be those of another mass.
------------------------------------------------------------------------- */

void LAMMPS_NS::require_single_balls(LAMMPS *lmp, const std::string &caller)
{
  for (const Fix *fix : compat::fixes(lmp)) {
    if (fix->rigid_flag)
      lmp->error->all(
          FLERR,
          "{}: balls must move one by one, got fix {} {}, whose bodies have another mass than "
          "a ball: use fix nve/sphere, or pair_style granular for rigid bodies",
          caller, fix->id, fix->style);
  }
}

/* ----------------------------------------------------------------------
   In two dimensions, too, balls are solid spheres to the law: its time constants of sliding and rolling
   are those of 2/5 m r^2, and the energy guard's spins.
------------------------------------------------------------------------- */

void LAMMPS_NS::require_spheres(LAMMPS *lmp, const std::string &caller)
{
  for (Fix *fix : compat::fixes_of_style(lmp, "nve/sphere"))
    if (compat::moves_discs(fix))
      lmp->error->all(
          FLERR,
          "{}: fix {} {} must turn balls as solid spheres, got disc: leave it out, in two "
          "dimensions, too",
          caller, fix->id, fix->style);
}

/* ----------------------------------------------------------------------
   Friction turns a ball that rolls or slides. Where its integrator leaves the spin at 0, as fix nve does,
   the spring of its contact holds it on any slope. Two integrators move a ball twice in a step.
------------------------------------------------------------------------- */

static bool integrates_spins(const std::string &style)
{
  return style.find("sphere") != std::string::npos || style == "move" || style == "nve/noforce" ||
      style == "python/move";
}

void LAMMPS_NS::require_spins(LAMMPS *lmp, const std::string &caller, int frozen)
{
  const Atom *atom = lmp->atom;
  const auto count = [&](const std::function<bool(int)> &test) {
    bigint mine = 0, all;
    for (int i = 0; i < atom->nlocal; i++) mine += test(atom->mask[i]);
    MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
    return all;
  };
  std::vector<const Fix *> movers;
  for (const Fix *fix : compat::fixes(lmp))
    if (fix->time_integrate) movers.push_back(fix);

  std::string names;
  for (const Fix *fix : movers) {
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", fix->id, fix->style);
    if (integrates_spins(Slope::plain_style(fix->style))) continue;
    const bigint held = count([&](int mask) {
      return (mask & fix->groupbit) && (mask & frozen);
    });
    const bigint all = count([&](int mask) {
      return mask & fix->groupbit;
    });
    if (all > 0 && all == held) continue;    // none yet: of fix pour or fix deposit
    lmp->error->all(FLERR,
                    "{}: what moves balls must integrate their spins, got fix {} {}, with which "
                    "friction holds a ball that should roll: use fix nve/sphere",
                    caller, fix->id, fix->style);
  }
  const bigint twice = count([&](int mask) {
    int n = 0;
    for (const Fix *fix : movers) n += (mask & fix->groupbit) != 0;
    return n > 1 && !(mask & frozen);
  });
  if (twice)
    lmp->error->all(FLERR, "{}: each ball must be moved by one fix, got {} balls with more, of {}",
                    caller, twice, names);
}

/* ----------------------------------------------------------------------
   LAMMPS keeps what contacts remember by the ID of the other ball: the second contact of the same two balls, across a
   periodic side, would have the history of the first one. In two dimensions no ball has an image along z.
------------------------------------------------------------------------- */

void LAMMPS_NS::require_wide_box(LAMMPS *lmp, const std::string &caller, double reach)
{
  const Domain *domain = lmp->domain;
  if (lmp->atom->natoms < 2 && inserted_balls(lmp).empty()) return;
  const double *h = domain->h_inv;    // rows: h[0] h[5] h[4], h[1] h[3], h[2]
  const double width[3] = {1.0 / std::sqrt(h[0] * h[0] + h[5] * h[5] + h[4] * h[4]),
                           1.0 / std::sqrt(h[1] * h[1] + h[3] * h[3]), 1.0 / h[2]};
  for (int d = 0; d < domain->dimension; d++)
    if (domain->periodicity[d] && width[d] <= 2.0 * reach)
      lmp->error->all(FLERR,
                      "{}: a periodic box must be wider than {:g}, two of the largest balls that "
                      "can touch, or they touch at both sides, got {:g} along {}",
                      caller, 2.0 * reach, width[d], "xyz"[d]);
}

/* ----------------------------------------------------------------------
   A factor of 0 takes a pair out of the neighbor list, where LAMMPS does that for spheres, and of 1
   leaves it there, as for every pair style; with anything else LAMMPS marks it, for a pair style that
   scales its force.
------------------------------------------------------------------------- */

void LAMMPS_NS::require_whole_contacts(LAMMPS *lmp, const std::string &caller)
{
  if (!lmp->atom->molecular) return;
  const double *lj = lmp->force->special_lj, *coul = lmp->force->special_coul;
  for (int k = 1; k <= 3; k++)
    if (lj[k] != coul[k] || (lj[k] != 0.0 && lj[k] != 1.0))
      lmp->error->all(
          FLERR,
          "{}: special_bonds must be 0 or 1, the same for lj and coul, as balls that are bonded "
          "touch fully or not at all, got lj {:g} {:g} {:g} coul {:g} {:g} {:g}",
          caller, lj[1], lj[2], lj[3], coul[1], coul[2], coul[3]);
    else if (lj[k] == 0.0 && !compat::LISTS_OF_SPHERES_KNOW_BONDS)
      lmp->error->all(
          FLERR,
          "{}: special_bonds must be lj/coul 1 1 1 where balls have bonds, as LAMMPS "
          "before 23Jun2022 keeps bonded spheres in its neighbor lists, got lj {:g} {:g} {:g}",
          caller, lj[1], lj[2], lj[3]);
}

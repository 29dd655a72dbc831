/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What a run must be like for contacts to be right. Each ends a run that is not with one line, which
   starts with the caller: without it the results would be wrong and nothing would say so. To be
   called by all ranks in init(). */

#ifndef SLOPE_REQUIREMENTS_H
#define SLOPE_REQUIREMENTS_H

#include "lmptype.h"

#include <string>

namespace LAMMPS_NS {
class LAMMPS;

bool in_si(const LAMMPS *);                            // the units of the deck
double from_si_speed(const LAMMPS *, double speed);    // in its units; reduced ones (lj) have none

void require_run(LAMMPS *,
                 const std::string &caller);    // with run_style verlet, forwards; no minimize
// at the end of a step; set_up: the step of the last set-up
void require_step(LAMMPS *, const std::string &caller, bigint set_up);
void require_plain_units(LAMMPS *, const std::string &caller);
void require_single_balls(LAMMPS *, const std::string &caller);    // no rigid bodies
void require_spheres(LAMMPS *, const std::string &caller);         // no discs
// what moves balls turns them, too, and one fix each; frozen: group bits of balls that do not move
void require_spins(LAMMPS *, const std::string &caller, int frozen);
// a periodic box in which two balls touch at one side only; reach: m, largest distance of two that touch
void require_wide_box(LAMMPS *, const std::string &caller, double reach);
void require_whole_contacts(LAMMPS *,
                            const std::string &caller);    // special_bonds, if there are bonds

}    // namespace LAMMPS_NS

#endif

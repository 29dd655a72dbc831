/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What a run must be like for contacts to be right. Each ends a run that is not with one line, which
   starts with the caller: without it the results would be wrong and nothing would say so. To be
   called by all ranks in init(). */

#ifndef SLOPE_REQUIREMENTS_H
#define SLOPE_REQUIREMENTS_H

#include <string>

namespace LAMMPS_NS {
class LAMMPS;

void require_verlet(LAMMPS *, const std::string &caller);
void require_single_balls(LAMMPS *, const std::string &caller);    // no rigid bodies
void require_whole_contacts(LAMMPS *,
                            const std::string &caller);    // special_bonds, if there are bonds

}    // namespace LAMMPS_NS

#endif

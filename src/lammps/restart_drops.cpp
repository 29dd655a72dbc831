/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "restart_drops.h"

#include "error.h"
#include "fix.h"
#include "lammps_compat.h"
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void RestartDrops::check()
{
  for (int i = 0; i < modify->nfix; i++) {
    const Fix *fix = modify->fix[i];
    if (std::find(dropped.begin(), dropped.end(), Name(fix->id, fix->style)) != dropped.end())
      error->all(FLERR,
                 "Fix {} {} must be defined before the first command after read_restart that sets "
                 "up a run, such as "
                 "balance, at which LAMMPS drops what the file has for it, got it after that: "
                 "define it before, or "
                 "with another ID if it is to begin anew",
                 fix->id, fix->style);
  }
  const auto drop = [this](const compat::RestartList &list) {
    for (int k = 0; k < list.number; k++)
      if (!list.used[k]) dropped.emplace_back(list.id[k], list.style[k]);
  };
  drop(compat::restart_of_fixes(modify));
  drop(compat::restart_by_atom(modify));
}

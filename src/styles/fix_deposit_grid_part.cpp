/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fix_deposit_grid_part.h"

#include "fix_deposit_grid.h"
#include "lammps_compat.h"
#include "style_argument.h"

#include "error.h"

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

FixDepositGridPart::FixDepositGridPart(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), piece(0)
{
  if (narg != 5)
    error->all(FLERR, "Fix DEPOSIT_GRID_PART is added by fix deposit/grid, and by nothing else");
  deposit_id = arg[3];
  piece = whole_number_argument(lmp, "Fix DEPOSIT_GRID_PART piece", arg[4]);
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

void FixDepositGridPart::write_restart(FILE *fp)
{
  deposit()->write_piece(fp, piece);
}

/* ---------------------------------------------------------------------- */

void FixDepositGridPart::restart(char *buffer)
{
  deposit()->read_piece(buffer, piece);
}

/* ---------------------------------------------------------------------- */

FixDepositGrid *FixDepositGridPart::deposit() const
{
  for (Fix *fix : compat::fixes_of_style(lmp, "deposit/grid"))
    if (deposit_id == fix->id) return static_cast<FixDepositGrid *>(fix);
  error->all(FLERR, "Fix DEPOSIT_GRID_PART needs fix deposit/grid {}, which does not exist",
             deposit_id);
  return nullptr;
}

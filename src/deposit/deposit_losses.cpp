/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_losses.h"

#include "deposit_balls.h"
#include "large_messages.h"

using namespace LAMMPS_NS;
using Slope::MassLedger;

/* ---------------------------------------------------------------------- */

void DepositLosses::begin_command()
{
  MassLedger::begin_command(balls.outside(nullptr));
}

/* ---------------------------------------------------------------------- */

void DepositLosses::end_command()
{
  if (in_command()) MassLedger::end_command(balls.outside(nullptr));
}

/* ---------------------------------------------------------------------- */

void DepositLosses::before_exchange()
{
  lose(balls.outside(this));
}

/* ---------------------------------------------------------------------- */

std::vector<std::string> DepositLosses::add_up()
{
  double mine[2] = {lost_here().number, lost_here().volume}, all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  Mass gone;
  gone.number = all[0];
  gone.volume = all[1];
  const double before = lost.number;
  take_here(gone);
  if (gone.number == 0.0 || !must_log()) return {};
  std::vector<Loss> first = gather_records(world, take_notes());
  share(world, first);
  return lines(first, before);
}

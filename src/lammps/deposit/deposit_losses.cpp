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
  ledger.begin_command(balls.outside(nullptr));
}

/* ---------------------------------------------------------------------- */

void DepositLosses::end_command()
{
  if (ledger.in_command()) ledger.end_command(balls.outside(nullptr));
}

/* ---------------------------------------------------------------------- */

void DepositLosses::before_exchange()
{
  ledger.lose(balls.outside(&ledger));
}

/* ---------------------------------------------------------------------- */

std::vector<std::string> DepositLosses::add_up()
{
  double mine[2] = {ledger.lost_here().number, ledger.lost_here().volume}, all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_SUM, world);
  MassLedger::Mass gone;
  gone.number = all[0];
  gone.volume = all[1];
  const double before = ledger.lost.number;
  ledger.take_here(gone);
  if (gone.number == 0.0 || !ledger.must_log()) return {};
  std::vector<MassLedger::Loss> first = gather_records(world, ledger.take_notes());
  share(world, first);
  return ledger.lines(first, before);
}

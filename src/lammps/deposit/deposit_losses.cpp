/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_losses.h"

#include "deposit_balls.h"
#include "deposit_exchange.h"

#include "comm.h"

#include <algorithm>
#include <cmath>

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
  return ledger.lines(first_of_all_ranks(), before);
}

/* ----------------------------------------------------------------------
   by step, then by ball; one after the other, so that nothing is gathered from all ranks
------------------------------------------------------------------------- */

std::vector<MassLedger::Loss> DepositLosses::first_of_all_ranks()
{
  std::vector<MassLedger::Loss> mine = ledger.take_notes(), found;
  std::sort(mine.begin(), mine.end(), MassLedger::earlier);
  DepositExchange exchange(lmp);
  for (size_t next = 0; found.size() < MassLedger::MAXLOGGED;) {
    const bool any = next < mine.size();
    const double step = exchange.smallest(any ? mine[next].step : HUGE_VAL);
    const int rank =
        exchange.rank_of_smallest(any && mine[next].step == step ? mine[next].tag : HUGE_VAL);
    if (rank < 0) break;
    MassLedger::Loss loss = MassLedger::Loss();
    if (comm->me == rank) loss = mine[next++];
    MPI_Bcast(&loss, sizeof(loss) / sizeof(double), MPI_DOUBLE, rank, world);
    found.push_back(loss);
  }
  return found;
}

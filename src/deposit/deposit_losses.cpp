/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_losses.h"

#include "deposit_balls.h"
#include "deposit_left.h"
#include "large_messages.h"

#include "atom.h"
#include "update.h"

using namespace LAMMPS_NS;
using Slope::MassLedger;

enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

MassLedger::Mass DepositLosses::mass_of(const std::vector<int> &some) const
{
  Mass sum;
  for (const int i : some) sum.volume += balls.volume_of(i);
  sum.number = (double) some.size();
  return sum;
}

/* ---------------------------------------------------------------------- */

void DepositLosses::begin_command(double now)
{
  const std::vector<int> outside = balls.outside();
  MassLedger::begin_command(mass_of(outside));
  left.begin_command(outside, now);
}

/* ---------------------------------------------------------------------- */

void DepositLosses::end_command()
{
  if (!in_command()) return;
  const std::vector<int> still = balls.outside();
  MassLedger::end_command(mass_of(still));
  left.end_command(still);
}

/* ---------------------------------------------------------------------- */

void DepositLosses::before_exchange(double now)
{
  const std::vector<int> outside = balls.outside();
  lose(mass_of(outside));
  for (const int i : outside) {
    const double *x = atom->x[i];
    note({(double) atom->tag[i], {x[X], x[Y], x[Z]}, (double) update->ntimestep});
    left.lose(i, now);
  }
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
  broadcast(world, first);
  return lines(first, before);
}

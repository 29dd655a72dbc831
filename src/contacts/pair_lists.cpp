/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "pair_lists.h"

#include "atom.h"
#include "atom_vec.h"
#include "contact_energy.h"
#include "contact_guards.h"
#include "fix_neigh_history.h"
#include "neigh_list.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace Slope;

/* ---------------------------------------------------------------------- */

void PairLists::build(const NeighList &near, FixNeighHistory &history, int frozen, bool vary,
                      ContactGuards &guards)
{
  // contacts are read 32 bytes at a time, 8 beyond a vector: there must be something beyond the last

  if (atom->nlocal + atom->nghost >= atom->nmax) atom->avec->grow(0);

  const int n = atom->ntypes + 1;
  lists.resize(SIDES * n * n);
  for (size_t k = 0; k < lists.size(); k++)
    lists[k].clear(k % SIDES != I_FROZEN, k % SIDES != J_FROZEN);

  double **const x = atom->x;
  const double *const radius = atom->radius;
  const double *const rmass = atom->rmass;
  const int *const mask = atom->mask;
  const int *const type = atom->type;
  for (int ii = 0; ii < near.inum; ii++) {
    const int i = near.ilist[ii];
    const bool frozen_i = mask[i] & frozen;
    const int *const jlist = near.firstneigh[i];
    int *const flags = history.firstflag[i];
    double *const values = history.firstvalue[i];

    for (int jj = 0; jj < near.numneigh[i]; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      const bool frozen_j = mask[j] & frozen;
      if (frozen_i && frozen_j) continue;
      ContactList &l = lists[SIDES * (type[i] * n + type[j]) +
                             (frozen_i       ? I_FROZEN
                                  : frozen_j ? J_FROZEN
                                             : BOTH_MOVE)];
      l.add(i, j, &values[HISTORY * jj], flags[jj], radius[i], radius[j], rmass[i], rmass[j]);
      l.flags.push_back(&flags[jj]);

      if (!flags[jj]) continue;
      const double *const a = x[i], *const b = x[j];
      const double r = sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                            (a[2] - b[2]) * (a[2] - b[2]));
      guards.record_overlap(i, radius[i] + radius[j] - r, std::min(radius[i], radius[j]));
    }
  }
  if (vary)
    for (ContactList &l : lists) l.let_vary();
}

/* ---------------------------------------------------------------------- */

void PairLists::find(bool repeat, const MovingBalls &balls, const MovingPartners &partners,
                     const ContactGuards &guards)
{
  if (repeat) {
    InitialOverlap initial(lmp, guards);
    for (ContactList &l : lists)
      l.adopt_overlaps(balls, partners, [&](const ContactList::Entry &e, double overlap) {
        initial.record(overlap, std::min(atom->radius[e.i], atom->radius[e.j]), atom->tag[e.i],
                       atom->x[e.i], fmt::format("ball {}", atom->tag[e.j]));
      });
    initial.check("Pair gran/restitution");
  }
  for (ContactList &l : lists) l.find(repeat, balls, partners);
}

/* ---------------------------------------------------------------------- */

double PairLists::elastic_energy(const MovingBalls &balls, const MovingPartners &partners,
                                 ContactGuards &guards)
{
  double energy = 0.0;
  for_each([&](const ContactList &l, const ContactLaw &law) {
    energy += Slope::elastic_energy(
        l, law, update->dt, balls, partners, [&](const ContactList::Entry &e, double overlap) {
          guards.record_overlap(e.i, overlap, std::min(atom->radius[e.i], atom->radius[e.j]));
        });
  });
  return energy;
}

/* ---------------------------------------------------------------------- */

void PairLists::flag_histories() const
{
  for (const ContactList &l : lists) l.flag_histories();
}

double PairLists::memory_usage() const
{
  double bytes = 0.0;
  for (const ContactList &l : lists) bytes += l.memory_usage();
  return bytes;
}

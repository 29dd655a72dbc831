/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What pair gran/restitution remembers: LAMMPS' own neighbor history for the contacts and, for
   each ball, what a continuation needs. LAMMPS finds the partners of a ball by ID: IDs that change
   between runs are followed. Made by the pair style. */

#include "fix_contact_history.h"

#include "atom.h"
#include "comm.h"
#include "contact_guards.h"
#include "energy_guard.h"
#include "exchange_size.h"
#include "lammps_compat.h"
#include "memory.h"
#include "pair.h"
#include "pair_lists.h"
#include "update.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace FixConst;

static constexpr int STORED = Continuation::STORED;
static constexpr int VERSION = 4;    // of what restart files hold
static const std::string CALLER = "Pair gran/restitution";

/* ---------------------------------------------------------------------- */

FixContactHistory::FixContactHistory(LAMMPS *lmp, int narg, char **arg) :
    FixNeighHistory(lmp, narg, arg), guards(nullptr), lists(nullptr), continuation(lmp),
    lists_new(true), lists_used(false), known_as(nullptr), restart_extra(lmp)
{
  comm_forward = 1;
  nevery = EnergyGuard::FINITE_EVERY;
  FixContactHistory::grow_arrays(atom->nmax);
  for (int i = 0; i < atom->nlocal; i++) FixContactHistory::set_arrays(i);
}

FixContactHistory::~FixContactHistory()
{
  memory->destroy(known_as);
}

/* ----------------------------------------------------------------------
   From the lists to storage by atom. Only when the lists have been used since: after
   write_restart has moved atoms between ranks, they name atoms that are no longer there.
------------------------------------------------------------------------- */

void FixContactHistory::pre_exchange()
{
  guards->energy.end_list();
  guards->growth.end_list();
  store_contacts();
}

void FixContactHistory::store_contacts()
{
  if (!lists_used) return;
  lists_used = false;
  lists->flag_histories();
  FixNeighHistory::pre_exchange();
  maxexchange = exchange_size(lmp, most_packed());
  std::copy_n(atom->tag, atom->nlocal, known_as);
}

// A contact that has ended keeps its history for a step: LAMMPS hands it out beyond contact only if the
// pair style says that it acts there, which compute fabric refuses, and which would not be true.

void FixContactHistory::post_neighbor()
{
  pair->beyond_contact = 1;
  FixNeighHistory::post_neighbor();
  pair->beyond_contact = 0;
  lists_new = true;
  continuation.look_ahead_of_new_balls();
  guards->energy.begin_list();
  guards->growth.begin_list();
}

bool FixContactHistory::take_new_lists()
{
  const bool told = lists_new;
  lists_new = false;
  return told;
}

void FixContactHistory::setup_post_neighbor()
{
  rename_partners();
  FixNeighHistory::setup_post_neighbor();
}

/* ----------------------------------------------------------------------
   Between runs delete_atoms and reset_atoms may give balls other IDs, and create_atoms the ID of one
   that is gone: the stored contacts get the present IDs of their partners, all of them near, and
   those of partners that are gone are dropped.
------------------------------------------------------------------------- */

void FixContactHistory::rename_partners()
{
  const tagint *tag = atom->tag;
  int mine = !std::equal(tag, tag + atom->nlocal, known_as), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return;

  compat::forward_comm(comm, this);
  std::unordered_map<tagint, tagint> now;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++)
    if (known_as[i]) now[known_as[i]] = tag[i];
  for (int i = 0; i < atom->nlocal; i++) {
    int n = 0;
    for (int m = 0; m < npartner[i]; m++) {
      const auto found = now.find(partner[i][m]);
      if (found == now.end()) continue;
      partner[i][n] = found->second;
      memmove(&valuepartner[i][dnum * n++], &valuepartner[i][dnum * m], dnum * sizeof(double));
    }
    npartner[i] = n;
  }
  std::copy_n(tag, atom->nlocal, known_as);
}

int FixContactHistory::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  for (int k = 0; k < n; k++) buf[k] = ubuf(known_as[list[k]]).d;
  return n;
}

void FixContactHistory::unpack_forward_comm(int n, int first, double *buf)
{
  for (int k = 0; k < n; k++) known_as[first + k] = static_cast<tagint>(ubuf(buf[k]).i);
}

/* ----------------------------------------------------------------------
   guards
------------------------------------------------------------------------- */

int FixContactHistory::setmask()
{
  return FixNeighHistory::setmask() | INITIAL_INTEGRATE | POST_INTEGRATE | END_OF_STEP;
}

void FixContactHistory::init()
{
  restart_extra.check(CALLER);
  FixNeighHistory::init();
  check_order();
  maxexchange = exchange_size(lmp, most_packed());    // of a restart file's contacts, too
}

// A fix that deletes balls gives the index of one to another before the contacts are stored, which name balls by index. Those
// that only add balls, or change the box, may come first.

void FixContactHistory::check_order() const
{
  for (const Fix *fix : compat::fixes(lmp)) {
    if (fix == this) return;
    if (!(compat::mask_of(lmp, fix) & PRE_EXCHANGE)) continue;
    bool keeps_balls = utils::strmatch(fix->style, "^n[pv][ht]");    // of boxes that are turned
    for (const char *style :
         {"append/atoms", "BOND_HISTORY", "CONTACT_HISTORY", "deform", "deposit", "DUMMY",
          "NEIGH_HISTORY", "pour", "wall/gran/balls", "wall/gran/mesh"})
      keeps_balls = keeps_balls || Slope::is_style(fix->style, style);
    if (!keeps_balls)
      error->all(FLERR,
                 "{}: fix {} {} must be defined after pair_style, got it before: it may take away "
                 "balls whose contacts are not stored yet",
                 CALLER, fix->id, fix->style);
  }
}

void FixContactHistory::setup(int)
{
  watch_energy();
}

void FixContactHistory::end_of_step()
{
  if (update->ntimestep % EnergyGuard::EVERY)
    guards->energy.check_finite();
  else
    watch_energy();
}

void FixContactHistory::post_run()
{
  FixNeighHistory::post_run();
  if (!continuation.forces_known()) continuation.keep_forces();
  if (update->ntimestep % EnergyGuard::EVERY) watch_energy();
  guards->report();
}

/* ---------------------------------------------------------------------- */

// by fix dt/reset

void FixContactHistory::reset_dt()
{
  if (update->whichflag == 1) guards->check_balls();
}

void FixContactHistory::initial_integrate(int)
{
  guards->begin_step();
  continuation.begin_step();
}

void FixContactHistory::post_integrate()
{
  continuation.look_ahead();
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

double FixContactHistory::memory_usage()
{
  return FixNeighHistory::memory_usage() +
      static_cast<double>(atom->nmax) * (STORED * sizeof(double) + sizeof(tagint));
}

void FixContactHistory::grow_arrays(int nmax)
{
  FixNeighHistory::grow_arrays(nmax);
  continuation.grow(nmax);
  memory->grow(known_as, nmax, "contact_history:known_as");
}

void FixContactHistory::copy_arrays(int i, int j, int delflag)
{
  FixNeighHistory::copy_arrays(i, j, delflag);
  continuation.copy(i, j);
  known_as[j] = known_as[i];
}

void FixContactHistory::set_arrays(int i)
{
  FixNeighHistory::set_arrays(i);
  continuation.clear(i);
  known_as[i] = 0;
  if (guards) guards->energy.ball_came();
}

int FixContactHistory::most_packed() const
{
  return 1 + (dnum + 1) * maxpartner + 1 + STORED;
}

int FixContactHistory::pack_exchange(int i, double *buf)
{
  int m = FixNeighHistory::pack_exchange(i, buf);
  buf[m++] = ubuf(known_as[i]).d;
  return m + continuation.pack(i, &buf[m]);
}

int FixContactHistory::unpack_exchange(int i, double *buf)
{
  int m = FixNeighHistory::unpack_exchange(i, buf);
  known_as[i] = static_cast<tagint>(ubuf(buf[m++]).i);
  return m + continuation.unpack(i, &buf[m]);
}

/* ----------------------------------------------------------------------
   restart file
------------------------------------------------------------------------- */

void FixContactHistory::write_restart(FILE *fp)
{
  if (update->whichflag == 0) rename_partners();
  store_contacts();
  if (!continuation.forces_known() && update->whichflag == 1)    // in a run: forces are known
    continuation.keep_forces();
  Slope::Archive to(style, VERSION);
  archive(to);
  write_archive(lmp, fp, CALLER, to);
}

void FixContactHistory::restart(char *buf)
{
  read_archive(lmp, CALLER, [&]() {
    Slope::Archive from(style, VERSION, buf);
    archive(from);
  });
}

void FixContactHistory::archive(Slope::Archive &archive)
{
  archive.same("numbers_of_a_contact", dnum);
  archive.same("numbers_of_a_ball", STORED);
  continuation.archive(archive);
}

int FixContactHistory::pack_restart(int i, double *buf)
{
  int m = FixNeighHistory::pack_restart(i, buf);
  m += continuation.pack(i, &buf[m]);
  buf[0] = m;
  return m;
}

void FixContactHistory::unpack_restart(int i, int nth)
{
  const double *list = restart_extra.record_of_ball(i, nth, 2 + STORED, 1 + dnum);
  if (!list) return;
  FixNeighHistory::unpack_restart(i, nth);
  known_as[i] = atom->tag[i];
  continuation.unpack(i, list + static_cast<int>(list[0]) - STORED);
  maxexchange = std::max(maxexchange, most_packed());
}

int FixContactHistory::size_restart(int i)
{
  return FixNeighHistory::size_restart(i) + STORED;
}

int FixContactHistory::maxsize_restart()
{
  return FixNeighHistory::maxsize_restart() + STORED;
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fix_contact_wall.h"

#include "atom.h"
#include "contact_energy.h"
#include "error.h"
#include "exchange_size.h"
#include "group.h"
#include "inserted_balls.h"
#include "lammps_compat.h"
#include "pair_gran_restitution.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace Slope;

static constexpr int VERSION = 6;    // of what restart files hold of a wall

/* ---------------------------------------------------------------------- */

FixContactWall::FixContactWall(LAMMPS *lmp, int narg, char **arg, int keys) :
    Fix(lmp, narg, arg), caller(fmt::format("Fix {} {}", style, id)), pair(nullptr), wall_type(0),
    records(keys), contacts_in_lists(false), kept_by_atom(false), emptiness_told(false),
    restart_extra(lmp)
{
  scalar_flag = vector_flag = 1;
  extscalar = extvector = 1;
  global_freq = 1;
  restart_global = restart_peratom = 1;
  create_attribute = 1;
  maxexchange_dynamic = 1;
}

FixContactWall::~FixContactWall()
{
  if (!kept_by_atom) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

/* ---------------------------------------------------------------------- */

void FixContactWall::keep_by_atom()
{
  records.resize(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  kept_by_atom = true;
}

/* ---------------------------------------------------------------------- */

void FixContactWall::init()
{
  restart_extra.check(caller);
  pair = PairGranRestitution::of(lmp);
  if (!pair)
    error->all(FLERR, "{}: requires pair_style gran/restitution, which holds its coefficients",
               caller);
  pair->announce_wall(this, wall_type, other_types, groupbit, style);
  check_group();

  // contacts must be stored by atom before any fix migrates atoms

  for (const Fix *fix : compat::fixes(lmp)) {
    if (fix == this) break;
    if (fix->pre_exchange_migrate)
      error->all(FLERR, "{}: must come before fix {} {}, which moves atoms between ranks", caller,
                 fix->id, fix->style);
  }
  reserve();    // of a restart file's contacts, too
}

/* ----------------------------------------------------------------------
   balls that are there and would fall through
------------------------------------------------------------------------- */

void FixContactWall::check_group()
{
  if (emptiness_told || update->whichflag != 1) return;
  const bigint others = balls_beside_empty(lmp, groupbit, [this](int i) {
    return pair->law(atom->type[i], wall_type) != nullptr;
  });
  if (others == 0) return;
  emptiness_told = true;
  pair->guards.say(fmt::format(
      "{}: the group should have balls, got none of the {} that have coefficients with "
      "type {}: they pass through; group {} has the balls that were there when it was defined",
      caller, others, wall_type, group->names[igroup]));
}

/* ---------------------------------------------------------------------- */

void FixContactWall::pre_exchange()
{
  store_contacts();
  reserve();
}

void FixContactWall::reserve()
{
  maxexchange = exchange_size(lmp, records.largest(atom->nlocal));
}

/* ---------------------------------------------------------------------- */

const ContactLaw &FixContactWall::law_of(int type, int wall) const
{
  const ContactLaw *law = pair->law(type, wall);
  if (!law)    // a type that came after init(), by fix pour or fix deposit
    error->one(FLERR, "{}: pair_coeff {} {} is not set (moving type {}, wall type {})", caller,
               std::min(type, wall), std::max(type, wall), type, wall);
  return *law;
}

/* ----------------------------------------------------------------------
   contacts from the lists to storage by atom: before atoms migrate or are sorted, before a
   restart file, at the end of a run
------------------------------------------------------------------------- */

void FixContactWall::store_contacts()
{
  if (!contacts_in_lists) return;
  contacts_in_lists = false;
  records.clear();
  std::vector<int> left(atom->nlocal, 0);    // of a ball, in all lists; may be in several
  for (const ContactList &l : lists)
    for (size_t k = 0; k < l.entries.size(); k++)    // balls may have been deleted
      if (l.entries[k].i < atom->nlocal) left[l.entries[k].i] += l.has_history(k);
  for (int i = 0; i < atom->nlocal; i++)
    if (left[i] > 0) records.make(i, left[i]);
  for (const ContactList &l : lists)
    for (size_t k = 0; k < l.entries.size(); k++) {
      const int i = l.entries[k].i;
      if (i >= atom->nlocal || !l.has_history(k)) continue;
      const int n = records.contacts(i) - left[i]--;
      key_of(l.entries[k].j, records.key(i, n));
      std::copy_n(l.histories[k], HISTORY, records.history(i, n));
    }
}

/* ---------------------------------------------------------------------- */

void FixContactWall::find_touching(bool repeat, const std::string &remedy)
{
  const MovingBalls moving = pair->moving_balls();
  const FixedPartners fixed = partners();
  InitialOverlap initial(lmp, pair->guards);
  for (ContactList &l : lists) {
    if (repeat)
      l.adopt_overlaps(moving, fixed, [&](const ContactEntry &e, double overlap) {
        const Depth depth = depth_of(e, overlap);
        initial.record(depth.overlap, depth.radius, atom->tag[e.i], atom->x[e.i], name_of(e.j));
      });
    l.find(repeat, moving, fixed);
  }
  if (repeat) initial.check(caller, remedy);
}

double FixContactWall::energy_beside(const FixedPartners &fixed) const
{
  const MovingBalls moving = pair->moving_balls();
  double energy = 0.0;
  for (size_t k = 0; k < lists.size(); k++)
    if (!lists[k].entries.empty())
      energy +=
          Slope::elastic_energy(lists[k], law_of_list(k), update->dt, moving, fixed,
                                [this](const ContactEntry &e, double overlap) {
                                  const Depth depth = depth_of(e, overlap);
                                  pair->guards.record_overlap(e.i, depth.overlap, depth.radius);
                                });
  return energy;
}

double FixContactWall::memory_usage()
{
  double bytes = records.memory_usage();
  for (const ContactList &l : lists) bytes += l.memory_usage();
  return bytes;
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

void FixContactWall::grow_arrays(int nmax)
{
  records.resize(nmax);
}

void FixContactWall::copy_arrays(int i, int j, int /*delflag*/)
{
  // a fix before this one deletes atoms before they migrate: the lists still hold the old indices

  store_contacts();
  records.copy(i, j);
}

void FixContactWall::set_arrays(int i)
{
  records.make(i, 0);
}

int FixContactWall::pack_exchange(int i, double *buf)
{
  return records.pack(i, buf);
}

int FixContactWall::unpack_exchange(int i, double *buf)
{
  return records.unpack(i, buf);
}

/* ----------------------------------------------------------------------
   restart file: what identifies the wall, and the contacts of each atom
------------------------------------------------------------------------- */

void FixContactWall::write_restart(FILE *fp)
{
  const bool in_use = contacts_in_lists;
  store_contacts();
  contacts_in_lists = in_use;    // the run continues with the lists
  Archive archive(style, VERSION);
  restart_members(archive);
  write_archive(lmp, fp, caller, archive);
}

void FixContactWall::restart(char *buf)
{
  read_archive(lmp, caller, [&]() {
    Archive archive(style, VERSION, buf);
    restart_members(archive);
  });
}

void FixContactWall::restart_members(Archive &archive)
{
  archive.same("numbers_of_a_contact", records.packed(1) - records.packed(0));
  archive_wall(archive);
}

int FixContactWall::pack_restart(int i, double *buf)
{
  const int m = 1 + records.pack(i, &buf[1]);
  buf[0] = m;
  return m;
}

void FixContactWall::unpack_restart(int i, int nth)
{
  const int none = records.packed(0);
  const double *list = restart_extra.record_of_ball(i, nth, 1 + none, records.packed(1) - none);
  if (list) maxexchange = std::max(maxexchange, records.unpack(i, list + 1));
}

int FixContactWall::size_restart(int i)
{
  return 1 + records.packed(records.contacts(i));
}

int FixContactWall::maxsize_restart()
{
  // over all ranks: rank 0 writes it, and read_restart sizes its buffer by it

  int mine = 1 + records.largest(atom->nlocal), most;
  MPI_Allreduce(&mine, &most, 1, MPI_INT, MPI_MAX, world);
  return most;
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fix_contact_wall.h"

#include "atom.h"
#include "error.h"
#include "exchange_size.h"
#include "group.h"
#include "inserted_balls.h"
#include "lammps_compat.h"
#include "pair_gran_restitution.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

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

const Slope::ContactLaw &FixContactWall::law_of(int type, int wall) const
{
  const Slope::ContactLaw *law = pair->law(type, wall);
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
  take_contacts();
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
  Slope::Archive archive(style, VERSION);
  restart_members(archive);
  write_archive(lmp, fp, caller, archive);
}

void FixContactWall::restart(char *buf)
{
  read_archive(lmp, caller, [&]() {
    Slope::Archive archive(style, VERSION, buf);
    restart_members(archive);
  });
}

void FixContactWall::restart_members(Slope::Archive &archive)
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

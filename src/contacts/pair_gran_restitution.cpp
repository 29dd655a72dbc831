/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "pair_gran_restitution.h"

#include "atom.h"
#include "comm.h"
#include "contact_energy.h"
#include "contact_holder.h"
#include "error.h"
#include "fix_contact_history.h"
#include "fix_dummy.h"
#include "force.h"
#include "lammps_compat.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "rank_zero.h"
#include "requirements.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace LAMMPS_NS;
using namespace Slope;

static const std::string CALLER = "Pair gran/restitution";
static const std::string SETTINGS = "pair_style", COEFFS = "pair_coeff";    // in restart files
static constexpr int ROOM_IN_RESTART = 65536;    // numbers of a ball: of 8,000 contacts

/* ---------------------------------------------------------------------- */

PairGranRestitution::PairGranRestitution(LAMMPS *lmp) :
    Pair(lmp), guards(lmp, table), table(lmp), lists(lmp, table), states(lmp), freeze_group_bit(0),
    fix_history(nullptr), restart_drops(lmp)
{
  single_enable = 1;
  no_virial_fdotr_compute = 1;
  centroidstressflag = CENTROID_NOTAVAIL;
  finitecutflag = 1;
  nondefault_history_transfer = 1;    // the age is the same from both sides
  comm_forward = BallStates::FORWARD;
  comm_reverse = BallStates::REVERSE;
  single_extra = 10;
  svector = new double[single_extra];

  int kernel = 0, of_all;
  on_all_ranks(lmp, "Pair gran/restitution", [&]() {
    kernel = ContactKernels::choose(getenv(ContactKernels::ENVIRONMENT));
  });
  MPI_Allreduce(&kernel, &of_all, 1, MPI_INT, MPI_MIN, world);
  ContactKernels::set_current(of_all);

  // a placeholder holds the history's place in the order of the fixes
  // numbered by the lowest free number, not by instance_me, which clear does not reset:
  // a restart file hands the history back to a fix of the same ID

  for (int n = 0;
       history_id.empty() || compat::fix_by_id(lmp, history_id) || compat::fix_by_id(lmp, dummy_id);
       n++) {
    history_id = fmt::format("NEIGH_HISTORY_SLOPE{}", n);
    dummy_id = fmt::format("NEIGH_HISTORY_SLOPE_DUMMY{}", n);
  }
  Fix *const dummy = modify->add_fix(dummy_id + " all DUMMY");

  // a restart file in parts (with % in its name): balls move between ranks with what they have there, as
  // numbers of a fix of LAMMPS that reserves no room for them, see exchange_size()

  dummy->maxexchange = ROOM_IN_RESTART;
}

/* ---------------------------------------------------------------------- */

PairGranRestitution::~PairGranRestitution()
{
  if (copymode) return;
  delete[] svector;
  for (const std::string &fix_id : {history_id, dummy_id}) compat::drop_fix(lmp, fix_id);
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

/* ----------------------------------------------------------------------
   allocate what depends on the number of types
------------------------------------------------------------------------- */

void PairGranRestitution::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");

  // LAMMPS wants every I,I to be set, but a wall type meets only the moving types:
  // coeffs[].set is what counts, and init_one() asks for the pairs that can touch

  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) setflag[i][j] = (i == j);
  table.allocate();
}

/* ----------------------------------------------------------------------
   pair_style gran/restitution keyword value ...
------------------------------------------------------------------------- */

void PairGranRestitution::settings(int narg, char **arg)
{
  ContactSettings settings;
  settings.read(lmp, narg, arg);
  table.set(settings);
}

/* ----------------------------------------------------------------------
   pair_coeff I J keyword values ...
------------------------------------------------------------------------- */

void PairGranRestitution::coeff(int narg, char **arg)
{
  if (narg < 2) error->all(FLERR, "Pair gran/restitution pair_coeff needs two atom types");
  if (!allocated) allocate();

  int ilo, ihi, jlo, jhi;
  auto types = [&](const char *text, int &lo, int &hi) {
    utils::bounds(FLERR, text, 1, atom->ntypes, lo, hi, nullptr);
    if (!(lo >= 1 && lo <= hi && hi <= atom->ntypes))
      error->all(
          FLERR,
          "Pair gran/restitution pair_coeff {} {}: types must be 1 to {}, or a range of them with "
          "*, got {}",
          arg[0], arg[1], atom->ntypes, text);
  };
  types(arg[0], ilo, ihi);
  types(arg[1], jlo, jhi);

  ContactCoeffs c;
  c.read(lmp, fmt::format("{} {}", arg[0], arg[1]), narg - 2, arg + 2);

  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++) {
      table.set(i, j, c);
      setflag[i][j] = 1;
      count++;
    }
  if (count == 0)
    error->all(FLERR, "Pair gran/restitution pair_coeff {} {}: no pair I <= J of {} types", arg[0],
               arg[1], atom->ntypes);
}

/* ---------------------------------------------------------------------- */

const ContactLaw *PairGranRestitution::law(int itype, int jtype) const
{
  return allocated && table.is_set(itype, jtype) ? &table.law(itype, jtype) : nullptr;
}

/* ----------------------------------------------------------------------
   init specific to this pair style
------------------------------------------------------------------------- */

void PairGranRestitution::init_style()
{
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    error->all(FLERR, "Pair gran/restitution requires balls: atom_style must be sphere, got {}",
               atom->atom_style);
  if (!comm->ghost_velocity)
    error->all(FLERR, "Pair gran/restitution requires ghost velocities: comm_modify vel yes");
  if (comm->style == 1 &&
      force->newton_pair)    // CommTiled cannot send the histories of ghosts back
    error->all(FLERR, "Pair gran/restitution with comm_style tiled requires newton off");
  if (!compute_flag)
    error->all(FLERR,
               "Pair gran/restitution pair_modify compute must be yes, got no: balls would fall "
               "through each other and the ground");
  if (utils::strmatch(force->pair_style, "^hybrid/scaled"))
    error->all(FLERR,
               "Pair gran/restitution pair_style must be hybrid or hybrid/overlay with others, got "
               "{}, which scales the forces between balls but not those of walls",
               force->pair_style);
  const auto parts = compat::parts_of_hybrid(lmp);
  const auto ours = std::count_if(parts.begin(), parts.end(), [](const std::string &part) {
    return is_style(part, "gran/restitution");
  });
  if (ours > 1)
    error->all(FLERR,
               "Pair gran/restitution: needs one pair_style gran/restitution, got {} in pair_style "
               "{}: contacts of both would not know of each other; types differ by pair_coeff",
               ours, force->pair_style);
  require_run(lmp, "Pair gran/restitution");
  require_plain_units(lmp, "Pair gran/restitution");
  require_single_balls(lmp, "Pair gran/restitution");
  require_spheres(lmp, "Pair gran/restitution");
  require_whole_contacts(lmp, "Pair gran/restitution");

  compat::request_history_list(neighbor, this, instance_me);

  const std::string &kept_by = fix_history ? history_id : dummy_id;
  if (!compat::fix_by_id(lmp, kept_by))
    error->all(
        FLERR,
        "Pair gran/restitution: fix {} must not be removed, as it keeps the contacts: define "
        "the pair style again, after pair_style none",
        kept_by);
  if (!fix_history) {
    fix_history = static_cast<FixContactHistory *>(modify->replace_fix(
        dummy_id, fmt::format("{} all CONTACT_HISTORY {}", history_id, HISTORY), 1));
    fix_history->pair = this;
    fix_history->guards = &guards;
    fix_history->lists = &lists;
    fix_history->watch_energy = [this]() {
      watch_energy();
    };
  }
  restart_drops.check();

  freeze_group_bit = 0;
  for (const Fix *fix : compat::fixes_of_style(lmp, "freeze")) freeze_group_bit |= fix->groupbit;
  require_spins(lmp, "Pair gran/restitution", freeze_group_bit);

  sizes_vary = !compat::fixes_of_style(lmp, "adapt").empty() ||
      !compat::fixes_of_style(lmp, "set").empty();
  guards.growth.begin(sizes_vary);
  works.wanted = !compat::fixes_of_style(lmp, "energy/ledger").empty();

  table.find_ranges(freeze_group_bit);
  require_wide_box(lmp, "Pair gran/restitution", table.largest_cutoff());
  table.forget_walls();    // wall fixes announce themselves after
  walls.clear();
}

/* ----------------------------------------------------------------------
   init for one type pair i,j and corresponding j,i
------------------------------------------------------------------------- */

double PairGranRestitution::init_one(int i, int j)
{
  if (table.balls_can_touch(i, j) && !table.is_set(i, j))
    error->all(FLERR,
               "Pair gran/restitution: pair_coeff {} {} is not set, and balls of both types "
               "exist",
               i, j);
  return table.cutoff(i, j);
}

/* ---------------------------------------------------------------------- */

PairGranRestitution *PairGranRestitution::of(LAMMPS *lmp)
{
  return dynamic_cast<PairGranRestitution *>(lmp->force->pair_match("gran/restitution", 1));
}

Continuation *PairGranRestitution::continuation() const
{
  return fix_history ? &fix_history->continuation : nullptr;
}

/* ---------------------------------------------------------------------- */

void PairGranRestitution::announce_wall(ContactHolder *wall, int type,
                                        const std::vector<int> &other_types, int groupbit,
                                        const char *style)
{
  walls.push_back(wall);
  table.add_wall(type, groupbit, style);
  for (int other : other_types) table.add_wall(other, groupbit, style);
}

/* ----------------------------------------------------------------------
   once per run, when masses, coefficients and step are final
------------------------------------------------------------------------- */

void PairGranRestitution::setup()
{
  guards.start(freeze_group_bit);
}

/* ----------------------------------------------------------------------
   the energy must not grow
------------------------------------------------------------------------- */

void PairGranRestitution::watch_energy()
{
  if (!guards.in_run()) return;
  const MovingBalls balls = states.balls();
  double elastic = lists.elastic_energy(balls, states.partners(balls), guards);
  for (const ContactHolder *wall : walls) elastic += wall->elastic_energy();
  guards.watch_energy(elastic);
  if (!sizes_vary && !guards.energy.balls_came()) return;
  table.find_ranges(freeze_group_bit);
  guards.check_balls();
  double beyond = 0.0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (table.balls_can_touch(i, j))
        beyond = std::max(beyond, table.cutoff(i, j) - sqrt(cutsq[i][j]));
  guards.check_growth(beyond);
  for (ContactHolder *wall : walls) wall->check_sizes();
}

/* ----------------------------------------------------------------------
   numbers of contacts of balls that several ranks know
------------------------------------------------------------------------- */

int PairGranRestitution::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  return states.pack_forward(n, list, buf);
}

void PairGranRestitution::unpack_forward_comm(int n, int begin, double *buf)
{
  states.unpack_forward(n, begin, buf);
}

int PairGranRestitution::pack_reverse_comm(int n, int begin, double *buf)
{
  return states.pack_reverse(n, begin, buf);
}

void PairGranRestitution::unpack_reverse_comm(int n, int *list, double *buf)
{
  states.unpack_reverse(n, list, buf);
}

/* ----------------------------------------------------------------------
   history of a contact as its partner sees it
------------------------------------------------------------------------- */

void PairGranRestitution::transfer_history(double *source, double *target)
{
  for (int k = 0; k < HISTORY; k++) target[k] = -source[k];
  target[AGE] = source[AGE];
}

void PairGranRestitution::transfer_history(double *source, double *target, int, int)
{
  transfer_history(source, target);
}

/* ---------------------------------------------------------------------- */

void PairGranRestitution::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  const bool repeat = update->setupflag;    // the forces of the last step are found once more
  if (fix_history->take_new_lists() || repeat)
    lists.build(*list, *fix_history, freeze_group_bit, sizes_vary, guards);

  if (!repeat) {
    guards.energy.in_step();
    fix_history->continuation.note_half_step();
  }

  // what touches, here and at the walls, and the number of contacts of each ball

  states.begin_step(fix_history->continuation, repeat, table.is_exact(), freeze_group_bit != 0);
  const MovingBalls balls = states.balls();
  const MovingPartners partners = states.partners(balls);
  lists.find(repeat, balls, partners, guards);
  for (ContactHolder *wall : walls) wall->find_contacts(repeat);
  states.share_counts(this);

  const int nlocal = atom->nlocal, newton_pair = force->newton_pair;
  const ContactLaw *law = nullptr;
  auto visit = [&](int i, int j, const Vector &f, const Vector &d) {
    if (evflag) ev_tally_xyz(i, j, nlocal, newton_pair, 0.0, 0.0, f.x, f.y, f.z, d.x, d.y, d.z);
    if (works.wanted)
      works.add(i, j, atom->radius[i], atom->radius[j], *law, partners.share(j), f, d);
  };
  works.clear();
  ContactTally tally = tally_of(visit);
  const bool visited = evflag || works.wanted;
  lists.for_each([&](ContactList &l, const ContactLaw &its) {
    law = &its;
    l.apply(its, update->dt, repeat, balls, partners, visited ? &tally : nullptr);
  });
  fix_history->note_used();
}

/* ----------------------------------------------------------------------
   the force of one pair, for computes; changes no history
   svector: tangential force (3), its size, normal velocity (3), tangential velocity (3)
------------------------------------------------------------------------- */

double PairGranRestitution::single(int i, int j, int itype, int jtype, double rsq,
                                   double /*factor_coul*/, double /*factor_lj*/, double &fforce)
{
  fforce = 0.0;
  std::fill(svector, svector + single_extra, 0.0);
  const double radsum = atom->radius[i] + atom->radius[j];
  if (rsq >= radsum * radsum) return 0.0;
  if ((atom->mask[i] & freeze_group_bit) && (atom->mask[j] & freeze_group_bit)) return 0.0;

  double history[HISTORY] = {0.0};
  const int *jlist = list->firstneigh[i];
  for (int jj = 0; jj < list->numneigh[i]; jj++)
    if ((jlist[jj] & NEIGHMASK) == j)
      memcpy(history, &fix_history->firstvalue[i][HISTORY * jj], sizeof(history));

  // as the law has it: velocities and overlap of the same time; sliding and rolling springs as they act

  const ContactLaw &acts = table.law(itype, jtype);
  ContactLaw law = acts;
  law.exact = 0.0;
  MovingBalls balls = states.balls();
  balls.v = balls.ahead = vectors(atom->v);
  balls.omega = vectors(atom->omega);
  const Sides moves = {(atom->mask[i] & freeze_group_bit) ? 0.0 : 1.0,
                       (atom->mask[j] & freeze_group_bit) ? 0.0 : 1.0};
  Contact contact;
  Vector delta;
  const MovingPartners partners = {balls, INT_MAX};
  set_contact(law, balls, partners, i, j, contact, delta);
  auto step_with = [&](const ContactLaw &l) {
    return step_of(moves, l, update->dt, true, atom->radius[i], atom->radius[j], atom->rmass[i],
                   atom->rmass[j]);
  };
  ContactStep step = step_with(law);
  const ContactStep acting = step_with(acts);
  step.kt = acting.kt;
  step.kr = acting.kr;
  ContactForce c;
  contact_force(step, contact, 1.0, history, c);

  const double *n = contact.n;
  const double fn = c.f[0] * n[0] + c.f[1] * n[1] + c.f[2] * n[2];
  const double vn = contact.v[0] * n[0] + contact.v[1] * n[1] + contact.v[2] * n[2];
  fforce = fn / sqrt(rsq);
  for (int k = 0; k < 3; k++) {
    svector[k] = c.f[k] - fn * n[k];
    svector[4 + k] = vn * n[k];
    svector[7 + k] = contact.v[k] - vn * n[k];
  }
  svector[3] = sqrt(svector[0] * svector[0] + svector[1] * svector[1] + svector[2] * svector[2]);
  return 0.0;
}

/* ----------------------------------------------------------------------
   settings and coefficients in the restart file
------------------------------------------------------------------------- */

void PairGranRestitution::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  Archive to(COEFFS, ContactCoeffs::VERSION);
  table.archive_coeffs(to);
  fwrite(to.bytes().data(), 1, to.bytes().size(), fp);
}

void PairGranRestitution::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  const std::string bytes = archive_bytes(lmp, fp, CALLER);
  read_archive(lmp, CALLER, [&]() {
    Archive from(COEFFS, ContactCoeffs::VERSION, bytes.data());
    table.archive_coeffs(from);
  });
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (table.is_set(i, j)) setflag[i][j] = 1;
}

void PairGranRestitution::write_restart_settings(FILE *fp)
{
  Archive to(SETTINGS, ContactCoeffs::VERSION);
  table.archive_settings(to);
  fwrite(to.bytes().data(), 1, to.bytes().size(), fp);
}

void PairGranRestitution::read_restart_settings(FILE *fp)
{
  const std::string bytes = archive_bytes(lmp, fp, CALLER);
  read_archive(lmp, CALLER, [&]() {
    Archive from(SETTINGS, ContactCoeffs::VERSION, bytes.data());
    table.archive_settings(from);
  });
}

/* ---------------------------------------------------------------------- */

double PairGranRestitution::memory_usage()
{
  return table.memory_usage() + lists.memory_usage() + states.memory_usage();
}

/* ---------------------------------------------------------------------- */

double PairGranRestitution::atom2cut(int i)
{
  return 2.0 * atom->radius[i];
}

double PairGranRestitution::radii2cut(double r1, double r2)
{
  return r1 + r2;
}

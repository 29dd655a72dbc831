/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "pair_gran_restitution.h"

#include "atom.h"
#include "atom_vec.h"
#include "comm.h"
#include "contact_holder.h"
#include "error.h"
#include "fix_contact_history.h"
#include "fix_dummy.h"
#include "force.h"
#include "initial_overlap.h"
#include "lammps_compat.h"
#include "memory.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace LAMMPS_NS;
using namespace Slope;

static constexpr double STEP_RULE = 0.25;     // dt <= STEP_RULE sqrt(m/kn)
static constexpr double DASHPOT_RULE = 0.15;    // scheme plain: dt <= DASHPOT_RULE m/cn
static constexpr int FORMAT = 20261122;    // of what restart files hold, histories of walls included
static constexpr double ZETA_FOLLOWED = 2.0;    // damping ratio up to which the law is followed
static constexpr double MASS_RATIO_TESTED = 1000.0;    // of two balls that touch
static constexpr double DEEP = 0.1;             // overlap, of the smaller radius, that is not sensible
static constexpr double DEGREE = PI / 180.0;

// LAMMPS keeps the rows of these arrays one after the other

static inline Vector *vectors(double **array)
{
  return reinterpret_cast<Vector *>(array ? array[0] : nullptr);
}

/* ---------------------------------------------------------------------- */

PairGranRestitution::PairGranRestitution(LAMMPS *lmp) : Pair(lmp), energy(lmp)
{
  single_enable = 1;
  no_virial_fdotr_compute = 1;
  centroidstressflag = CENTROID_NOTAVAIL;
  finitecutflag = 1;
  nondefault_history_transfer = 1;    // the phase is the same from both sides
  beyond_contact = 1;                 // a contact that has ended keeps its history for a step
  comm_forward = comm_reverse = 2;    // numbers of contacts
  single_extra = 10;
  svector = new double[single_extra];

  mass_ball = 0;
  limit_damping = 0;
  rolling_reduced = 0;
  plain = 0;
  freeze_group_bit = 0;
  shared = COUNTS;
  overlaps = {0.0, 0, 0, 0};
  dt = update->dt;

  // a placeholder holds the history's place in the order of the fixes
  // numbered by the lowest free number, not by instance_me, which clear does not reset:
  // a restart file hands the history back to a fix of the same ID

  fix_history = nullptr;
  for (int n = 0; history_id.empty() || modify->find_fix(history_id) >= 0 ||
       modify->find_fix(dummy_id) >= 0; n++) {
    history_id = fmt::format("NEIGH_HISTORY_SLOPE{}", n);
    dummy_id = fmt::format("NEIGH_HISTORY_SLOPE_DUMMY{}", n);
  }
  modify->add_fix(dummy_id + " all DUMMY");
}

/* ---------------------------------------------------------------------- */

PairGranRestitution::~PairGranRestitution()
{
  if (copymode) return;
  delete[] svector;
  for (const std::string &fix_id : {history_id, dummy_id})
    if (modify->find_fix(fix_id) >= 0) modify->delete_fix(fix_id);
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

  Coeff none;
  memset(&none, 0, sizeof(Coeff));
  coeffs.assign(n * n, none);
  laws.assign(n * n, ContactLaw());
  wall_type.assign(n, 0);
}

/* ---------------------------------------------------------------------- */

int PairGranRestitution::index(int i, int j) const
{
  return i * (atom->ntypes + 1) + j;
}

/* ----------------------------------------------------------------------
   pair_style gran/restitution keyword value ...
------------------------------------------------------------------------- */

void PairGranRestitution::settings(int narg, char **arg)
{
  mass_ball = limit_damping = rolling_reduced = plain = 0;

  int iarg = 0;
  while (iarg < narg) {
    const std::string keyword = arg[iarg];
    if (iarg + 2 > narg)
      error->all(FLERR, "Pair gran/restitution {}: value missing or unknown keyword", keyword);
    const std::string value = arg[iarg + 1];
    int *setting;
    const char *off, *on;
    if (keyword == "mass") {
      setting = &mass_ball;
      off = "pair";
      on = "ball";
    } else if (keyword == "limit_damping") {
      setting = &limit_damping;
      off = "no";
      on = "yes";
    } else if (keyword == "rolling_radius") {
      setting = &rolling_reduced;
      off = "ball";
      on = "reduced";
    } else if (keyword == "scheme") {
      setting = &plain;
      off = "exact";
      on = "plain";
    } else {
      error->all(FLERR,
                 "Pair gran/restitution: unknown keyword {}, must be mass, limit_damping, "
                 "rolling_radius or scheme",
                 keyword);
      return;
    }
    if (value != off && value != on)
      error->all(FLERR, "Pair gran/restitution {} must be {} or {}, got {}", keyword, off, on,
                 value);
    *setting = (value == on);
    iarg += 2;
  }
  if (allocated) make_laws();
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
      error->all(FLERR,
                 "Pair gran/restitution pair_coeff {} {}: types must be 1 to {}, or a range of them with "
                 "*, got {}",
                 arg[0], arg[1], atom->ntypes, text);
  };
  types(arg[0], ilo, ihi);
  types(arg[1], jlo, jhi);

  Coeff c;
  memset(&c, 0, sizeof(Coeff));
  c.set = 1;
  bool stiffness = false, damping = false;

  int iarg = 2;
  while (iarg < narg) {
    const std::string keyword = arg[iarg];
    auto value = [&](int k) {
      if (iarg + k >= narg)
        error->all(FLERR, "Pair gran/restitution {}: value {} is missing", keyword, k);
      if (!utils::is_double(arg[iarg + k]))
        error->all(FLERR, "Pair gran/restitution {}: value {} must be a number, got {}", keyword, k,
                   arg[iarg + k]);
      return strtod(arg[iarg + k], nullptr);    // numeric() has words of its own for 1e999, in some versions
    };
    auto rule = [&](bool holds, const char *text, double got) {
      if (!holds || !std::isfinite(got))
        error->all(FLERR, "Pair gran/restitution {} must be {}, got {:.15g}", keyword, text, got);
    };
    if (keyword == "stiffness") {
      c.kn = value(1);
      c.kt = value(2);
      rule(c.kn > 0.0, "> 0 (kn)", c.kn);
      rule(c.kt >= 0.0, ">= 0 (kt)", c.kt);
      stiffness = true;
      iarg += 3;
    } else if (keyword == "restitution") {
      c.e = value(1);
      rule(c.e > 0.0 && c.e <= 1.0, "> 0 and <= 1", c.e);
      c.restitution_set = 1;
      iarg += 2;
    } else if (keyword == "damping") {
      c.cn = value(1);
      c.ct = value(2);
      rule(c.cn >= 0.0, ">= 0 (cn)", c.cn);
      rule(c.ct >= 0.0, ">= 0 (ct)", c.ct);
      damping = true;
      iarg += 3;
    } else if (keyword == "friction") {
      c.phi = value(1);
      rule(c.phi >= 0.0 && c.phi < 90.0, ">= 0 and < 90 degrees", c.phi);
      iarg += 2;
    } else if (keyword == "rolling") {
      c.rolling = value(1);
      rule(c.rolling >= 0.0, ">= 0", c.rolling);
      iarg += 2;
    } else if (keyword == "rolling_spring") {
      c.kr = value(1);
      c.cr = value(2);
      rule(c.kr >= 0.0, ">= 0 (kr)", c.kr);
      rule(c.cr >= 0.0, ">= 0 (cr)", c.cr);
      c.spring_set = 1;
      iarg += 3;
    } else {
      error->all(FLERR,
                 "Pair gran/restitution pair_coeff: unknown keyword {}, must be stiffness, "
                 "restitution, damping, friction, rolling or rolling_spring",
                 keyword);
    }
  }

  if (!stiffness)
    error->all(FLERR, "Pair gran/restitution pair_coeff {} {}: stiffness kn kt is required",
               arg[0], arg[1]);
  if (c.kt == 0.0 && c.ct > 0.0)
    error->all(FLERR,
               "Pair gran/restitution pair_coeff {} {}: ct must be 0 where kt is 0, got {:.15g}: give the "
               "contact a tangential stiffness",
               arg[0], arg[1], c.ct);
  if (damping == (c.restitution_set == 1))
    error->all(FLERR,
               "Pair gran/restitution pair_coeff {} {}: exactly one of restitution and damping is "
               "required, got {}",
               arg[0], arg[1], damping ? "both" : "neither");

  int count = 0;
  for (int i = ilo; i <= ihi; i++)
    for (int j = std::max(jlo, i); j <= jhi; j++) {
      coeffs[index(i, j)] = coeffs[index(j, i)] = c;
      setflag[i][j] = 1;
      count++;
    }
  if (count == 0)
    error->all(FLERR, "Pair gran/restitution pair_coeff {} {}: no pair I <= J of {} types",
               arg[0], arg[1], atom->ntypes);
  make_laws();
}

/* ----------------------------------------------------------------------
   contact laws from the coefficients: c = 2 zeta sqrt(k m) in both directions
------------------------------------------------------------------------- */

void PairGranRestitution::make_laws()
{
  for (size_t k = 0; k < coeffs.size(); k++) {
    const Coeff &c = coeffs[k];
    if (!c.set) continue;
    ContactLaw law = ContactLaw();
    const double zeta = c.restitution_set ? damping_ratio(c.e) : 0.0;
    law.kn = c.kn;
    law.kt = c.kt;
    law.cn_given = c.cn;
    law.ct_given = c.ct;
    law.cn_root = 2.0 * zeta * sqrt(c.kn);
    law.ct_root = 2.0 * zeta * sqrt(c.kt);
    law.kr = c.spring_set ? c.kr : law.kt;
    law.cr_given = c.spring_set ? c.cr : law.ct_given;
    law.cr_root = c.spring_set ? 0.0 : law.ct_root;
    law.friction = tan(c.phi * DEGREE);
    law.rolling = c.rolling;
    law.mass_factor = mass_ball ? 2.0 : 1.0;
    law.rolling_factor = rolling_reduced ? 1.0 : 2.0;
    law.fn_least = limit_damping ? 0.0 : -HUGE_VAL;
    law.exact = plain ? 0.0 : 1.0;
    laws[k] = law;
  }
}

/* ---------------------------------------------------------------------- */

const ContactLaw *PairGranRestitution::law(int itype, int jtype) const
{
  if (!allocated || !coeffs[index(itype, jtype)].set) return nullptr;
  return &laws[index(itype, jtype)];
}

/* ----------------------------------------------------------------------
   init specific to this pair style
------------------------------------------------------------------------- */

void PairGranRestitution::init_style()
{
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    error->all(FLERR,
               "Pair gran/restitution requires balls: atom_style must be sphere, got {}",
               atom->atom_style);
  if (!comm->ghost_velocity)
    error->all(FLERR, "Pair gran/restitution requires ghost velocities: comm_modify vel yes");
  if (comm->style == 1 && force->newton_pair)    // CommTiled cannot send the histories of ghosts back
    error->all(FLERR, "Pair gran/restitution with comm_style tiled requires newton off");

  compat::request_history_list(neighbor, this, instance_me);
  dt = update->dt;

  if (!fix_history) {
    fix_history = static_cast<FixContactHistory *>(modify->replace_fix(
        dummy_id, fmt::format("{} all CONTACT_HISTORY {}", history_id, HISTORY), 1));
    fix_history->pair = this;
  }

  const auto freezes = compat::fixes_of_style(lmp, "freeze");
  freeze_group_bit = freezes.empty() ? 0 : freezes[0]->groupbit;

  sizes_vary = !compat::fixes_of_style(lmp, "adapt").empty();

  find_ranges();
  std::fill(wall_type.begin(), wall_type.end(), 0);    // wall fixes announce themselves after
  walls.clear();
}

/* ----------------------------------------------------------------------
   masses and radii of the atoms of each type
------------------------------------------------------------------------- */

void PairGranRestitution::find_ranges()
{
  const int n = atom->ntypes + 1;
  enum { MASS_MIN, MASS_MAX, DYNAMIC, FROZEN, NVALUE };
  std::vector<double> mine(n * NVALUE, 0.0), all(n * NVALUE);
  for (int t = 0; t < n; t++) mine[t * NVALUE + MASS_MIN] = -HUGE_VAL;    // as -mass: one MPI_MAX

  for (int i = 0; i < atom->nlocal; i++) {
    double *value = &mine[atom->type[i] * NVALUE];
    const double r = atom->radius[i], m = atom->rmass[i];
    if (atom->mask[i] & freeze_group_bit) {
      value[FROZEN] = std::max(value[FROZEN], r);
    } else {
      value[MASS_MIN] = std::max(value[MASS_MIN], -m);
      value[MASS_MAX] = std::max(value[MASS_MAX], m);
      value[DYNAMIC] = std::max(value[DYNAMIC], r);
    }
  }
  MPI_Allreduce(mine.data(), all.data(), n * NVALUE, MPI_DOUBLE, MPI_MAX, world);

  ranges.assign(n, TypeRange());
  for (int t = 1; t < n; t++) {
    const double *value = &all[t * NVALUE];
    TypeRange &range = ranges[t];
    range.moving = value[MASS_MAX] > 0.0;
    range.frozen = value[FROZEN] > 0.0;
    range.mass_min = -value[MASS_MIN];
    range.mass_max = value[MASS_MAX];
    range.radius_dynamic = value[DYNAMIC];
    range.radius_frozen = value[FROZEN];

    // balls that fix pour or fix deposit will add later count as moving

    for (const char *style : {"pour", "deposit"})
      for (Fix *fix : compat::fixes_of_style(lmp, style)) {
        int itype = t;
        const double *radius = static_cast<double *>(fix->extract("radius", itype));
        if (radius) range.radius_dynamic = std::max(range.radius_dynamic, *radius);
      }
  }
}

/* ----------------------------------------------------------------------
   init for one type pair i,j and corresponding j,i
------------------------------------------------------------------------- */

double PairGranRestitution::init_one(int i, int j)
{
  const TypeRange &a = ranges[i], &b = ranges[j];
  const bool amoves = a.radius_dynamic > 0.0, bmoves = b.radius_dynamic > 0.0;
  const bool can_touch = (amoves && (bmoves || b.frozen)) || (bmoves && (amoves || a.frozen));
  if (can_touch && !coeffs[index(i, j)].set)
    error->all(FLERR, "Pair gran/restitution: pair_coeff {} {} is not set, and balls of both types "
                      "exist", i, j);

  // no contact between two frozen balls

  double cutoff = a.radius_dynamic + b.radius_dynamic;
  cutoff = std::max(cutoff, a.radius_frozen + b.radius_dynamic);
  cutoff = std::max(cutoff, a.radius_dynamic + b.radius_frozen);
  return cutoff;
}

/* ---------------------------------------------------------------------- */

void PairGranRestitution::announce_wall(ContactHolder *wall, int type, int groupbit)
{
  walls.push_back(wall);
  for (int itype = 1; itype <= atom->ntypes; itype++) {
    int mine = 0, any;
    for (int i = 0; i < atom->nlocal && !mine; i++)
      if ((atom->mask[i] & groupbit) && atom->type[i] == itype) mine = 1;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (any && !law(itype, type))
      error->all(FLERR,
                 "Fix wall/gran/balls: pair_coeff {} {} is not set (moving type {}, wall type {})",
                 std::min(itype, type), std::max(itype, type), itype, type);
  }
  if (allocated) wall_type[type] = 1;
}

/* ----------------------------------------------------------------------
   by rank 0, or by all: to the screen, the log and the summaries
------------------------------------------------------------------------- */

template <typename... Args>
void PairGranRestitution::warn(const char *format, const Args &...args)
{
  if (comm->me > 0) return;
  const std::string text = "Pair gran/restitution: " + fmt::format(format, args...);
  error->warning(FLERR, text);
  if (std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(text);
}

/* ----------------------------------------------------------------------
   once per run, when masses, coefficients and step are final
------------------------------------------------------------------------- */

void PairGranRestitution::setup()
{
  dt = update->dt;
  print_table();
  check_timestep();
  check_dashpots();
  check_neighbor_lists();
  check_fixed_balls();
  overlaps = {0.0, 0, 0, 0};
  energy.start();
}

/* ---------------------------------------------------------------------- */

void PairGranRestitution::reset_dt()
{
  dt = update->dt;
}

/* ----------------------------------------------------------------------
   type pairs that can touch: one side moves, the other one does too, is frozen or a wall
------------------------------------------------------------------------- */

bool PairGranRestitution::can_touch(int i, int j) const
{
  const TypeRange &a = ranges[i], &b = ranges[j];
  if (!coeffs[index(i, j)].set) return false;
  return (a.moving && (b.moving || b.frozen || wall_type[j])) ||
      (b.moving && (a.frozen || wall_type[i]));
}

/* ----------------------------------------------------------------------
   largest step for a type pair: that of its lightest moving ball. Scheme exact follows any
   dashpot; the plain one needs small steps, for the dashpots of several contacts add up.
------------------------------------------------------------------------- */

double PairGranRestitution::bound_on_step(int i, int j) const
{
  double m = HUGE_VAL;
  if (ranges[i].moving) m = std::min(m, ranges[i].mass_min);
  if (ranges[j].moving) m = std::min(m, ranges[j].mass_min);
  const double spring = STEP_RULE * sqrt(m / coeffs[index(i, j)].kn);
  const double cn = laws[index(i, j)].cn(m);
  return plain && cn > 0.0 ? std::min(spring, DASHPOT_RULE * m / cn) : spring;
}

/* ----------------------------------------------------------------------
   table of the coefficients, for the lightest balls of each type pair
------------------------------------------------------------------------- */

void PairGranRestitution::print_table()
{
  std::string text =
      "Pair gran/restitution: contact coefficients (lightest balls of each type pair)\n"
      "  types    kn N/m       kt N/m       cn N s/m     zeta     e moving e fixed  friction "
      "rolling  contact/dt\n";
  auto number = [](double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "inf"; };

  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      const Coeff &c = coeffs[index(i, j)];
      const TypeRange &a = ranges[i], &b = ranges[j];
      if (!can_touch(i, j)) continue;
      const ContactLaw &law = laws[index(i, j)];
      const bool both = a.moving && b.moving;

      // a ball on a fixed one: the lighter of the moving types

      const double single = std::min(a.moving ? a.mass_min : HUGE_VAL,
                                     b.moving ? b.mass_min : HUGE_VAL);
      const double zeta_fixed = law.cn(law.mass_fixed(single)) / (2.0 * sqrt(c.kn * single));
      double m = single, cn = law.cn(law.mass_fixed(single)), zeta = zeta_fixed;
      std::string e_moving = "-";
      if (both) {
        m = a.mass_min * b.mass_min / (a.mass_min + b.mass_min);
        cn = law.cn(law.mass(a.mass_min, b.mass_min));
        zeta = cn / (2.0 * sqrt(c.kn * m));
        e_moving = fmt::format("{:.4f}", restitution(zeta));
      }
      text += fmt::format("  {:<3} {:<3}  {:<12.4g} {:<12.4g} {:<12.4g} {:<8.4f} {:<8} {:<8.4f} "
                          "{:<8.4g} {:<8.4g} {}\n",
                          i, j, c.kn, c.kt, cn, zeta, e_moving, restitution(zeta_fixed), c.phi,
                          atan(c.rolling) / DEGREE, number(contact_time(c.kn, m, zeta) / dt));
    }
  text += "  e fixed: against a fixed ball. friction, rolling: angles in degrees.\n";

  if (text != table && comm->me == 0) utils::logmesg(lmp, text);
  table = text;
}

/* ----------------------------------------------------------------------
   warn when the step breaks dt <= 0.25 sqrt(m_min/kn)
------------------------------------------------------------------------- */

void PairGranRestitution::check_timestep()
{
  double bound = HUGE_VAL;
  int iworst = 0, jworst = 0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      if (!can_touch(i, j)) continue;
      const double b = bound_on_step(i, j);
      if (b < bound) {
        bound = b;
        iworst = i;
        jworst = j;
      }
    }
  if (dt <= bound * (1.0 + 1.0e-12) || comm->me > 0) return;
  const bool spring = coeffs[index(iworst, jworst)].kn * bound * bound >=
      0.999 * STEP_RULE * STEP_RULE * std::min(ranges[iworst].mass_min, ranges[jworst].mass_min);
  if (spring || !plain)
    warn("time step {:.4g} s is {:.3g} times the largest that holds the restitution, "
         "0.25 sqrt(m_min/kn) = {:.4g} s (types {} {})",
         dt, dt / bound, bound, iworst, jworst);
  else
    warn("time step {:.4g} s is {:.3g} times the largest with which the dashpots of scheme plain let "
         "a heap come to rest, 0.15 m_min/cn = {:.4g} s (types {} {})",
         dt, dt / bound, bound, iworst, jworst);
}

/* ----------------------------------------------------------------------
   warn of dashpots and mass ratios beyond what the law follows
------------------------------------------------------------------------- */

void PairGranRestitution::check_dashpots()
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      if (!can_touch(i, j)) continue;
      const TypeRange &a = ranges[i], &b = ranges[j];
      double lightest = HUGE_VAL, heaviest = 0.0;
      for (const TypeRange *range : {&a, &b})
        if (range->moving) {
          lightest = std::min(lightest, range->mass_min);
          heaviest = std::max(heaviest, range->mass_max);
        }
      if (heaviest > MASS_RATIO_TESTED * lightest && a.moving && b.moving)
        warn("the masses of balls of types {} and {} that can touch are tested up to a ratio of {:g}, got {:.4g}",
             i, j, MASS_RATIO_TESTED, heaviest / lightest);
      const double cn = laws[index(i, j)].cn(lightest);
      const double zeta = cn / (2.0 * sqrt(coeffs[index(i, j)].kn * lightest));
      if (zeta > ZETA_FOLLOWED && !plain)
        warn("damping ratio of types {} and {} must be <= {:g} to be followed in time, got {:.4g} (cn {:.4g} N s/m, "
             "lightest ball {:.4g} kg): these contacts do not rebound and rest at the right overlap, but reach it "
             "too fast",
             i, j, ZETA_FOLLOWED, zeta, cn, lightest);
    }
}

/* ----------------------------------------------------------------------
   warn when contacts can begin before the neighbor list has them
------------------------------------------------------------------------- */

void PairGranRestitution::check_neighbor_lists()
{
  if (neighbor->delay == 0 && neighbor->every == 1 && neighbor->dist_check) return;
  warn("with neigh_modify every {} delay {} check {} contacts may be found late and rebound too fast; "
       "every 1 delay 0 check yes finds them in time",
       neighbor->every, neighbor->delay, neighbor->dist_check ? "yes" : "no");
}

/* ----------------------------------------------------------------------
   warn of balls that nothing moves but that are not frozen: the law would take them for moving
------------------------------------------------------------------------- */

void PairGranRestitution::check_fixed_balls()
{
  int moved = 0;    // group bits
  for (int k = 0; k < modify->nfix; k++)
    if (modify->fix[k]->time_integrate) moved |= modify->fix[k]->groupbit;
  if (!moved) return;

  bigint mine = 0, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (!(atom->mask[i] & (moved | freeze_group_bit))) mine++;
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all)
    warn("no integrator moves {} balls and no fix freeze holds them: without it a fixed ball has the "
         "dashpots of a moving one",
         all);
}

/* ---------------------------------------------------------------------- */

void PairGranRestitution::see_overlap(int i, double overlap, double radius)
{
  const double share = overlap / radius;
  if (share > DEEP) overlaps.count++;
  if (share > overlaps.most) overlaps = {share, atom->tag[i], update->ntimestep, overlaps.count};
}

/* ----------------------------------------------------------------------
   the energy must not grow
------------------------------------------------------------------------- */

void PairGranRestitution::watch_energy()
{
  const MovingBalls balls = moving_balls();
  const MovingPartners partners = {balls, force->newton_pair ? INT_MAX : atom->nlocal};
  double elastic = 0.0;
  for (size_t k = 0; k < lists.size(); k++)
    elastic += lists[k].elastic_energy(
        laws[k / 3], balls, partners, [this](const ContactList::Entry &e, double overlap) {
          see_overlap(e.i, overlap, std::min(atom->radius[e.i], atom->radius[e.j]));
        });
  for (const ContactHolder *wall : walls) elastic += wall->elastic_energy();
  if (energy.look(elastic))
    warn("the energy of the balls grew by {:.3g} % of the largest energy of motion until step {}, with "
         "nothing but contacts and gravity at work: the time step is too large, or contacts were found "
         "late",
         100.0 * energy.growth(), update->ntimestep);
}

/* ---------------------------------------------------------------------- */

PairGranRestitution::Guards PairGranRestitution::guards() const
{
  Guards found;
  MPI_Allreduce(&overlaps.most, &found.deepest, 1, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(&overlaps.count, &found.deep, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  found.energy_growth = energy.growth();
  found.energy_grew = energy.seen();
  found.dangerous_builds = neighbor->ndanger;
  return found;
}

/* ----------------------------------------------------------------------
   warn, once per run and with a count, of what was not sensible
------------------------------------------------------------------------- */

void PairGranRestitution::report_guards()
{
  const Guards found = guards();
  if (found.deep) {
    struct {
      double most;
      int rank;
    } mine = {overlaps.most, comm->me}, all;
    MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
    bigint where[2] = {overlaps.ball, overlaps.step};
    MPI_Bcast(where, 2, MPI_LMP_BIGINT, all.rank, world);
    warn("{} contacts were seen deeper than {:g} % of the smaller radius, the deepest {:.3g} % (ball {}, "
         "step {}): the stiffness is too small for the speeds, or the time step too large",
         found.deep, 100.0 * DEEP, 100.0 * all.most, where[0], where[1]);
  }
  if (found.energy_grew > 1)
    warn("the energy of the balls had grown at {} of the looks every {} steps, by {:.3g} % of the largest "
         "energy of motion",
         found.energy_grew, fix_history->nevery, 100.0 * found.energy_growth);
  if (found.dangerous_builds)
    warn("{} neighbor lists came late (dangerous builds): balls went farther than half the skin {:g} in "
         "one step, and contacts may have begun too deep",
         found.dangerous_builds, neighbor->skin);
}

/* ----------------------------------------------------------------------
   lists of what may touch, by law, from a new neighbor list
------------------------------------------------------------------------- */

void PairGranRestitution::build_lists()
{
  // contacts are read 32 bytes at a time, 8 beyond a vector: there must be something beyond the last

  if (atom->nlocal + atom->nghost >= atom->nmax) atom->avec->grow(0);

  const int n = atom->ntypes + 1;
  lists.resize(3 * n * n);
  for (size_t k = 0; k < lists.size(); k++) lists[k].clear(k % 3 != 1, k % 3 != 2);

  const Vector *const x = vectors(atom->x);
  const double *const radius = atom->radius;
  const double *const rmass = atom->rmass;
  const int *const mask = atom->mask;
  const int *const type = atom->type;
  for (int ii = 0; ii < list->inum; ii++) {
    const int i = list->ilist[ii];
    const bool frozen_i = mask[i] & freeze_group_bit;
    const int *const jlist = list->firstneigh[i];
    int *const flags = fix_history->firstflag[i];
    double *const values = fix_history->firstvalue[i];

    for (int jj = 0; jj < list->numneigh[i]; jj++) {
      const int j = jlist[jj] & NEIGHMASK;
      const bool frozen_j = mask[j] & freeze_group_bit;
      if (frozen_i && frozen_j) continue;
      ContactList &l = lists[3 * (type[i] * n + type[j]) + (frozen_i ? 1 : frozen_j ? 2 : 0)];
      l.add(i, j, &values[HISTORY * jj], flags[jj], radius[i], radius[j], rmass[i], rmass[j]);
      l.flags.push_back(&flags[jj]);

      if (!flags[jj]) continue;
      const Vector a = x[i], b = x[j];
      const double r = sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                            (a.z - b.z) * (a.z - b.z));
      see_overlap(i, radius[i] + radius[j] - r, std::min(radius[i], radius[j]));
    }
  }
  if (sizes_vary)
    for (ContactList &l : lists) l.equal = false;
  fix_history->lists_new = false;
}

/* ----------------------------------------------------------------------
   which contacts touch, to the history that is to be stored
------------------------------------------------------------------------- */

void PairGranRestitution::store_flags() const
{
  for (const ContactList &l : lists) l.store_flags();
}

/* ----------------------------------------------------------------------
   At set-up velocities are those of the end of a step, while a step's forces are made with
   those of its middle. A run that goes on, from a restart file too, gets these back: then its
   first forces are the ones that the last step had.
------------------------------------------------------------------------- */

void PairGranRestitution::find_half_step()
{
  half_v.clear();
  half_omega.clear();
  if (!fix_history->forces_known()) return;

  const int nlocal = atom->nlocal, nall = nlocal + atom->nghost;
  Vector *const v = vectors(atom->v), *const omega = vectors(atom->omega);
  half_v.reserve(nall + 1);    // see build_lists()
  half_omega.reserve(nall + 1);
  half_v.assign(v, v + nall);
  half_omega.assign(omega, omega + nall);
  for (int i = 0; i < nlocal; i++) {
    const double *f = fix_history->force[i];    // velocity Verlet's second half step, for solid balls
    const double a = 0.5 * dt / atom->rmass[i];
    const double b = a / (0.4 * atom->radius[i] * atom->radius[i]);
    v[i] = {v[i].x - a * f[0], v[i].y - a * f[1], v[i].z - a * f[2]};
    omega[i] = {omega[i].x - b * f[3], omega[i].y - b * f[4], omega[i].z - b * f[5]};
  }
  comm->forward_comm();    // to the ghosts
  std::swap_ranges(v, v + nall, half_v.begin());
  std::swap_ranges(omega, omega + nall, half_omega.begin());
}

/* ---------------------------------------------------------------------- */

MovingBalls PairGranRestitution::moving_balls()
{
  const bool half = !half_v.empty();
  return {vectors(atom->x),
          half ? half_v.data() : vectors(atom->v),
          half ? half_omega.data() : vectors(atom->omega),
          atom->radius,
          atom->rmass,
          vectors(atom->f),
          vectors(atom->torque),
          counts.data(),
          counts_before.data(),
          estimated.data()};
}

/* ----------------------------------------------------------------------
   what touches, here and at the walls, and the number of contacts of each ball
------------------------------------------------------------------------- */

void PairGranRestitution::find_contacts(bool lists_new)
{
  const int nall = atom->nlocal + atom->nghost;
  if (lists_new) counts_before.assign(nall, 0);
  else counts_before.swap(counts);
  counts.assign(nall, 0);
  if (starting) estimated.assign(nall, 0);

  const MovingBalls balls = moving_balls();
  const MovingPartners partners = {balls, force->newton_pair ? INT_MAX : atom->nlocal};
  if (starting) {
    InitialOverlap initial(lmp);
    for (ContactList &l : lists)
      l.start(balls, partners, [&](const ContactList::Entry &e, double overlap) {
        initial.look(overlap, std::min(atom->radius[e.i], atom->radius[e.j]), atom->tag[e.i],
                     atom->x[e.i], fmt::format("ball {}", atom->tag[e.j]));
      });
    initial.check("Pair gran/restitution");
  }
  for (ContactList &l : lists) l.find(starting, lists_new, balls, partners);
  for (ContactHolder *wall : walls) wall->find_contacts(starting, lists_new);
  shared = lists_new ? BOTH_COUNTS : COUNTS;
  share();
}

/* ----------------------------------------------------------------------
   numbers of balls that several ranks know: see what. Those of a step ago are complete already,
   unless they have been counted anew.
------------------------------------------------------------------------- */

void PairGranRestitution::share()
{
  if (force->newton_pair) compat::reverse_comm(comm, this);
  compat::forward_comm(comm, this);
}

int PairGranRestitution::pack_forward_comm(int n, int *list, double *buf, int, int *)
{
  const auto &first = shared == ESTIMATED ? estimated : counts;
  int m = 0;
  for (int k = 0; k < n; k++) {
    buf[m++] = first[list[k]];
    if (shared == BOTH_COUNTS) buf[m++] = counts_before[list[k]];
  }
  return m;
}

void PairGranRestitution::unpack_forward_comm(int n, int begin, double *buf)
{
  auto &first = shared == ESTIMATED ? estimated : counts;
  int m = 0;
  for (int i = begin; i < begin + n; i++) {
    first[i] = static_cast<unsigned char>(buf[m++]);
    if (shared == BOTH_COUNTS) counts_before[i] = static_cast<unsigned char>(buf[m++]);
  }
}

int PairGranRestitution::pack_reverse_comm(int n, int begin, double *buf)
{
  const auto &first = shared == ESTIMATED ? estimated : counts;
  int m = 0;
  for (int i = begin; i < begin + n; i++) {
    buf[m++] = first[i];
    if (shared == BOTH_COUNTS) buf[m++] = counts_before[i];
  }
  return m;
}

void PairGranRestitution::unpack_reverse_comm(int n, int *list, double *buf)
{
  auto add = [](unsigned char &sum, double more) {
    sum = static_cast<unsigned char>(std::min(255.0, sum + more));
  };
  auto &first = shared == ESTIMATED ? estimated : counts;
  int m = 0;
  for (int k = 0; k < n; k++) {
    add(first[list[k]], buf[m++]);
    if (shared == BOTH_COUNTS) add(counts_before[list[k]], buf[m++]);
  }
}

bool PairGranRestitution::force_estimated(int i) const
{
  return i < static_cast<int>(estimated.size()) && estimated[i];
}

/* ----------------------------------------------------------------------
   history of a contact as its partner sees it
------------------------------------------------------------------------- */

void PairGranRestitution::transfer_history(double *source, double *target)
{
  for (int k = 0; k < HISTORY; k++) target[k] = -source[k];
  target[PHASE] = source[PHASE];
}

void PairGranRestitution::transfer_history(double *source, double *target, int, int)
{
  transfer_history(source, target);
}

/* ---------------------------------------------------------------------- */

void PairGranRestitution::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  starting = update->setupflag;
  const bool lists_new = starting || fix_history->lists_new;
  if (lists_new) build_lists();
  if (starting) find_half_step();
  else if (!half_v.empty()) {
    half_v.clear();
    half_omega.clear();
  }

  find_contacts(lists_new);

  const int nlocal = atom->nlocal, newton_pair = force->newton_pair;
  const MovingBalls balls = moving_balls();
  const MovingPartners partners = {balls, newton_pair ? INT_MAX : nlocal};
  for (size_t k = 0; k < lists.size(); k++) {
    const ContactLaw &law = laws[k / 3];
    if (evflag)
      lists[k].apply<true>(law, dt, starting, balls, partners,
                           [&](int i, int j, const Vector &f, const Vector &d) {
                             ev_tally_xyz(i, j, nlocal, newton_pair, 0.0, 0.0, f.x, f.y, f.z, d.x,
                                          d.y, d.z);
                           });
    else
      lists[k].apply<false>(law, dt, starting, balls, partners,
                            [](int, int, const Vector &, const Vector &) {});
  }
  fix_history->lists_used = true;
  if (starting) {
    shared = ESTIMATED;
    share();
  }
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

  // as the law has it: velocities and overlap of the same time

  ContactLaw law = laws[index(itype, jtype)];
  law.exact = 0.0;
  MovingBalls balls = moving_balls();
  balls.v = vectors(atom->v);
  balls.omega = vectors(atom->omega);
  ContactList pair_of_balls;
  pair_of_balls.clear(!(atom->mask[i] & freeze_group_bit), !(atom->mask[j] & freeze_group_bit));
  Contact contact;
  Vector delta;
  const MovingPartners partners = {balls, INT_MAX};
  ContactList::set_contact(law, balls, partners, {i, j}, contact, delta);
  const ContactStep step = pair_of_balls.step_of(law, dt, true, atom->radius[i], atom->radius[j],
                                                 atom->rmass[i], atom->rmass[j]);
  ContactForce c;
  contact_force(step, contact, 0.0, history, c);

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
  fwrite(coeffs.data(), sizeof(Coeff), coeffs.size(), fp);
}

void PairGranRestitution::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  if (comm->me == 0)
    utils::sfread(FLERR, coeffs.data(), sizeof(Coeff), coeffs.size(), fp, nullptr, error);
  MPI_Bcast(coeffs.data(), sizeof(Coeff) * coeffs.size(), MPI_BYTE, 0, world);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (coeffs[index(i, j)].set) setflag[i][j] = 1;
  make_laws();
}

void PairGranRestitution::write_restart_settings(FILE *fp)
{
  const int values[5] = {FORMAT, mass_ball, limit_damping, rolling_reduced, plain};
  fwrite(values, sizeof(int), 5, fp);
}

void PairGranRestitution::read_restart_settings(FILE *fp)
{
  int values[5] = {0, 0, 0, 0, 0};
  if (comm->me == 0) utils::sfread(FLERR, values, sizeof(int), 5, fp, nullptr, error);
  MPI_Bcast(values, 5, MPI_INT, 0, world);
  if (values[0] != FORMAT)
    error->all(FLERR,
               "Pair gran/restitution: restart file must have contacts of format {}, got {}: begin anew, or "
               "go on with the version of the package that wrote it",
               FORMAT, values[0] > 1 ? std::to_string(values[0]) : "one of an earlier version");
  mass_ball = values[1];
  limit_damping = values[2];
  rolling_reduced = values[3];
  plain = values[4];
}

/* ---------------------------------------------------------------------- */

void *PairGranRestitution::extract(const char *name, int &dim)
{
  dim = 0;
  if (strcmp(name, "history_size") == 0) {
    static int size = HISTORY;
    return &size;
  }
  return nullptr;
}

/* ---------------------------------------------------------------------- */

double PairGranRestitution::memory_usage()
{
  double bytes = coeffs.size() * (sizeof(Coeff) + sizeof(ContactLaw));
  for (const ContactList &l : lists) bytes += l.memory_usage();
  bytes += counts.capacity() + counts_before.capacity() + estimated.capacity();
  bytes += (half_v.capacity() + half_omega.capacity()) * sizeof(Vector);
  return bytes;
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

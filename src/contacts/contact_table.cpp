/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "contact_table.h"

#include "atom.h"
#include "comm.h"
#include "constants.h"
#include "error.h"
#include "fix.h"
#include "lammps_compat.h"
#include "style_argument.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace Slope;

static constexpr double STEP_RULE = 0.25;       // dt <= STEP_RULE sqrt(m/kn)
static constexpr double DASHPOT_RULE = 0.15;    // scheme plain: dt <= DASHPOT_RULE m/cn
static constexpr int FORMAT =
    20261123;    // of what restart files hold, histories of walls included

/* ---------------------------------------------------------------------- */

ContactTable::ContactTable(LAMMPS *lmp) :
    Pointers(lmp), mass_ball(0), limit_damping(0), rolling_reduced(0), scheme(EXACT)
{
}

void ContactTable::allocate()
{
  const int n = atom->ntypes + 1;
  Coeff none;
  memset(&none, 0, sizeof(Coeff));
  coeffs.assign(n * n, none);
  laws.assign(n * n, ContactLaw());
  wall_type.assign(n, 0);
}

int ContactTable::index(int itype, int jtype) const
{
  return itype * (atom->ntypes + 1) + jtype;
}

/* ----------------------------------------------------------------------
   pair_style gran/restitution keyword value ...
------------------------------------------------------------------------- */

void ContactTable::read_settings(int narg, char **arg)
{
  mass_ball = limit_damping = rolling_reduced = 0;
  scheme = EXACT;

  struct Setting {
    int *value;
    const char *names[2];
  };
  for (int iarg = 0; iarg < narg; iarg += 2) {
    const std::string keyword = arg[iarg];
    if (iarg + 2 > narg)
      error->all(FLERR, "Pair gran/restitution {}: value missing or unknown keyword", keyword);
    const Setting setting = keyword == "mass" ? Setting{&mass_ball, {"pair", "ball"}}
        : keyword == "limit_damping"          ? Setting{&limit_damping, {"no", "yes"}}
        : keyword == "rolling_radius"         ? Setting{&rolling_reduced, {"ball", "reduced"}}
        : keyword == "scheme"                 ? Setting{&scheme, {"exact", "plain"}}    // as Scheme
                                              : Setting{nullptr, {nullptr, nullptr}};
    if (!setting.value)
      error->all(FLERR,
                 "Pair gran/restitution: unknown keyword {}, must be mass, limit_damping, "
                 "rolling_radius or scheme",
                 keyword);
    const std::string value = arg[iarg + 1];
    if (value != setting.names[0] && value != setting.names[1])
      error->all(FLERR, "Pair gran/restitution {} must be {} or {}, got {}", keyword,
                 setting.names[0], setting.names[1], value);
    *setting.value = value == setting.names[1];
  }
  make_laws();
}

/* ----------------------------------------------------------------------
   pair_coeff I J keyword values ...; types: "I J", for messages
------------------------------------------------------------------------- */

ContactTable::Coeff ContactTable::read_coeff(const std::string &types, int narg, char **arg) const
{
  Coeff c;
  memset(&c, 0, sizeof(Coeff));
  c.set = 1;
  bool stiffness = false, damping = false;

  int iarg = 0;
  while (iarg < narg) {
    const std::string keyword = arg[iarg];
    auto value = [&](int k) {
      if (iarg + k >= narg)
        error->all(FLERR, "Pair gran/restitution {}: value {} is missing", keyword, k);
      return number_argument(lmp, fmt::format("Pair gran/restitution {}: value {}", keyword, k),
                             arg[iarg + k]);
    };
    auto rule = [&](bool holds, const char *text, double got) {
      if (!holds)
        error->all(FLERR, "Pair gran/restitution {} must be {}, got {:.15g}", keyword, text, got);
    };
    auto read_two = [&](double &a, const char *rule_a, double &b, const char *rule_b) {
      a = value(1);
      b = value(2);
      rule(a >= 0.0, rule_a, a);
      rule(b >= 0.0, rule_b, b);
      iarg += 3;
    };
    if (keyword == "stiffness") {
      read_two(c.kn, "> 0 (kn)", c.kt, ">= 0 (kt)");
      rule(c.kn > 0.0, "> 0 (kn)", c.kn);
      stiffness = true;
    } else if (keyword == "restitution") {
      c.e = value(1);
      rule(c.e > 0.0 && c.e <= 1.0, "> 0 and <= 1", c.e);
      c.restitution_set = 1;
      iarg += 2;
    } else if (keyword == "damping") {
      read_two(c.cn, ">= 0 (cn)", c.ct, ">= 0 (ct)");
      damping = true;
    } else if (keyword == "friction") {
      c.phi = value(1);
      rule(c.phi >= 0.0 && c.phi < 90.0, ">= 0 and < 90 degrees", c.phi);
      iarg += 2;
    } else if (keyword == "rolling") {
      c.rolling = value(1);
      rule(c.rolling >= 0.0, ">= 0", c.rolling);
      iarg += 2;
    } else if (keyword == "rolling_spring") {
      read_two(c.kr, ">= 0 (kr)", c.cr, ">= 0 (cr)");
      c.spring_set = 1;
    } else {
      error->all(FLERR,
                 "Pair gran/restitution pair_coeff: unknown keyword {}, must be stiffness, "
                 "restitution, damping, friction, rolling or rolling_spring",
                 keyword);
    }
  }

  check_coeff(types, c, stiffness, damping);
  return c;
}

/* ----------------------------------------------------------------------
   what the keywords of a pair_coeff must be together
------------------------------------------------------------------------- */

void ContactTable::check_coeff(const std::string &types, const Coeff &c, bool stiffness,
                               bool damping) const
{
  if (!stiffness)
    error->all(FLERR, "Pair gran/restitution pair_coeff {}: stiffness kn kt is required", types);
  if (c.kt == 0.0 && c.ct > 0.0)
    error->all(
        FLERR,
        "Pair gran/restitution pair_coeff {}: ct must be 0 where kt is 0, got {:.15g}: give the "
        "contact a tangential stiffness",
        types, c.ct);
  if (c.rolling > 0.0 && c.spring_set && c.kr == 0.0 && c.cr == 0.0)
    error->all(FLERR,
               "Pair gran/restitution pair_coeff {}: rolling_spring must not be 0 0 where rolling "
               "is > 0, got rolling {:.15g}: without spring and dashpot nothing resists rolling",
               types, c.rolling);
  if (damping == (c.restitution_set == 1))
    error->all(FLERR,
               "Pair gran/restitution pair_coeff {}: exactly one of restitution and damping is "
               "required, got {}",
               types, damping ? "both" : "neither");
}

/* ---------------------------------------------------------------------- */

void ContactTable::set(int itype, int jtype, const Coeff &c)
{
  coeffs[index(itype, jtype)] = coeffs[index(jtype, itype)] = c;
}

/* ----------------------------------------------------------------------
   contact laws from the coefficients: c = 2 zeta sqrt(k m) in both directions
------------------------------------------------------------------------- */

void ContactTable::make_laws()
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
    law.exact = scheme == EXACT ? 1.0 : 0.0;
    laws[k] = law;
  }
}

/* ----------------------------------------------------------------------
   masses and radii of the atoms of each type
------------------------------------------------------------------------- */

void ContactTable::find_ranges(int freeze_group_bit)
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
  std::fill(wall_type.begin(), wall_type.end(), 0);    // wall fixes announce themselves after
}

/* ----------------------------------------------------------------------
   a wall needs the law of every type that it meets
------------------------------------------------------------------------- */

void ContactTable::add_wall(int type, int groupbit, const char *style)
{
  for (int itype = 1; itype <= atom->ntypes; itype++) {
    int mine = 0, any;
    for (int i = 0; i < atom->nlocal && !mine; i++)
      if ((atom->mask[i] & groupbit) && atom->type[i] == itype) mine = 1;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (any && (coeffs.empty() || !is_set(itype, type)))
      error->all(FLERR, "Fix {}: pair_coeff {} {} is not set (moving type {}, wall type {})", style,
                 std::min(itype, type), std::max(itype, type), itype, type);
  }
  if (!coeffs.empty()) wall_type[type] = 1;
}

/* ----------------------------------------------------------------------
   type pairs that can touch: one side moves, the other one does too, is frozen or a wall
------------------------------------------------------------------------- */

bool ContactTable::balls_can_touch(int i, int j) const
{
  const TypeRange &a = ranges[i], &b = ranges[j];
  const bool a_moves = a.radius_dynamic > 0.0, b_moves = b.radius_dynamic > 0.0;
  return (a_moves && (b_moves || b.frozen)) || (b_moves && a.frozen);
}

bool ContactTable::can_touch(int i, int j) const
{
  const TypeRange &a = ranges[i], &b = ranges[j];
  if (!coeffs[index(i, j)].set) return false;
  return (a.moving && (b.moving || b.frozen || wall_type[j])) ||
      (b.moving && (a.frozen || wall_type[i]));
}

/* ----------------------------------------------------------------------
   no contact between two frozen balls
------------------------------------------------------------------------- */

double ContactTable::cutoff(int i, int j) const
{
  const TypeRange &a = ranges[i], &b = ranges[j];
  return std::max({a.radius_dynamic + b.radius_dynamic, a.radius_frozen + b.radius_dynamic,
                   a.radius_dynamic + b.radius_frozen});
}

/* ----------------------------------------------------------------------
   largest step for a type pair: that of its lightest moving ball. Scheme exact follows any
   dashpot; the plain one needs small steps, for the dashpots of several contacts add up.
------------------------------------------------------------------------- */

double ContactTable::bound_on_step(int i, int j) const
{
  return std::min(spring_bound(i, j), dashpot_bound(i, j));
}

double ContactTable::spring_bound(int i, int j) const
{
  return STEP_RULE * sqrt(lightest(i, j) / coeff(i, j).kn);
}

double ContactTable::dashpot_bound(int i, int j) const
{
  const double m = lightest(i, j), cn = law(i, j).cn(m);
  return is_plain() && cn > 0.0 ? DASHPOT_RULE * m / cn : HUGE_VAL;
}

double ContactTable::lightest(int i, int j) const
{
  return std::min(ranges[i].moving ? ranges[i].mass_min : HUGE_VAL,
                  ranges[j].moving ? ranges[j].mass_min : HUGE_VAL);
}

/* ----------------------------------------------------------------------
   table of the coefficients, for the lightest balls of each type pair
------------------------------------------------------------------------- */

std::string ContactTable::text(double dt) const
{
  std::string text =
      "Pair gran/restitution: contact coefficients (lightest balls of each type pair)\n"
      "  types    kn N/m       kt N/m       cn N s/m     zeta     e moving e fixed  friction "
      "rolling  contact/dt\n";
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (can_touch(i, j)) text += line(i, j, dt);
  return text + "  e fixed: against a fixed ball. friction, rolling: angles in degrees.\n";
}

std::string ContactTable::line(int i, int j, double dt) const
{
  auto number = [](double x) {
    return std::isfinite(x) ? fmt::format("{:.4g}", x) : "inf";
  };
  const Coeff &c = coeffs[index(i, j)];
  const TypeRange &a = ranges[i], &b = ranges[j];
  const ContactLaw &law = laws[index(i, j)];
  const bool both = a.moving && b.moving;

  // a ball on a fixed one: the lighter of the moving types

  const double single = lightest(i, j);
  const double zeta_fixed = law.cn(law.mass_fixed(single)) / (2.0 * sqrt(c.kn * single));
  double m = single, cn = law.cn(law.mass_fixed(single)), zeta = zeta_fixed;
  std::string e_moving = "-";
  if (both) {
    m = a.mass_min * b.mass_min / (a.mass_min + b.mass_min);
    cn = law.cn(law.mass(a.mass_min, b.mass_min));
    zeta = cn / (2.0 * sqrt(c.kn * m));
    e_moving = fmt::format("{:.4f}", restitution(zeta));
  }
  return fmt::format("  {:<3} {:<3}  {:<12.4g} {:<12.4g} {:<12.4g} {:<8.4f} {:<8} {:<8.4f} "
                     "{:<8.4g} {:<8.4g} {}\n",
                     i, j, c.kn, c.kt, cn, zeta, e_moving, restitution(zeta_fixed), c.phi,
                     atan(c.rolling) / DEGREE, number(contact_time(c.kn, m, zeta) / dt));
}

/* ----------------------------------------------------------------------
   settings and coefficients in the restart file
------------------------------------------------------------------------- */

void ContactTable::write_settings(FILE *fp) const
{
  const int values[5] = {FORMAT, mass_ball, limit_damping, rolling_reduced, scheme};
  fwrite(values, sizeof(int), 5, fp);
}

void ContactTable::write_coeffs(FILE *fp) const
{
  fwrite(coeffs.data(), sizeof(Coeff), coeffs.size(), fp);
}

void ContactTable::read_settings(FILE *fp)
{
  int values[5] = {0, 0, 0, 0, 0};
  if (comm->me == 0) utils::sfread(FLERR, values, sizeof(int), 5, fp, nullptr, error);
  MPI_Bcast(values, 5, MPI_INT, 0, world);
  if (values[0] != FORMAT)
    error->all(FLERR,
               "Pair gran/restitution: restart file must have contacts of format {}, got {}: start "
               "again, or continue with the version of the package that wrote it",
               FORMAT, values[0] > 1 ? std::to_string(values[0]) : "one of an earlier version");
  mass_ball = values[1];
  limit_damping = values[2];
  rolling_reduced = values[3];
  scheme = values[4];
}

void ContactTable::read_coeffs(FILE *fp)
{
  if (comm->me == 0)
    utils::sfread(FLERR, coeffs.data(), sizeof(Coeff), coeffs.size(), fp, nullptr, error);
  MPI_Bcast(coeffs.data(), sizeof(Coeff) * coeffs.size(), MPI_BYTE, 0, world);
  make_laws();
}

/* ---------------------------------------------------------------------- */

double ContactTable::memory_usage() const
{
  return coeffs.size() * (sizeof(Coeff) + sizeof(ContactLaw));
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "contact_coeffs.h"

#include "archive.h"
#include "constants.h"
#include "error.h"
#include "style_argument.h"

#include <algorithm>
#include <vector>

using namespace LAMMPS_NS;
using namespace Slope;

/* ----------------------------------------------------------------------
   words of pair_style, each with two values, the first of which is meant without it
------------------------------------------------------------------------- */

namespace {
struct Setting {
  const char *word, *values[2];
  bool ContactSettings::*value;
};
}    // namespace

static const Setting SETTINGS[] = {
    {"mass", {"pair", "ball"}, &ContactSettings::mass_ball},
    {"limit_damping", {"no", "yes"}, &ContactSettings::limit_damping},
    {"rolling_radius", {"ball", "reduced"}, &ContactSettings::rolling_reduced},
    {"scheme", {"exact", "plain"}, &ContactSettings::plain}};

/* ----------------------------------------------------------------------
   words of pair_coeff, and what their numbers must be
------------------------------------------------------------------------- */

namespace {
struct Number {
  double ContactCoeffs::*value;
  const char *name;    // in restart files
  const char *rule;
  bool (*holds)(double);
};

struct Word {
  const char *word, *values;
  std::vector<Number> numbers;
};
}    // namespace

static bool positive(double x)
{
  return x > 0.0;
}

static bool not_negative(double x)
{
  return x >= 0.0;
}

static bool share(double x)
{
  return x > 0.0 && x <= 1.0;
}

static bool angle(double x)
{
  return x >= 0.0 && x < 90.0;
}

static const std::vector<Word> WORDS = {
    {"stiffness",
     "kn kt",
     {{&ContactCoeffs::kn, "kn", "> 0", positive},
      {&ContactCoeffs::kt, "kt", ">= 0", not_negative}}},
    {"restitution", "e", {{&ContactCoeffs::e, "restitution", "> 0 and <= 1", share}}},
    {"damping",
     "cn ct",
     {{&ContactCoeffs::cn, "cn", ">= 0", not_negative},
      {&ContactCoeffs::ct, "ct", ">= 0", not_negative}}},
    {"friction", "phi", {{&ContactCoeffs::phi, "friction", ">= 0 and < 90 degrees", angle}}},
    {"rolling", "mu_r", {{&ContactCoeffs::rolling, "rolling", ">= 0", not_negative}}},
    {"rolling_spring",
     "kr cr",
     {{&ContactCoeffs::kr, "kr", ">= 0", not_negative},
      {&ContactCoeffs::cr, "cr", ">= 0", not_negative}}}};

static bool given(double value)
{
  return !std::isnan(value);
}

static double or_zero(double value)
{
  return given(value) ? value : 0.0;
}

/* ---------------------------------------------------------------------- */

void ContactSettings::read(LAMMPS *lmp, int narg, char **arg)
{
  *this = ContactSettings();
  for (KeywordReader word(lmp, "Pair gran/restitution", narg, arg); word.next();) {
    const auto is_it = [&](const Setting &s) {
      return word.is(s.word, s.values[0] + std::string("|") + s.values[1]);
    };
    const Setting *s = std::find_if(std::begin(SETTINGS), std::end(SETTINGS), is_it);
    if (s == std::end(SETTINGS)) word.unknown();
    this->*s->value = word.choice({s->values[0], s->values[1]}) == 1;
  }
}

void ContactSettings::archive(Archive &archive)
{
  for (const Setting &s : SETTINGS) archive.number(s.word, this->*s.value);
}

/* ---------------------------------------------------------------------- */

void ContactCoeffs::read(LAMMPS *lmp, const std::string &types, int narg, char **arg)
{
  Error *const error = lmp->error;
  const std::string caller = "Pair gran/restitution pair_coeff " + types;
  *this = ContactCoeffs();
  for (KeywordReader word(lmp, caller, narg, arg); word.next();) {
    const auto is_it = [&](const Word &w) {
      return word.is(w.word, w.values);
    };
    const auto its = std::find_if(WORDS.begin(), WORDS.end(), is_it);
    if (its == WORDS.end()) word.unknown();
    int k = 1;
    for (const Number &number : its->numbers) {
      this->*number.value = word.number(k);
      word.must(number.holds(this->*number.value), number.rule, k++);
    }
  }

  // what they must be together

  if (!given(kn)) error->all(FLERR, "{}: stiffness kn kt is required", caller);
  if (kt == 0.0 && ct > 0.0)
    error->all(FLERR,
               "{}: ct must be 0 where kt is 0, got {:.15g}: give the contact a tangential "
               "stiffness",
               caller, ct);
  if (rolling > 0.0 && kr == 0.0 && cr == 0.0)
    error->all(FLERR,
               "{}: rolling_spring must not be 0 0 where rolling is > 0, got rolling {:.15g}: "
               "without spring and dashpot nothing resists rolling",
               caller, rolling);
  if (given(cn) == given(e))
    error->all(FLERR, "{}: exactly one of restitution and damping is required, got {}", caller,
               given(cn) ? "both" : "neither");
}

void ContactCoeffs::archive(Archive &archive)
{
  for (const Word &word : WORDS)
    for (const Number &number : word.numbers) archive.number(number.name, this->*number.value);
}

/* ----------------------------------------------------------------------
   c = 2 zeta sqrt(k m) in both directions
------------------------------------------------------------------------- */

ContactLaw ContactCoeffs::law(const ContactSettings &settings) const
{
  ContactLaw law = ContactLaw();
  const double zeta = given(e) ? damping_ratio(e) : 0.0;
  law.kn = kn;
  law.kt = kt;
  law.cn_given = or_zero(cn);
  law.ct_given = or_zero(ct);
  law.cn_root = 2.0 * zeta * sqrt(kn);
  law.ct_root = 2.0 * zeta * sqrt(kt);
  law.kr = given(kr) ? kr : law.kt;
  law.cr_given = given(kr) ? cr : law.ct_given;
  law.cr_root = given(kr) ? 0.0 : law.ct_root;
  law.friction = tan(or_zero(phi) * DEGREE);
  law.rolling = or_zero(rolling);
  law.mass_factor = settings.mass_ball ? 2.0 : 1.0;
  law.rolling_factor = settings.rolling_reduced ? 1.0 : 2.0;
  law.fn_least = settings.limit_damping ? 0.0 : -HUGE_VAL;
  law.exact = settings.plain ? 0.0 : 1.0;
  return law;
}

/* ---------------------------------------------------------------------- */

const char *ContactCoeffs::heading()
{
  return "  types    kn N/m       kt N/m       cn N s/m     zeta     e moving e fixed  friction "
         "rolling  contact/dt\n";
}

std::string ContactCoeffs::line(const ContactLaw &law, double mi, double mj, double dt) const
{
  // a ball on a fixed one: the lighter of the moving types

  const bool both = mi > 0.0 && mj > 0.0;
  double m = both ? std::min(mi, mj) : std::max(mi, mj);
  SpringDashpot normal = law.normal(m);
  const double e_fixed = restitution(normal.damping_ratio(m));
  std::string e_moving = "-";
  if (both) {
    m = mi * mj / (mi + mj);
    normal = law.normal(law.mass_factor * mi * mj / (mi + mj));
    e_moving = fmt::format("{:.4f}", restitution(normal.damping_ratio(m)));
  }
  const double zeta = normal.damping_ratio(m), steps = contact_time(normal.k, m, zeta) / dt;
  return fmt::format("{:<12.4g} {:<12.4g} {:<12.4g} {:<8.4f} {:<8} {:<8.4f} {:<8.4g} {:<8.4g} {}\n",
                     kn, kt, normal.c, zeta, e_moving, e_fixed, or_zero(phi),
                     atan(law.rolling) / DEGREE,
                     std::isfinite(steps) ? fmt::format("{:.4g}", steps) : "inf");
}

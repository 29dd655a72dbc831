/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "contact_table.h"

#include "archive.h"
#include "atom.h"
#include "error.h"
#include "inserted_balls.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace Slope;

static constexpr double STEP_RULE = 0.25;       // dt <= STEP_RULE sqrt(m/kn)
static constexpr double DASHPOT_RULE = 0.15;    // scheme plain: dt <= DASHPOT_RULE m/cn

/* ---------------------------------------------------------------------- */

ContactTable::ContactTable(LAMMPS *lmp) : Pointers(lmp) {}

void ContactTable::allocate()
{
  const int n = atom->ntypes + 1;
  coeffs.assign(n * n, ContactCoeffs());
  laws.assign(n * n, ContactLaw());
  wall_type.assign(n, 0);
}

int ContactTable::index(int itype, int jtype) const
{
  return itype * (atom->ntypes + 1) + jtype;
}

/* ---------------------------------------------------------------------- */

void ContactTable::set(const ContactSettings &its)
{
  settings = its;
  for (size_t k = 0; k < coeffs.size(); k++)
    if (coeffs[k].set()) laws[k] = coeffs[k].law(settings);
}

void ContactTable::set(int itype, int jtype, const ContactCoeffs &c)
{
  for (const int k : {index(itype, jtype), index(jtype, itype)}) {
    coeffs[k] = c;
    laws[k] = c.law(settings);
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
  }
  for (const InsertedBalls &balls : inserted_balls(lmp)) {
    TypeRange &range = ranges[balls.type];
    range.radius_dynamic = std::max(range.radius_dynamic, balls.radius_max);
    if (balls.mass_max == 0.0) continue;
    range.mass_min = range.moving ? std::min(range.mass_min, balls.mass_min) : balls.mass_min;
    range.mass_max = std::max(range.mass_max, balls.mass_max);
    range.moving = true;
  }
}

/* ----------------------------------------------------------------------
   a wall needs the law of every type that it meets
------------------------------------------------------------------------- */

void ContactTable::forget_walls()
{
  std::fill(wall_type.begin(), wall_type.end(), 0);
}

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
  if (!is_set(i, j)) return false;
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

double ContactTable::largest_cutoff() const
{
  double largest = 0.0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (balls_can_touch(i, j)) largest = std::max(largest, cutoff(i, j));
  return largest;
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
  return STEP_RULE * sqrt(lightest(i, j) / normal(i, j).k);
}

double ContactTable::dashpot_bound(int i, int j) const
{
  const double cn = normal(i, j).c;
  return !is_exact() && cn > 0.0 ? DASHPOT_RULE * lightest(i, j) / cn : HUGE_VAL;
}

SpringDashpot ContactTable::normal(int i, int j) const
{
  return law(i, j).normal(lightest(i, j));
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
      "Pair gran/restitution: contact coefficients (lightest balls of each type pair)\n";
  text += ContactCoeffs::heading();
  auto lightest_of = [this](int type) {
    return ranges[type].moving ? ranges[type].mass_min : 0.0;
  };
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (can_touch(i, j))
        text += fmt::format("  {:<3} {:<3}  ", i, j) +
            coeffs[index(i, j)].line(law(i, j), lightest_of(i), lightest_of(j), dt);
  return text + "  e fixed: against a fixed ball. friction, rolling: angles in degrees.\n";
}

/* ----------------------------------------------------------------------
   members of a restart file: the settings; the coefficients of all pairs I <= J, NaN where none are set
------------------------------------------------------------------------- */

void ContactTable::archive_settings(Archive &archive)
{
  settings.archive(archive);
}

void ContactTable::archive_coeffs(Archive &archive)
{
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      ContactCoeffs c = coeffs[index(i, j)];
      c.archive(archive);
      if (archive.reads() && c.set()) set(i, j, c);
    }
}

/* ---------------------------------------------------------------------- */

double ContactTable::memory_usage() const
{
  return coeffs.size() * (sizeof(ContactCoeffs) + sizeof(ContactLaw));
}

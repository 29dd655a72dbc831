/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "motion_guard.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "lammps_compat.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

static constexpr double MOST_TURN = 1.0;    // rad in a step: no spring follows a faster spin

/* ---------------------------------------------------------------------- */

MotionGuard::MotionGuard(LAMMPS *lmp) : Pointers(lmp), frozen(0), stepped(false), unmoved(0) {}

void MotionGuard::start(int freeze_group_bit)
{
  frozen = freeze_group_bit;
  stepped = false;
  unmoved = 0;
}

/* ---------------------------------------------------------------------- */

MotionGuard::Movers MotionGuard::movers() const
{
  Movers m = {0, 0, ""};
  for (int k = 0; k < modify->nfix; k++) {
    const Fix *fix = modify->fix[k];
    const std::string style = Slope::plain_style(fix->style);
    if (fix->time_integrate) m.moved |= fix->groupbit;
    if (style != "move" && style != "setforce" && style != "nve/noforce") continue;
    m.guided |= fix->groupbit;
    m.guides += (m.guides.empty() ? "" : ", ") + std::string(fix->style);
  }
  return m;
}

// balls that no fix freeze holds

template <typename Test> bigint MotionGuard::count_free(Test test) const
{
  bigint mine = 0, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (!(atom->mask[i] & frozen) && test(i)) mine++;
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  return all;
}

/* ---------------------------------------------------------------------- */

std::vector<std::string> MotionGuard::begin_step()
{
  std::vector<std::string> found;
  if (stepped) return found;
  stepped = true;

  const Movers m = movers();
  check_unmoved(m, found);
  const bigint guided = count_free([&](int i) {
    return atom->mask[i] & m.guided;
  });
  if (guided)
    found.push_back(fmt::format(
        "{} balls are guided by fix {} and no fix freeze holds them: their contacts have the "
        "dashpots of free balls, and rebound faster than the restitution says",
        guided, m.guides));

  const double most = MOST_TURN / update->dt;
  const bigint whirling = count_free([&](int i) {
    const double *w = atom->omega[i];
    return w[0] * w[0] + w[1] * w[1] + w[2] * w[2] > most * most;
  });
  if (whirling)
    found.push_back(
        fmt::format("spins should be at most {:.4g} rad/s, which is {:g} rad in a step, got {} "
                    "balls with more: are they in rad/s, and meant?",
                    most, MOST_TURN, whirling));
  check_gravity(found);
  return found;
}

/* ---------------------------------------------------------------------- */

void MotionGuard::check_unmoved(const Movers &m, std::vector<std::string> &found)
{
  const bigint n = count_free([&](int i) {
    return !(atom->mask[i] & m.moved);
  });
  if (n > unmoved)
    found.push_back(
        fmt::format("no integrator moves {} balls and no fix freeze holds them: without fix "
                    "nve/sphere they hang where they are, and without fix freeze a fixed ball has "
                    "the dashpots of a moving one",
                    n));
  unmoved = n;
}

/* ----------------------------------------------------------------------
   upwards is z, in two dimensions y
------------------------------------------------------------------------- */

void MotionGuard::check_gravity(std::vector<std::string> &found) const
{
  const int up = domain->dimension - 1;
  const auto fixes = compat::fixes_of_style(lmp, "gravity");
  double most = 0.0, all;
  const bigint n = count_free([&](int i) {
    double g = 0.0;
    for (Fix *fix : fixes) {
      if (!(atom->mask[i] & fix->groupbit)) continue;
      int dim;
      g += static_cast<double *>(fix->extract("gvec", dim))[up];
    }
    most = std::max(most, g);
    return g > 0.0;
  });
  MPI_Allreduce(&most, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  if (n)
    found.push_back(fmt::format("{} of the gravity should be <= 0, got {:.6g}, which pulls {} "
                                "balls upwards",
                                "xyz"[up], all, n));
}

/* ----------------------------------------------------------------------
   a ball that contacts hold, or that falls, has a force, or moves
------------------------------------------------------------------------- */

std::vector<std::string> MotionGuard::end_run()
{
  std::vector<std::string> found;
  if (!stepped) return found;
  const Movers m = movers();
  check_unmoved(m, found);
  const auto is_zero = [](const double *a) {
    return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0;
  };
  const bigint hanging = count_free([&](int i) {
    return (atom->mask[i] & m.moved) && !(atom->mask[i] & m.guided) && is_zero(atom->v[i]) &&
        is_zero(atom->omega[i]) && is_zero(atom->f[i]);
  });
  if (hanging)
    found.push_back(fmt::format("{} balls hang at rest: no contact holds them, and neither fix "
                                "gravity nor anything else pulls them",
                                hanging));
  return found;
}

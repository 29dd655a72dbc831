/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "contact_guards.h"

#include "atom.h"
#include "comm.h"
#include "contact_kernel.h"
#include "contact_table.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "group.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr double STEP_TESTED = 1.5;      // of the rule's, scheme exact
static constexpr double ZETA_FOLLOWED = 2.0;    // damping ratio up to which the law is followed
static constexpr double MASS_RATIO_TESTED = 1000.0;    // of two balls that touch
static constexpr double MOST_TURN = 1.0;    // rad in a step: no spring follows a faster spin
static constexpr double DEEP = 0.1;         // overlap, of the smaller radius, that is not sensible

/* ---------------------------------------------------------------------- */

ContactGuards::ContactGuards(LAMMPS *lmp, const ContactTable &contacts) :
    Pointers(lmp), energy(lmp), growth(lmp), table(contacts), motion(lmp), overlaps{0.0, 0, 0, 0},
    unseen_told(false), running(false)
{
}

/* ----------------------------------------------------------------------
   by rank 0, or by all: to the screen, the log and the summaries
------------------------------------------------------------------------- */

template <typename... Args> void ContactGuards::warn(const char *format, const Args &...args)
{
  if (comm->me == 0) say("Pair gran/restitution: " + fmt::format(format, args...));
}

void ContactGuards::say(const std::string &text)
{
  if (comm->me > 0) return;
  error->warning(FLERR, text);
  if (std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(text);
}

/* ---------------------------------------------------------------------- */

void ContactGuards::start(int freeze_group_bit)
{
  print_table();
  const std::string unseen = compat::unseen();
  if (!unseen.empty() && !unseen_told) warn("{}", unseen);
  unseen_told = true;
  told.clear();
  check_balls();
  check_neighbor_lists(freeze_group_bit);
  overlaps = {0.0, 0, 0, 0};
  energy.start();
  motion.start(freeze_group_bit);
  running = true;
}

void ContactGuards::print_table()
{
  std::string text = table.text(update->dt) +
      fmt::format("  contact kernel {}\n", Slope::ContactKernels::current_name());
  const std::string unknown = energy.unknown_work();
  if (!unknown.empty())
    text += fmt::format("  energy is not checked: {} may do work of its own\n", unknown);
  if (text != printed && comm->me == 0) utils::logmesg(lmp, text);
  printed = text;
}

/* ---------------------------------------------------------------------- */

void ContactGuards::check_balls()
{
  check_timestep();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++)
      if (table.can_touch(i, j)) check_dashpots(i, j);
}

/* ----------------------------------------------------------------------
   warn when the step breaks dt <= 0.25 sqrt(m_min/kn), scheme plain, or 1.5 times it
------------------------------------------------------------------------- */

void ContactGuards::check_timestep()
{
  double bound = HUGE_VAL;
  int iworst = 0, jworst = 0;
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      if (!table.can_touch(i, j)) continue;
      const double b = table.bound_on_step(i, j);
      if (b < bound) {
        bound = b;
        iworst = i;
        jworst = j;
      }
    }
  const double dt = update->dt, tested = table.is_exact() ? STEP_TESTED : 1.0;
  if (dt <= tested * bound * (1.0 + 1.0e-12) || !told.insert("step").second) return;
  if (table.spring_bound(iworst, jworst) <= bound)
    warn("time step {:.4g} s is {:.3g} times the rule's, 0.25 sqrt(m_min/kn) = {:.4g} s (types {} "
         "{}): up to {:.3g} times was tested to hold the restitution, of several contacts at once "
         "too",
         dt, dt / bound, bound, iworst, jworst, tested);
  else
    warn("time step {:.4g} s is {:.3g} times the largest with which the dashpots of scheme plain "
         "allow a heap to come to rest, 0.15 m_min/cn = {:.4g} s (types {} {})",
         dt, dt / bound, bound, iworst, jworst);
}

/* ----------------------------------------------------------------------
   warn of dashpots and mass ratios beyond what the law follows
------------------------------------------------------------------------- */

void ContactGuards::check_dashpots(int i, int j)
{
  const ContactTable::TypeRange &a = table.range(i), &b = table.range(j);
  double lightest = HUGE_VAL, heaviest = 0.0;
  for (const ContactTable::TypeRange *range : {&a, &b})
    if (range->moving) {
      lightest = std::min(lightest, range->mass_min);
      heaviest = std::max(heaviest, range->mass_max);
    }
  const auto first = [&](const char *what) {
    return told.insert(fmt::format("{} {} {}", what, i, j)).second;
  };
  if (heaviest > MASS_RATIO_TESTED * lightest && a.moving && b.moving && first("masses"))
    warn("the masses of balls of types {} and {} that can touch are tested up to a ratio of {:g}, "
         "got {:.4g}",
         i, j, MASS_RATIO_TESTED, heaviest / lightest);
  const Slope::SpringDashpot normal = table.normal(i, j);
  const double zeta = normal.damping_ratio(lightest);
  if (zeta > ZETA_FOLLOWED && table.is_exact() && first("damping"))
    warn("damping ratio of types {} and {} must be <= {:g} to be followed in time, got {:.4g} (cn "
         "{:.4g} N s/m, lightest ball {:.4g} kg): these contacts do not rebound and rest at the "
         "right overlap, but reach it too fast",
         i, j, ZETA_FOLLOWED, zeta, normal.c, lightest);
}

/* ----------------------------------------------------------------------
   warn when contacts can begin before the neighbor list has them
------------------------------------------------------------------------- */

void ContactGuards::check_neighbor_lists(int freeze_group_bit)
{
  if (neighbor->includegroup) {
    const int listed =
        compat::group_bit(lmp, group->names[neighbor->includegroup]) | freeze_group_bit;
    bigint mine = 0, outside;
    for (int i = 0; i < atom->nlocal; i++) mine += !(atom->mask[i] & listed);
    MPI_Allreduce(&mine, &outside, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    if (outside)
      warn("neigh_modify include must name a group of all balls that move, got {}, without {} of "
           "them: they touch no other, and lists are not made again for them, so that they pass "
           "through walls",
           group->names[neighbor->includegroup], outside);
  }
  if (neighbor->build_once)
    warn("neigh_modify once should be no, got yes: balls that come near each other or a wall later "
         "are "
         "not found, and pass through");
  if (neighbor->delay == 0 && neighbor->every == 1) return;
  warn("with neigh_modify every {} delay {} check {} contacts may be found late and rebound too "
       "fast; every 1 delay 0 check yes finds them in time",
       neighbor->every, neighbor->delay, neighbor->dist_check ? "yes" : "no");
}

/* ---------------------------------------------------------------------- */

void ContactGuards::begin_step()
{
  running = true;
  for (const std::string &text : motion.begin_step()) warn("{}", text);
}

/* ---------------------------------------------------------------------- */

void ContactGuards::record_overlap(int i, double overlap, double radius)
{
  const double share = overlap / radius;
  if (share > DEEP) overlaps.count++;
  if (share > overlaps.most) overlaps = {share, atom->tag[i], update->ntimestep, overlaps.count};
}

/* ----------------------------------------------------------------------
   the energy must not grow
------------------------------------------------------------------------- */

void ContactGuards::watch_energy(double elastic)
{
  if (energy.check(elastic))
    warn("the energy of the balls grew by {:.3g} % of the largest kinetic and spring energy until "
         "step {}, with nothing but contacts and gravity at work: the time step is too large, or "
         "contacts were found late",
         100.0 * energy.growth(), update->ntimestep);
}

/* ----------------------------------------------------------------------
   lists are found again when a ball has moved by half the skin, whatever its size
------------------------------------------------------------------------- */

void ContactGuards::check_growth(double beyond)
{
  const double skin = neighbor->skin, grown = growth.grown();
  if (grown > 0.5 * skin && told.insert("growth").second)
    warn(
        "balls should grow by at most half the skin, {:.4g}, while there is one neighbor list, got "
        "{:.4g} until step {}: contacts may be found late or not at all; a larger skin, or "
        "neigh_modify check no",
        0.5 * skin, grown, update->ntimestep);
  if (beyond > 0.5 * skin && atom->natoms > 1 && told.insert("reach").second)
    warn("two balls should reach at most half the skin, {:.4g}, farther than the largest at the "
         "start of the run, got {:.4g} at step {}: neighbor lists do not reach so far, and balls "
         "may pass through each other; a larger skin, or several runs",
         0.5 * skin, beyond, update->ntimestep);
}

/* ---------------------------------------------------------------------- */

void GrowthGuard::begin(bool sizes_vary)
{
  wanted = sizes_vary;
  radius.clear();    // other balls may have these indices now
  most = 0.0;
}

/* ---------------------------------------------------------------------- */

void GrowthGuard::begin_list()
{
  if (wanted) radius.assign(atom->radius, atom->radius + atom->nlocal);
}

void GrowthGuard::end_list()
{
  const size_t known = std::min<size_t>(radius.size(), atom->nlocal);
  for (size_t i = 0; i < known; i++) most = std::max(most, atom->radius[i] - radius[i]);
}

double GrowthGuard::grown()
{
  end_list();
  double all;
  MPI_Allreduce(&most, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  most = 0.0;
  return all;
}

/* ---------------------------------------------------------------------- */

ContactGuards::Found ContactGuards::found() const
{
  Found f;
  // copies: LAMMPS' stand-in for MPI takes no const
  double most = overlaps.most;
  bigint count = overlaps.count;
  MPI_Allreduce(&most, &f.deepest, 1, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(&count, &f.deep, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  f.energy_growth = energy.growth();
  f.energy_grew = energy.seen();
  f.dangerous_builds = neighbor->ndanger;
  return f;
}

void ContactGuards::Found::add(const Found &other)
{
  deepest = std::max(deepest, other.deepest);
  energy_growth = std::max(energy_growth, other.energy_growth);
  deep += other.deep;
  energy_grew += other.energy_grew;
  dangerous_builds += other.dangerous_builds;
}

/* ----------------------------------------------------------------------
   warn, once per run and with a count, of what was not sensible
------------------------------------------------------------------------- */

void ContactGuards::report()
{
  if (!running) return;
  running = false;
  const Found f = found();
  if (f.deep) {
    Overlaps deepest = overlaps;
    with_largest(world, overlaps.most, deepest);
    warn(
        "{} contacts were seen deeper than {:g} % of the smaller radius, the deepest {:.3g} % "
        "(ball {}, step {}): the stiffness is too small for the speeds, or the time step too large",
        f.deep, 100.0 * DEEP, 100.0 * deepest.most, deepest.ball, deepest.step);
  }
  if (f.energy_grew > 1)
    warn("the energy of the balls had grown at {} of the checks every {} steps, by {:.3g} % of the "
         "largest kinetic and spring energy",
         f.energy_grew, +EnergyGuard::EVERY, 100.0 * f.energy_growth);
  if (f.dangerous_builds)
    warn("{} neighbor lists came late (dangerous builds): balls went farther than half the skin "
         "{:g} in one step, and contacts may have started too deep",
         f.dangerous_builds, neighbor->skin);
  for (const std::string &text : motion.end_run()) warn("{}", text);
}

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
  for (const Fix *fix : compat::fixes(lmp)) {
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
  check_frozen(m, found);
  return found;
}

/* ----------------------------------------------------------------------
   fix freeze takes away the forces that there are when its turn comes, and none of the fixes after it
------------------------------------------------------------------------- */

void MotionGuard::check_frozen(const Movers &m, std::vector<std::string> &found) const
{
  std::vector<const Fix *> after;    // that add forces
  bool freezes = false;
  for (const Fix *fix : compat::fixes(lmp))
    if (Slope::is_style(fix->style, "freeze"))
      freezes = true;
    else if (freezes && (compat::mask_of(lmp, fix) & FixConst::POST_FORCE))
      after.push_back(fix);

  // how many balls move though frozen, and of how many each fix has the force

  std::vector<bigint> mine(after.size() + 1, 0), all(mine.size());
  for (int i = 0; i < atom->nlocal; i++) {
    const double *f = atom->f[i];
    const int mask = atom->mask[i];
    if (!(mask & frozen) || !(mask & m.moved) || (f[0] == 0.0 && f[1] == 0.0 && f[2] == 0.0))
      continue;
    mine.back()++;
    for (size_t k = 0; k < after.size(); k++) mine[k] += (mask & after[k]->groupbit) != 0;
  }
  MPI_Allreduce(mine.data(), all.data(), static_cast<int>(mine.size()), MPI_LMP_BIGINT, MPI_SUM,
                world);
  if (all.back() == 0) return;
  std::string names;
  for (size_t k = 0; k < after.size(); k++)
    if (all[k])
      names += fmt::format("{}{} {}", names.empty() ? "" : ", ", after[k]->id, after[k]->style);
  found.push_back(fmt::format("balls of fix freeze must have no force, got {} that move by one: "
                              "define fix freeze after fix {}",
                              all.back(), names));
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
      if (atom->mask[i] & fix->groupbit) g += acceleration_of(fix)[up];
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

/* ---------------------------------------------------------------------- */

void InitialOverlap::record(double overlap, double radius, tagint ball, const double *where,
                            const std::string &partner)
{
  const double ratio = overlap / radius;
  if (ratio <= LIMIT) return;
  count++;
  if (ratio <= worst) return;
  worst = ratio;
  text = fmt::format("ball {} and {} at {:.6g} {:.6g} {:.6g}", ball, partner, where[0], where[1],
                     where[2]);
}

/* ---------------------------------------------------------------------- */

void InitialOverlap::check(const std::string &caller, const std::string &remedy)
{
  if (!in_run) return;
  bigint total;
  MPI_Allreduce(&count, &total, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (total == 0) return;

  char buffer[256] = "";
  strncpy(buffer, text.c_str(), sizeof(buffer) - 1);
  const double most = with_largest(world, worst, buffer);

  error->all(FLERR,
             "{}: {} pairs overlap at the start by more than {:g} % of the radius, worst {:.4g} % "
             "between {} ({})",
             caller, total, 100.0 * LIMIT, 100.0 * most, buffer, remedy);
}

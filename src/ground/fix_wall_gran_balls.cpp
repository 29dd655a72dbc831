/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Fixed balls as a wall. They are no atoms: made and sorted into plan cells where moving balls come
   near, listed for these when LAMMPS rebuilds its neighbor list, so that a step costs what the
   contacts cost, and a rank holds what its own balls need, whatever the size of the terrain. */

#include "fix_wall_gran_balls.h"

#include "atom.h"
#include "ball_placement.h"
#include "contact_guards.h"
#include "error.h"
#include "inserted_balls.h"
#include "neighbor.h"
#include "pair_gran_restitution.h"
#include "style_argument.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace Slope;

static constexpr double SAME_SIZE = 1.0e-9;
static constexpr int MANY = 4;    // listed for each moving ball: most are out of its reach

/* ----------------------------------------------------------------------
   fix ID group wall/gran/balls TYPE DIAMETER surface|file ...
------------------------------------------------------------------------- */

FixWallGranBalls::FixWallGranBalls(LAMMPS *lmp, int narg, char **arg) :
    FixContactWall(lmp, narg, arg, 1), smaller_warned(false)
{
  if (narg < 6)
    error->all(FLERR, "{}: needs TYPE DIAMETER and surface or file, got {} arguments", caller,
               narg - 3);

  wall_type = atom_type_argument(lmp, caller + " type", arg[3]);
  diameter = positive_argument(lmp, caller + " diameter", arg[4]);
  radius = 0.5 * diameter;

  const double moving = BallPlacement::smallest_ball(lmp, groupbit);
  placement.reset(new BallPlacement(lmp, caller, diameter, moving, narg - 5, &arg[5], true));
  balls.reset(
      new BallTiles(placement->tiles(), diameter, [this](int tile, std::vector<PlacedBall> &made) {
        placement->make(tile, made);
      }));
  types = {wall_type};
  type_of_zone = {0};
  for (int type : placement->zone_types()) {
    const auto known = std::find(types.begin(), types.end(), type);
    type_of_zone.push_back(static_cast<int>(known - types.begin()));
    if (known == types.end()) types.push_back(type);
  }
  other_types.assign(types.begin() + 1, types.end());

  size_vector = 3;
  for (int k = 0; k < 3; k++) force_mine[k] = force_all[k] = 0.0;
  force_ready = 0;
  keep_by_atom();
}

/* ---------------------------------------------------------------------- */

double FixWallGranBalls::deepest_overlap(const double *x, double r) const
{
  double deepest = 0.0;
  balls->visit_near(x, r + radius, [&](int, double d2) {
    deepest = std::max(deepest, r + radius - std::sqrt(d2));
  });
  return deepest;
}

/* ---------------------------------------------------------------------- */

int FixWallGranBalls::setmask()
{
  return PRE_EXCHANGE | POST_NEIGHBOR | POST_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixWallGranBalls::init()
{
  FixContactWall::init();
  placement->check_regions();
  check_sizes();
}

/* ----------------------------------------------------------------------
   were the balls that this ground was made for the smallest?
------------------------------------------------------------------------- */

void FixWallGranBalls::check_sizes()
{
  const double smallest = placement->smallest();
  if (smallest == 0.0 || smaller_warned) return;
  double moving = BallPlacement::smallest_ball(lmp, groupbit);
  for (const InsertedBalls &later : inserted_balls(lmp))
    if ((later.mask & groupbit) && (moving == 0.0 || 2.0 * later.radius_min < moving))
      moving = 2.0 * later.radius_min;
  if (moving == 0.0 || moving > smallest * (1.0 - SAME_SIZE)) return;
  pair->guards.say(
      fmt::format("{}: balls of diameter {} may pass between these, placed for {} and larger, on "
                  "steep ground: define the fix after the balls, or with smallest {}",
                  caller, moving, smallest, moving));
  smaller_warned = true;
}

/* ---------------------------------------------------------------------- */

const BallGround &FixWallGranBalls::ground() const
{
  return placement->on();
}

/* ----------------------------------------------------------------------
   a list for each type of the fixed balls and each of the moving ones
------------------------------------------------------------------------- */

size_t FixWallGranBalls::list_of(int which, int moving) const
{
  return static_cast<size_t>(which) * (atom->ntypes + 1) + moving;
}

ContactLaw FixWallGranBalls::law_of_list(size_t k) const
{
  return law_of(static_cast<int>(k % (atom->ntypes + 1)), types[k / (atom->ntypes + 1)]);
}

/* ----------------------------------------------------------------------
   a contact's key: the number of the fixed ball, which stays the same when its index does not
------------------------------------------------------------------------- */

void FixWallGranBalls::key_of(int ball, double *key) const
{
  *key = static_cast<double>(balls->number(ball));
}

std::string FixWallGranBalls::name_of(int ball) const
{
  const Vector &at = balls->places()[ball];
  return fmt::format("the fixed ball at {:.6g} {:.6g} {:.6g},", at.x, at.y, at.z);
}

FixContactWall::Depth FixWallGranBalls::depth_of(const ContactEntry &e, double overlap) const
{
  return {overlap, std::min(atom->radius[e.i], radius)};
}

// a history for each entry of new lists: the stored one for a contact that is known

void FixWallGranBalls::give_histories()
{
  size_t total = 0;
  for (const ContactList &l : lists) total += l.entries.size();
  histories.assign(total * HISTORY, 0.0);
  double *next = histories.data();
  for (ContactList &l : lists)
    for (size_t k = 0; k < l.entries.size(); k++, next += HISTORY) {
      const ContactList::Entry &e = l.entries[k];
      l.histories[k] = next;
      for (int n = 0; n < records.contacts(e.i); n++)
        if (*records.key(e.i, n) == static_cast<double>(balls->number(e.j))) {
          std::copy_n(records.history(e.i, n), HISTORY, next);
          l.set_history(k);
        }
    }
}

/* ----------------------------------------------------------------------
   list the fixed balls near each moving ball, with the history of those that touch
   LAMMPS rebuilds when a ball has moved by half the skin; fixed balls do not move
------------------------------------------------------------------------- */

void FixWallGranBalls::post_neighbor()
{
  balls->drop_unused();
  lists.resize(types.size() * (atom->ntypes + 1));
  for (ContactList &l : lists) l.clear(true, false);

  double **x = atom->x;
  const double *r = atom->radius;
  const int *mask = atom->mask, *type = atom->type;
  const double beyond = radius + 0.5 * neighbor->skin;
  try {
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(mask[i] & groupbit)) continue;
      balls->visit_near(x[i], r[i] + beyond, [&](int k, double) {
        ContactList &l = lists[list_of(type_of_zone[balls->zone(k)], type[i])];
        l.add(i, k, nullptr, false, r[i], radius, atom->rmass[i], 1.0);
      });
    }
    placement->forget();
    give_histories();
  } catch (std::bad_alloc &) {    // on this rank alone
    error->one(FLERR, "{}: not enough memory for the fixed balls near {} balls: {}", caller,
               atom->nlocal, "larger fixed balls, or more ranks");
  } catch (std::length_error &e) {
    error->one(FLERR, "{}: must be fewer than {}: larger fixed balls, or more ranks", caller,
               e.what());
  }
  for (ContactList &l : lists)
    if (pair->sizes_vary)
      l.let_vary();
    else if (l.entries.size() > static_cast<size_t>(MANY) * atom->nlocal)
      l.watch(atom->nlocal);
}

/* ---------------------------------------------------------------------- */

void FixWallGranBalls::setup(int)
{
  apply(true);
}

void FixWallGranBalls::post_force(int)
{
  apply(false);
}

/* ----------------------------------------------------------------------
   contact forces of the fixed balls on the moving ones
------------------------------------------------------------------------- */

void FixWallGranBalls::apply(bool repeat)
{
  const MovingBalls moving = pair->moving_balls();
  const FixedPartners fixed = partners();
  const ContactLaw *law = nullptr;
  auto visit = [&](int i, int, const Vector &f, const Vector &d) {
    pair->works.add(i, ContactWorks::FIXED, atom->radius[i], radius, *law, 1.0, f, d);
  };
  ContactTally tally = pair->works.wanted ? tally_of(visit) : ContactTally();

  for (size_t k = 0; k < lists.size(); k++) {
    ContactList &l = lists[k];
    if (l.entries.empty()) continue;
    const ContactLaw its = law_of_list(k);
    law = &its;
    l.apply(its, update->dt, repeat, moving, fixed, &tally);
  }

  force_mine[0] = -tally.force.x;
  force_mine[1] = -tally.force.y;
  force_mine[2] = -tally.force.z;
  force_ready = 0;
  contacts_in_lists = true;
}

/* ----------------------------------------------------------------------
   number of fixed balls; total force on them
------------------------------------------------------------------------- */

double FixWallGranBalls::compute_scalar()
{
  return static_cast<double>(placement->count());
}

double FixWallGranBalls::compute_vector(int n)
{
  if (!force_ready) {
    MPI_Allreduce(force_mine, force_all, 3, MPI_DOUBLE, MPI_SUM, world);
    force_ready = 1;
  }
  return force_all[n];
}

/* ---------------------------------------------------------------------- */

double FixWallGranBalls::memory_usage()
{
  return FixContactWall::memory_usage() + balls->memory_usage() +
      histories.capacity() * sizeof(double);
}

/* ----------------------------------------------------------------------
   restart file: what identifies the balls
------------------------------------------------------------------------- */

void FixWallGranBalls::archive_wall(Slope::Archive &archive)
{
  std::vector<double> marks = placement->fingerprint();
  archive.list("marks_of_the_balls", marks);
  const std::string why = archive.reads() ? placement->unlike(marks) : "";
  if (!why.empty())
    throw std::runtime_error(
        fmt::format("the restart file was written with other fixed balls ({})", why));
}

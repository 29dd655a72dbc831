/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The frame of the run moves with the ground: every ball of the group gets the ground's acceleration
   with the opposite sign. The velocities are kicked at both half steps of velocity Verlet by the
   integral over that half step, so that they add up to the ground's velocity whatever the step. */

#include "fix_ground_motion.h"

#include "inserted_balls.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "rank_zero.h"
#include "requirements.h"
#include "restart_archive.h"
#include "style_argument.h"
#include "style_name.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::MotionRecord;

static const std::string CALLER = "Fix ground/motion ";
static constexpr int VERSION = 2;          // of what restart files hold
static constexpr double DOUBTED = 50.0;    // m/s2, more than any ground has moved with

/* ----------------------------------------------------------------------
   fix ID group ground/motion FILE keyword value ...
------------------------------------------------------------------------- */

FixGroundMotion::FixGroundMotion(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), scale(1.0), start(0.0), kicked(0), placed(0),
    frozen(0), ground{0.0, 0.0, 0.0}, last_kick{0.0, 0.0, 0.0}, work(0.0)
{
  if (narg < 4) error->all(FLERR, "Fix ground/motion needs FILE with lines t ax ay az");
  file = arg[3];
  read_keywords(narg, arg);
  read_record();
  announce();

  vector_flag = 1;
  size_vector = 9;
  global_freq = 1;
  extvector = 0;
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::read_keywords(int narg, char **arg)
{
  for (KeywordReader word(lmp, "Fix ground/motion", narg - 4, arg + 4); word.next();)
    if (word.is("scale", "S"))
      scale = word.number();
    else if (word.is("start", "T"))
      start = word.number();
    else
      word.unknown();
}

/* ----------------------------------------------------------------------
   one rank reads; its errors end the run on all ranks
------------------------------------------------------------------------- */

void FixGroundMotion::read_record()
{
  std::vector<MotionRecord::Point> points;
  on_rank_zero(lmp, "Fix ground/motion", [&]() {
    points = MotionRecord::read(file, scale, in_si(lmp)).list();
  });
  broadcast(world, points);
  record = MotionRecord(points, scale);
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::announce() const
{
  if (comm->me > 0) return;
  double v[3], d[3];
  record.velocity(record.end(), v);
  record.displacement(record.end(), d);
  utils::logmesg(
      lmp,
      "Fix ground/motion {}: {} points from {:g} to {:g}, largest acceleration {:.6g}; the "
      "ground ends with velocity {:.4g} {:.4g} {:.4g}, displacement {:.4g} {:.4g} {:.4g}\n",
      id, record.list().size(), record.begin(), record.end(), record.peak(), v[0], v[1], v[2], d[0],
      d[1], d[2]);
  if (record.peak() > DOUBTED && in_si(lmp))
    error->warning(
        FLERR,
        "Fix ground/motion {}: the largest acceleration should be at most {:g} m/s2, got {:.6g} "
        "from {}: numbers in gal need scale 0.01",
        id, DOUBTED, record.peak(), file);
}

/* ---------------------------------------------------------------------- */

int FixGroundMotion::setmask()
{
  // PRE_FORCE for setup_pre_force() alone
  return INITIAL_INTEGRATE | POST_INTEGRATE | FINAL_INTEGRATE | PRE_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::init()
{
  require_run(lmp, "Fix ground/motion");

  kicked = placed = frozen = 0;
  bool before = true;
  for (const Fix *fix : compat::fixes(lmp)) {
    if (fix == this) before = false;
    if (Slope::is_style(fix->style, "freeze")) frozen |= fix->groupbit;
    if (!fix->time_integrate || !utils::strmatch(fix->style, "^nve")) continue;
    kicked |= fix->groupbit;
    if (before) placed |= fix->groupbit;
  }
  if (update->whichflag == 1) check_integrators();
}

/* ----------------------------------------------------------------------
   rigid bodies and balls on a prescribed path are not affected: warn of them
------------------------------------------------------------------------- */

void FixGroundMotion::check_integrators()
{
  bigint mine[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    mine[0]++;
    if (!follows(atom->mask[i]) && !(atom->mask[i] & frozen)) mine[1]++;
  }
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);
  const bigint others = balls_beside_empty(lmp, groupbit, [](int) {
    return true;
  });
  if (others > 0 && comm->me == 0)
    error->warning(FLERR,
                   "Fix ground/motion {}: the group should have balls, got none of {}: nothing is "
                   "shaken; group {} has the balls that were there when it was defined",
                   id, others, group->names[igroup]);
  if (all[1] > 0 && comm->me == 0)
    error->warning(
        FLERR,
        "Fix ground/motion {}: {} of {} balls of the group are not integrated by fix nve/sphere, "
        "and are not shaken",
        id, all[1], all[0]);
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::setup_pre_force(int)
{
  if (update->whichflag != 1) return;
  const bool goes_on = clock.begin(update->ntimestep, update->dt);
  record.velocity(clock.now() - start, ground);
  if (!goes_on) std::fill(last_kick, last_kick + 3, 0.0);
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::take_back_kick()
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int c = 0; c < 3 && follows(atom->mask[i]); c++) atom->v[i][c] -= last_kick[c];
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::initial_integrate(int)
{
  kick_until(clock.at(update->ntimestep - 1) + 0.5 * clock.dt(), true);
}

/* ----------------------------------------------------------------------
   Work of the motion in this step, for the energy guard: both its kicks on the velocities in its
   middle, with which the balls move, and what the kicks put into a free ball on top of that. What
   each kick changes in the energy of motion is something else: on a ball that friction holds these
   changes add up, although nothing moves.
------------------------------------------------------------------------- */

void FixGroundMotion::post_integrate()
{
  double next[3], k[3], rest = 0.0;
  record.velocity(clock.at(update->ntimestep) - start, next);
  for (int c = 0; c < 3; c++) {
    const double second = ground[c] - next[c];
    k[c] = last_kick[c] + second;
    rest += 0.5 * (second * second - last_kick[c] * last_kick[c]);
  }
  if (k[0] == 0.0 && k[1] == 0.0 && k[2] == 0.0) return;

  double done = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!follows(atom->mask[i])) continue;
    const double *v = atom->v[i];
    const double mass = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    done += mass * (v[0] * k[0] + v[1] * k[1] + v[2] * k[2] + rest);
  }
  work += done * force->mvv2e;
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::final_integrate()
{
  kick_until(clock.at(update->ntimestep), false);
  clock.pass(update->ntimestep);
}

/* ----------------------------------------------------------------------
   First half: balls that an integrator earlier in the deck has moved already are moved by what the
   kick adds, so that the order of the fixes does not matter.
------------------------------------------------------------------------- */

void FixGroundMotion::kick_until(double time, bool first_half)
{
  double now[3];
  record.velocity(time - start, now);
  for (int c = 0; c < 3; c++) last_kick[c] = ground[c] - now[c];
  std::copy(now, now + 3, ground);
  const double *k = last_kick;
  if (k[0] == 0.0 && k[1] == 0.0 && k[2] == 0.0) return;

  double **const x = atom->x, **const v = atom->v;
  const double dt = update->dt;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!follows(atom->mask[i])) continue;
    for (int c = 0; c < 3; c++) v[i][c] += k[c];
    if (!first_half || !(atom->mask[i] & placed)) continue;
    for (int c = 0; c < 3; c++) x[i][c] += dt * k[c];
  }
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::reset_dt()
{
  // between runs, where newer LAMMPS calls this too, the next set-up sees the change
  if (update->whichflag == 1) clock.change_step_size(update->ntimestep, update->dt);
}

/* ----------------------------------------------------------------------
   acceleration, velocity and displacement of the ground
------------------------------------------------------------------------- */

double FixGroundMotion::compute_vector(int k)
{
  const bool running = update->whichflag == 1 && clock.started();
  const double t = (running ? clock.at(update->ntimestep) : clock.now()) - start;
  double values[3];
  if (k < 3)
    record.acceleration(t, values);
  else if (k < 6)
    record.velocity(t, values);
  else
    record.displacement(t, values);
  return values[k % 3];
}

/* ----------------------------------------------------------------------
   for the energy guard of the pair style: J, on this rank
------------------------------------------------------------------------- */

void *FixGroundMotion::extract(const char *name, int &dim)
{
  dim = 0;
  return strcmp(name, "work") == 0 ? &work : nullptr;
}

/* ---------------------------------------------------------------------- */

void FixGroundMotion::archive(Slope::Archive &archive)
{
  archive.same(
      "motion",
      {{"points", static_cast<double>(record.list().size())},
       {"begin", record.begin()},
       {"end", record.end()},
       {"checksum", record.checksum()},
       {"scale", scale},
       {"start", start}},
      [](const double *k) {
        return fmt::format("{:.0f} points from {:g} to {:g} (sum {:.10g}), scale {:g}, start {:g}",
                           k[0], k[1], k[2], k[3], k[4], k[5]);
      },
      ": another motion needs another fix ID");
  clock.archive(archive);
  archive.numbers("last_kick", last_kick, 3);
}

void FixGroundMotion::write_restart(FILE *fp)
{
  Slope::Archive to(style, VERSION);
  archive(to);
  write_archive(lmp, fp, CALLER + id, to);
}

void FixGroundMotion::restart(char *buffer)
{
  read_archive(lmp, CALLER + id, [&]() {
    Slope::Archive from(style, VERSION, buffer);
    archive(from);
  });
}

/* ---------------------------------------------------------------------- */

double FixGroundMotion::memory_usage()
{
  return 3.0 * record.list().size() * sizeof(MotionRecord::Point);
}

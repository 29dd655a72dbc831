/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What crosses a line: the path of every ball that can reach it is tested in every step against the
   vertical plane over the line, right after the balls have moved, before LAMMPS deletes those that left
   the box. Which can is found whenever the neighbor lists are built. */

#include "fix_control_line.h"

#include "atomic_file.h"
#include "constants.h"
#include "fix_deposit_grid.h"
#include "inserted_balls.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "rank_zero.h"
#include "region_surface.h"
#include "requirements.h"
#include "restart_archive.h"
#include "slope_version.h"
#include "style_argument.h"
#include "yaml_text.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::CrossingLog;
using Slope::PlanLine;

static const std::string CALLER = "Fix control/line ";
static constexpr int VERSION = 4;    // of what restart files hold

enum { X, Y, Z };

/* ----------------------------------------------------------------------
   fix ID group control/line FILE deposit ID output PREFIX lower L
------------------------------------------------------------------------- */

FixControlLine::FixControlLine(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), lower(0.0), deposit(nullptr)
{
  if (narg < 4) error->all(FLERR, "Fix control/line needs FILE deposit ID output PREFIX");
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag)
    error->all(FLERR, "Fix control/line requires balls: atom_style must be sphere, got {}",
               atom->atom_style);
  file = arg[3];
  read_keywords(narg, arg);
  read_line();

  nevery = 1;
  std::fill(result, result + NRESULT, 0.0);
  vector_flag = 1;
  size_vector = NRESULT;
  global_freq = 1;
  extvector = -1;
  extlist = new int[NRESULT];
  for (int k = 0; k < NRESULT; k++) extlist[k] = k < 2;
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

FixControlLine::~FixControlLine()
{
  delete[] extlist;
}

/* ---------------------------------------------------------------------- */

void FixControlLine::read_keywords(int narg, char **arg)
{
  for (KeywordReader word(lmp, "Fix control/line", narg - 4, arg + 4); word.next();)
    if (word.is("deposit", "ID"))
      deposit_id = word.text();
    else if (word.is("lower", "L"))
      lower = word.number();
    else if (word.is("output", "PREFIX"))
      prefix = word.text();
    else
      word.unknown();
  if (prefix.empty()) error->all(FLERR, "Fix control/line keyword output is missing");
}

/* ----------------------------------------------------------------------
   one rank reads; its errors end the run on all ranks
------------------------------------------------------------------------- */

void FixControlLine::read_line()
{
  std::vector<double> xy;
  on_rank_zero(lmp, "Fix control/line", [&]() {
    xy = PlanLine::read(file, in_si(lmp)).xy;
  });
  broadcast(world, xy);
  line = PlanLine(xy);
}

/* ---------------------------------------------------------------------- */

int FixControlLine::setmask()
{
  return POST_INTEGRATE | END_OF_STEP | POST_RUN;
}

/* ---------------------------------------------------------------------- */

void FixControlLine::init()
{
  for (Fix *fix : compat::fixes_of_style(lmp, "control/line"))
    if (fix != this && static_cast<FixControlLine *>(fix)->prefix == prefix)
      error->all(FLERR, "Fix control/line output must differ from that of fix {}, got {}", fix->id,
                 prefix);
  require_run(lmp, "Fix control/line");
  find_deposit();
  ground.reset(
      new RegionSurface(lmp, "Fix control/line", deposit->terrain().c_str(), RegionSurface::UPPER));
  check_line();
  on_rank_zero(lmp, "Fix control/line", [this]() {
    Slope::FileSet::probe({prefix + ".line.csv", prefix + ".line.yaml"});
    lock.take(prefix, lmp);
  });
}

/* ----------------------------------------------------------------------
   the fix that knows the ground and the volume that a ball represents; the only one needs no name
------------------------------------------------------------------------- */

void FixControlLine::find_deposit()
{
  const std::vector<Fix *> all = compat::fixes_of_style(lmp, "deposit/grid");
  Fix *chosen = deposit_id.empty() && all.size() == 1 ? all[0] : nullptr;
  for (Fix *fix : all)
    if (deposit_id == fix->id) chosen = fix;
  deposit = static_cast<FixDepositGrid *>(chosen);
  if (!chosen && deposit_id.empty())
    error->all(FLERR,
               "Fix control/line {} needs deposit ID, the fix deposit/grid that has the bulk "
               "factor, where "
               "there is not exactly one, got {}",
               id, all.size());
  if (!chosen)
    error->all(FLERR, "Fix control/line {} deposit must be the ID of a fix deposit/grid, got {}",
               id, deposit_id);
}

/* ---------------------------------------------------------------------- */

void FixControlLine::check_line() const
{
  for (size_t k = 0; k < line.xy.size(); k += 2) {
    const double x = line.xy[k], y = line.xy[k + 1];
    if (x < ground->xlo || x > ground->xhi || y < ground->ylo || y > ground->yhi)
      error->all(
          FLERR,
          "Fix control/line {}: points of {} must lie in the terrain, x {:.8g} to {:.8g}, y {:.8g} "
          "to {:.8g}, got {:.8g} {:.8g}",
          id, file, ground->xlo, ground->xhi, ground->ylo, ground->yhi, x, y);
  }
}

/* ---------------------------------------------------------------------- */

void FixControlLine::setup(int /*vflag*/)
{
  set_up = update->ntimestep;
  clock.begin(update->ntimestep, update->dt);
  const bigint others = balls_beside_empty(lmp, groupbit, [](int) {
    return true;
  });
  if (others > 0 && comm->me == 0)
    error->warning(FLERR,
                   "Fix control/line {}: the group should have balls, got none of {}: group {} has "
                   "the balls that were there when it was defined",
                   id, others, group->names[igroup]);
  skin = neighbor->skin;
  watch();
  remember();
}

void FixControlLine::end_of_step()
{
  require_step(lmp, "Fix control/line", set_up);
  clock.pass(update->ntimestep);
  if (neighbor->ago == 0 || (some && !lists_follow_motion())) watch();
  remember();
}

void FixControlLine::reset_dt()
{
  // between runs, where newer LAMMPS calls this too, the next set-up sees the change
  if (update->whichflag == 1) clock.change_step_size(update->ntimestep, update->dt);
}

/* ----------------------------------------------------------------------
   whether lists are built anew in the step in which any ball has moved by half the skin
------------------------------------------------------------------------- */

bool FixControlLine::lists_follow_motion() const
{
  return neighbor->every == 1 && neighbor->delay == 0 && neighbor->dist_check &&
      !neighbor->build_once && !neighbor->includegroup;
}

/* ----------------------------------------------------------------------
   A ball moves by half the skin at most before the lists are built anew, but for the step in which that
   is found. One that moves by less than half the skin in that step, too, cannot reach a line that is
   farther than the skin away. Those that are fast now are watched wherever they are.
------------------------------------------------------------------------- */

void FixControlLine::watch()
{
  static constexpr double ROUNDING = 1.0e-12;
  number = atom->nlocal;
  some = lists_follow_motion() && neighbor->ago == 0 && skin > 0.0;
  farthest = 0.5 * skin;
  const double reach = skin + ROUNDING * line.largest();
  const double fast = 0.5 * farthest / update->dt;
  watched.clear();
  for (int i = 0; i < number; i++) {
    double place[3];
    domain->unmap(atom->x[i], atom->image[i], place);
    const double *v = atom->v[i];
    if (!some || line.is_near(place, reach) ||
        v[X] * v[X] + v[Y] * v[Y] + v[Z] * v[Z] > fast * fast)
      watched.push_back(i);
  }
  places.resize(3 * watched.size());
}

/* ---------------------------------------------------------------------- */

void FixControlLine::remember()
{
  for (size_t k = 0; k < watched.size(); k++)
    domain->unmap(atom->x[watched[k]], atom->image[watched[k]], &places[3 * k]);
}

/* ---------------------------------------------------------------------- */

void FixControlLine::post_integrate()
{
  if (atom->nlocal != number)
    error->one(
        FLERR,
        "Fix control/line {}: the number of balls must not change between two steps without a "
        "set-up, which pre no leaves out, got {} after {}",
        id, atom->nlocal, number);
  for (size_t k = 0; k < watched.size(); k++) test(watched[k], &places[3 * k]);
  if (some) test_fast();
}

/* ---------------------------------------------------------------------- */

void FixControlLine::test(int i, const double *from)
{
  if (!(atom->mask[i] & groupbit)) return;
  double to[3];
  domain->unmap(atom->x[i], atom->image[i], to);
  found.clear();
  line.cross(from, to, found);
  for (const PlanLine::Crossing &crossing : found) note(i, from, to, crossing);
}

/* ----------------------------------------------------------------------
   A ball that was slow when the lists were built and now moves too far in one step, thrown by a contact
   that has gone wrong: where it was follows from its velocity. One comparison for each component
   of all velocities, without branches, tells that there is none.
------------------------------------------------------------------------- */

void FixControlLine::test_fast()
{
  if (number == 0) return;
  const double limit = farthest / update->dt, *all = atom->v[0];
  const double one = limit / sqrt(3.0);
  int any = 0;
  for (size_t k = 0; k < 3 * (size_t) number; k++) any |= std::fabs(all[k]) > one;
  if (!any) return;

  for (int i = 0; i < number; i++) {
    const double *v = atom->v[i];
    if (v[X] * v[X] + v[Y] * v[Y] + v[Z] * v[Z] <= limit * limit) continue;
    if (std::binary_search(watched.begin(), watched.end(), i)) continue;
    double from[3];
    domain->unmap(atom->x[i], atom->image[i], from);
    for (int c = 0; c < 3; c++) from[c] -= update->dt * v[c];
    test(i, from);
  }
}

/* ----------------------------------------------------------------------
   velocities are those in the middle of the step, with which the ball has moved
------------------------------------------------------------------------- */

void FixControlLine::note(int i, const double *from, const double *to, const PlanLine::Crossing &c)
{
  const double *v = atom->v[i], *w = atom->omega[i], r = atom->radius[i];
  const double square = v[X] * v[X] + v[Y] * v[Y] + v[Z] * v[Z];
  const double spin = w[X] * w[X] + w[Y] * w[Y] + w[Z] * w[Z];
  CrossingLog::Event e;
  e.time = clock.at(update->ntimestep - 1) + c.passed * update->dt;
  e.step = (double) update->ntimestep;
  e.tag = (double) atom->tag[i];
  e.direction = c.direction;
  e.along = c.along;
  e.x[X] = c.x;
  e.x[Y] = c.y;
  e.x[Z] = from[Z] + c.passed * (to[Z] - from[Z]);
  std::string changed;
  if (!ground->stands(changed))    // of a run with pre no
    error->one(FLERR, "Fix control/line {}: region {} must not change before the run ends", id,
               changed);
  double z;
  e.height = ground->height(c.x, c.y, z) ? e.x[Z] - z + lower
                                         : std::numeric_limits<double>::quiet_NaN();
  std::copy(v, v + 3, e.v);
  e.speed = sqrt(square);
  e.energy = 0.5 * atom->rmass[i] * (square + 0.4 * r * r * spin) * force->mvv2e;
  e.volume = 4.0 / 3.0 * Slope::PI * r * r * r * deposit->bulk();
  e.diameter = 2.0 * r;
  fresh.push_back(e);
}

/* ----------------------------------------------------------------------
   collective: the crossings of all ranks go to rank 0, and the results to all
------------------------------------------------------------------------- */

void FixControlLine::collect()
{
  int mine = !fresh.empty(), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return;

  const std::vector<CrossingLog::Event> all = gather_records(world, fresh);
  fresh.clear();
  if (comm->me == 0) {
    log.events.insert(log.events.end(), all.begin(), all.end());
    log.sort();
    const CrossingLog::Largest most = log.quantile(1.0);
    const double values[NRESULT] = {log.way(1).volume, log.way(-1).volume, most.speed, most.height,
                                    most.energy};
    std::copy(values, values + NRESULT, result);
  }
  MPI_Bcast(result, NRESULT, MPI_DOUBLE, 0, world);
}

/* ---------------------------------------------------------------------- */

double FixControlLine::compute_vector(int k)
{
  collect();
  return result[k];
}

/* ---------------------------------------------------------------------- */

void FixControlLine::post_run()
{
  if (update->whichflag == 1) write_files();
}

/* ---------------------------------------------------------------------- */

void FixControlLine::write_files()
{
  collect();
  if (comm->me == 0 && log.main_direction() < 0)
    error->warning(FLERR,
                   "Fix control/line {}: more volume crossed back than forward, {:.1f} m3 against "
                   "{:.1f}: largest values and quantiles are those of the crossings back; turn the "
                   "line round, {}, if it was drawn against the motion",
                   id, log.way(-1).volume, log.way(1).volume, file);
  on_rank_zero(lmp, "Fix control/line", [this]() {
    Slope::FileSet files;
    files.add(prefix + ".line.csv").write(log.csv());
    files.add(prefix + ".line.yaml").write(summary());
    files.commit();
  });
}

/* ---------------------------------------------------------------------- */

std::string FixControlLine::summary() const
{
  using namespace Slope::yaml;
  std::string s = "# fix control/line of the SLOPE package for LAMMPS; units of the run\n";
  Slope::yaml::line(s, "slope_version", quoted(SLOPE_VERSION));
  Slope::yaml::line(s, "lammps_version", quoted(lmp->version));
  Slope::yaml::line(s, "fix", quoted(id));
  Slope::yaml::line(s, "step", std::to_string(update->ntimestep));
  Slope::yaml::line(s, "time", real(clock.at(update->ntimestep)));
  Slope::yaml::line(s, "line", quoted(file));
  Slope::yaml::line(s, "length", real(line.length()));
  Slope::yaml::line(s, "deposit", quoted(deposit->id));
  Slope::yaml::line(s, "bulk_factor", real(deposit->bulk()));
  return s + log.yaml();
}

/* ----------------------------------------------------------------------
   collective; rank 0 writes
------------------------------------------------------------------------- */

void FixControlLine::archive(Slope::Archive &archive, std::vector<CrossingLog::Event> &events)
{
  archive.same(
      "line",
      {{"numbers_of_the_line", (double) line.xy.size()},
       {"length", line.length()},
       {"xlo", line.xlo},
       {"checksum", line.checksum()},
       {"lower", lower}},
      [](const double *k) {
        return fmt::format("{:.0f} points, length {:.8g} (sum {:.10g}), lower {:g}", 0.5 * k[0],
                           k[1], k[3], k[4]);
      },
      ": another line, or another direction, needs another fix ID");
  clock.archive(archive);
  archive.records("crossings", events);
}

void FixControlLine::write_restart(FILE *fp)
{
  collect();
  Slope::Archive to(style, VERSION);
  archive(to, log.events);
  write_archive(lmp, fp, CALLER + id, to);
}

void FixControlLine::restart(char *buffer)
{
  read_archive(lmp, CALLER + id, [&]() {
    Slope::Archive from(style, VERSION, buffer);
    archive(from, fresh);    // collect() brings them, and the results
  });
  log.events.clear();
  if (comm->me > 0) fresh.clear();
}

/* ---------------------------------------------------------------------- */

double FixControlLine::memory_usage()
{
  return (double) watched.capacity() * sizeof(int) + (double) places.capacity() * sizeof(double) +
      (double) (fresh.capacity() + log.events.capacity()) * sizeof(CrossingLog::Event);
}

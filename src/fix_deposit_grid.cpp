/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The deposit on a plan grid, binned in the run. Every rank bins its own balls in the small window
   of cells that they occupy; rank 0 alone holds the rasters and adds the windows up. */

#include "fix_deposit_grid.h"

#include "deposit_ground.h"
#include "lammps_compat.h"
#include "pair_gran_restitution.h"
#include "rank_zero.h"
#include "slope_version.h"

#include "comm.h"
#include "error.h"
#include "force.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <unistd.h>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::AtomicFile;
using Slope::DepositRasters;
using Slope::DepositSummary;
using Slope::DepositWindow;
using Slope::FileSet;
using Slope::MassLedger;
using Slope::PlanGrid;

static constexpr double PI = 3.14159265358979323846;
static constexpr double SIMPLE_CUBIC = 6.0 / PI;    // bulk volume / volume of a ball
static constexpr double DEGREE = PI / 180.0;
static constexpr double RESTART_FORMAT = 2.0;    // first number of what a restart file holds

enum {
  RELEASED,
  ON_GRID,
  OFF_GRID,
  LOST,
  RESIDUAL,
  CHANGE,
  FRONT,
  REACH,
  CENTROID,
  NLOST,
  FAST_SHARE
};
enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

FixDepositGrid::FixDepositGrid(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), options(lmp, narg, arg), balls(lmp, groupbit, options.bulk), released(),
    started(false), fresh(false), sampled(-1), present(0.0), warned(false), elapsed(0.0),
    offset(0.0), limit(0.0), limit_set(0.0)
{
  nevery = options.nevery;
  bins.set_grid(options.grid);

  const double ncells = (double) options.grid.n[X] * options.grid.n[Y];
  const double need = ncells * DepositRasters::BYTES_PER_CELL;
  const std::string caller =
      fmt::format("Fix deposit/grid: {:.0f} cells, they need {:.3g} GB of memory on one rank",
                  ncells, 1.0e-9 * need);
  on_rank_zero(lmp, caller, [&]() {
    // Linux gives more than there is, and kills who uses it
    const double have = (double) sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE);
    if (need > have)
      throw std::runtime_error(fmt::format("this machine has {:.3g} GB", 1.0e-9 * have));
    rasters.create(options.grid);
  });
  DepositGround(lmp, options.terrain).read(options.grid, rasters.base);

  std::fill(result, result + NRESULT, 0.0);
  result[CHANGE] = rasters.change;
  scalar_flag = vector_flag = 1;
  size_vector = NRESULT;
  global_freq = 1;
  extscalar = 1;
  extvector = -1;
  extlist = new int[NRESULT];
  for (int k = 0; k < NRESULT; k++) extlist[k] = k <= RESIDUAL || k == NLOST;
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

FixDepositGrid::~FixDepositGrid()
{
  delete[] extlist;
}

/* ---------------------------------------------------------------------- */

int FixDepositGrid::setmask()
{
  return PRE_EXCHANGE | END_OF_STEP | POST_RUN;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::init()
{
  for (Fix *fix : compat::fixes_of_style(lmp, "deposit/grid"))
    if (fix != this && static_cast<FixDepositGrid *>(fix)->options.prefix == options.prefix)
      error->all(FLERR, "Fix deposit/grid output must be another than that of fix {}, got {}",
                 fix->id, options.prefix);
  check_folder();
  sampled = -1;
  limit = timer->get_timeout_remain();    // fix halt ends a run as a time limit does
  limit_set = MPI_Wtime();

  // write_restart and others move the atoms to their ranks after init() and without a call of
  // ours, and then drop those outside of the box: what is outside now is looked at later

  settle_outside();
  ledger.begin_command(balls.outside(nullptr));
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::setup_pre_exchange()
{
  if (!started && update->whichflag == 1) start();
  settle_outside();
  pre_exchange();
}

/* ----------------------------------------------------------------------
   LAMMPS is about to send every ball to the rank that owns its place. A ball that is beyond a
   fixed side of the box has no owner and is deleted without a word.
------------------------------------------------------------------------- */

void FixDepositGrid::pre_exchange()
{
  if (started) ledger.lose(balls.outside(&ledger));
}

/* ----------------------------------------------------------------------
   balls that were outside when the last command began and are gone were lost in it
------------------------------------------------------------------------- */

void FixDepositGrid::settle_outside()
{
  if (started && ledger.in_command()) ledger.end_command(balls.outside(nullptr));
}

/* ----------------------------------------------------------------------
   first set-up: the mass as it is released
------------------------------------------------------------------------- */

void FixDepositGrid::start()
{
  const DepositRelease release(lmp, balls);
  released.mass = release.find();
  DepositGround(lmp, options.terrain).check(balls);
  if (!options.body.empty()) {
    released.body = release.body_volume(options.body, released.mass);
    balls.set_bulk(released.body / released.mass.solid);
    ledger.begin_command(balls.outside(nullptr));    // now that their volume is known
  }

  double z;
  released.volume = balls.volume();
  balls.farthest(released.mass.top, released.front, z);
  started = fresh = true;
  log_release();
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::log_release() const
{
  if (comm->me != 0) return;
  std::string factor = fmt::format("{:.6g}", balls.bulk());
  if (!options.body.empty())
    factor += fmt::format(" = region {} {:.10g} / balls {:.10g}, {:+.1f} % from 6/pi", options.body,
                          released.body, released.mass.solid,
                          100.0 * (balls.bulk() / SIMPLE_CUBIC - 1.0));
  utils::logmesg(lmp,
                 "Fix deposit/grid {}: {:.0f} balls released, bulk volume {:.10g}; {} x {} cells "
                 "of {:g}\n"
                 "Fix deposit/grid {}: bulk factor {}\n",
                 id, released.mass.number, released.volume, options.grid.n[X], options.grid.n[Y],
                 options.cell, id, factor);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::setup(int /*vflag*/)
{
  // first of all set-ups: where the balls lie now they arrived at time 0

  offset = elapsed - clock();
  sample(fresh);
  if (fresh) take_snapshot();
  fresh = false;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::end_of_step()
{
  sample(true);
  take_snapshot();
  if (options.nfreq > 0 && update->ntimestep % options.nfreq == 0) write_files("running");
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::post_run()
{
  if (update->whichflag != 1) return;
  write_files(reason());
  elapsed = now();
}

/* ----------------------------------------------------------------------
   fix halt and a time limit leave the loop before the last step, or in it, and look alike then,
   but a time limit takes its time
------------------------------------------------------------------------- */

std::string FixDepositGrid::reason() const
{
  if (update->ntimestep == update->laststep && !timer->is_timeout()) return "run completed";
  const bool limited = limit != 0.0 && MPI_Wtime() - limit_set >= limit;
  return limited || compat::fixes_of_style(lmp, "halt").empty() ? "time limit" : "halted";
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::compute_scalar()
{
  return compute_vector(ON_GRID);
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::compute_vector(int k)
{
  // between runs the deck may have done anything to the atoms since the last sample

  if (started && (sampled != update->ntimestep || update->whichflag == 0)) sample(false);
  return result[k];
}

/* ----------------------------------------------------------------------
   the deposit and the balance as they are now; record: also the maxima
------------------------------------------------------------------------- */

void FixDepositGrid::sample(bool record)
{
  const DepositBalls::Sums here = balls.bin(bins);
  double mine[8] = {here.number,
                    here.off_grid,
                    here.mass,
                    here.mass_x,
                    here.mass_y,
                    here.fast,
                    ledger.lost_here().number,
                    ledger.lost_here().volume};
  double all[8];
  MPI_Allreduce(mine, all, 8, MPI_DOUBLE, MPI_SUM, world);
  const DepositBalls::Sums sums = {all[0], all[1], all[2], all[3], all[4], all[5]};
  MassLedger::Mass gone;
  gone.number = all[6];
  gone.volume = all[7];
  ledger.take_here(gone);
  if (gone.number > 0.0 && ledger.must_log()) log_losses(ledger.lost.number - gone.number);

  double on_grid = add_windows(record);
  MPI_Bcast(&on_grid, 1, MPI_DOUBLE, 0, world);

  present = sums.number;
  result[RELEASED] = released.volume;
  result[ON_GRID] = on_grid;
  result[OFF_GRID] = sums.off_grid;
  result[LOST] = ledger.lost.volume;
  result[RESIDUAL] = ledger.residual(released.volume, on_grid, sums.off_grid);
  result[CHANGE] = rasters.change;
  result[NLOST] = ledger.lost.number;
  result[FAST_SHARE] = sums.fast / released.volume;

  // travel

  double z;
  const DepositRelease::Mass &start = released.mass;
  const bool any = balls.farthest(start.top, result[FRONT], z);
  result[REACH] = any ? atan2(start.top[Z] - z, result[FRONT]) / DEGREE : 0.0;
  result[CENTROID] =
      any ? hypot(sums.mass_x / sums.mass - start.x, sums.mass_y / sums.mass - start.y) : 0.0;

  sampled = update->ntimestep;
  if (std::fabs(result[RESIDUAL]) > MassLedger::BALANCE * released.volume && !warned)
    tell_balance();
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::tell_balance()
{
  warned = true;
  warn("the volume balance does not close at step {}: released {:.10g}, on the grid {:.10g}, off "
       "the "
       "grid {:.10g}, lost {:.10g}, residual {:.3g}: balls came or went other than by leaving the "
       "box",
       sampled, result[RELEASED], result[ON_GRID], result[OFF_GRID], result[LOST],
       result[RESIDUAL]);
}

/* ----------------------------------------------------------------------
   by all ranks: to the screen, the log and the summary
------------------------------------------------------------------------- */

template <typename... Args> void FixDepositGrid::warn(const char *format, const Args &...args)
{
  if (comm->me > 0) return;
  warnings.push_back(fmt::format("Fix deposit/grid {}: ", id) + fmt::format(format, args...));
  error->warning(FLERR, warnings.back());
}

/* ----------------------------------------------------------------------
   the first balls that were lost, one line each; before: number lost until the last sample
------------------------------------------------------------------------- */

void FixDepositGrid::log_losses(double before)
{
  std::vector<MassLedger::Loss> notes = ledger.take_notes();
  const int width = sizeof(MassLedger::Loss) / sizeof(double);
  int mine = width * (int) notes.size();
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int k = 1; k < comm->nprocs; k++) starts[k] = starts[k - 1] + counts[k - 1];
  std::vector<MassLedger::Loss> all((starts.back() + counts.back()) / width);
  MPI_Allgatherv(notes.data(), mine, MPI_DOUBLE, all.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, world);
  for (const std::string &line : ledger.lines(all, before)) warn("{}", line);
}

/* ----------------------------------------------------------------------
   all windows into the rasters of rank 0; returns, there, the volume on the grid
------------------------------------------------------------------------- */

double FixDepositGrid::add_windows(bool record)
{
  DepositWindow &mine = bins.window();
  int place[4] = {mine.first[X], mine.first[Y], mine.size[X], mine.size[Y]};
  if (comm->me != 0) {
    MPI_Send(place, 4, MPI_INT, 0, 0, world);
    MPI_Send(mine.values.data(), (int) mine.values.size(), MPI_DOUBLE, 0, 0, world);
    return 0.0;
  }

  rasters.start();
  rasters.add(mine, record, now(), options.motion);
  DepositWindow other;
  for (int rank = 1; rank < comm->nprocs; rank++) {
    MPI_Recv(place, 4, MPI_INT, rank, 0, world, MPI_STATUS_IGNORE);
    std::copy(place, place + 2, other.first);
    std::copy(place + 2, place + 4, other.size);
    other.clear();
    MPI_Recv(other.values.data(), (int) other.values.size(), MPI_DOUBLE, rank, 0, world,
             MPI_STATUS_IGNORE);
    rasters.add(other, record, now(), options.motion);
  }
  return rasters.finish(record);
}

/* ----------------------------------------------------------------------
   every window steps: how much of the mass went to another cell since the last time
------------------------------------------------------------------------- */

void FixDepositGrid::take_snapshot()
{
  if (update->ntimestep % options.window) return;
  if (comm->me == 0)
    rasters.take_snapshot(update->ntimestep, options.window, now(), released.volume);
  MPI_Bcast(&rasters.change, 1, MPI_DOUBLE, 0, world);
  result[CHANGE] = rasters.change;
}

/* ----------------------------------------------------------------------
   time of LAMMPS, before a change of the time step and since
------------------------------------------------------------------------- */

double FixDepositGrid::clock() const
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

/* ----------------------------------------------------------------------
   a folder that is not there ends the run before it begins, not at its end
------------------------------------------------------------------------- */

void FixDepositGrid::check_folder()
{
  on_rank_zero(lmp, "Fix deposit/grid", [this]() {
    AtomicFile(options.prefix + ".summary.yaml");    // opened beside, and removed
  });
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::write_files(const std::string &why)
{
  if (sampled != update->ntimestep) sample(false);

  DepositSummary about = summary(why);
  on_rank_zero(lmp, "Fix deposit/grid", [&]() {
    FileSet files;
    rasters.write(files, options.prefix,
                  options.series ? std::to_string(update->ntimestep) : std::string());
    about.largest = {rasters.thickness.zmax(), rasters.max_thickness.zmax(),
                     rasters.max_speed.zmax(), rasters.max_energy.zmax()};
    about.files = files.names();
    files.add(options.prefix + ".summary.yaml").write(about.text());
    files.commit();
  });
}

/* ----------------------------------------------------------------------
   collective: all but what the rasters hold
------------------------------------------------------------------------- */

DepositSummary FixDepositGrid::summary(const std::string &why) const
{
  const DepositRelease::Mass &mass = released.mass;
  DepositSummary s = DepositSummary();
  s.slope_version = SLOPE_VERSION;
  s.lammps_version = lmp->version;
  s.fix = id;
  s.step = update->ntimestep;
  s.time = now();
  s.dt = update->dt;
  s.ranks = comm->nprocs;
  s.reason = why;
  s.grid = options.grid;
  s.release = {mass.number, mass.solid, options.body, released.body, balls.bulk()};
  s.present = present;
  s.lost = ledger.lost.number;
  s.volume = {result[RELEASED], result[ON_GRID], result[OFF_GRID], result[LOST], result[RESIDUAL]};
  s.travel = {{mass.top[X], mass.top[Y], mass.top[Z]},
              released.front,
              result[CENTROID],
              {result[FRONT], result[REACH]},
              balls.quantiles(mass.top)};

  double moving;
  s.motion = balls.motion(options.motion, moving);
  s.motion.moving_share = present > 0.0 ? moving / (released.volume - ledger.lost.volume) : 0.0;
  s.motion.fast_share = s.motion.fast_volume / released.volume;
  s.change_rate = result[CHANGE];
  add_guards(s);
  return s;
}

/* ----------------------------------------------------------------------
   what the guards of the contacts found in this run, and all warnings so far
------------------------------------------------------------------------- */

void FixDepositGrid::add_guards(DepositSummary &s) const
{
  auto law = dynamic_cast<PairGranRestitution *>(force->pair_match("gran/restitution", 1));
  if (law) {
    const ContactGuards::Found found = law->guards.found();
    s.guards = {true, found.deepest, found.energy_growth, found.deep, found.dangerous_builds};
    s.warnings = law->guards.warnings;
  }
  s.warnings.insert(s.warnings.end(), warnings.begin(), warnings.end());
}

/* ----------------------------------------------------------------------
   collective; rank 0 writes. Only cells that the mass ever touched are in the file.
------------------------------------------------------------------------- */

void FixDepositGrid::write_restart(FILE *fp)
{
  settle_outside();
  if (started && (sampled != update->ntimestep || update->whichflag == 0)) sample(false);
  if (comm->me != 0) return;

  const Saved saved = {(double) started,
                       released,
                       balls.bulk(),
                       ledger.lost,
                       (double) ledger.nlogged,
                       update->whichflag == 1 ? now() : elapsed,
                       (double) rasters.snapshot_step,
                       rasters.snapshot_time,
                       rasters.change};
  const std::vector<double> cells = rasters.touched();
  const Key key = restart_key();
  const double ncells = cells.size() / DepositRasters::PER_CELL;
  const double bytes = sizeof(Key) + sizeof(Saved) + sizeof(double) * (1.0 + cells.size());
  if (bytes > MAXSMALLINT)
    error->one(FLERR, "Fix deposit/grid must have at most {} bytes in a restart file, got {:.0f}",
               MAXSMALLINT, bytes);
  const int size = (int) bytes;
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&key, sizeof(Key), 1, fp);
  fwrite(&saved, sizeof(Saved), 1, fp);
  fwrite(&ncells, sizeof(double), 1, fp);
  fwrite(cells.data(), sizeof(double), cells.size(), fp);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::restart(char *buffer)
{
  auto take = [&](void *to, size_t bytes) {
    memcpy(to, buffer, bytes);
    buffer += bytes;
  };

  Key key;
  take(&key, sizeof(Key));
  check_key(key);

  Saved saved;
  take(&saved, sizeof(Saved));
  started = saved.started;
  released = saved.released;
  balls.set_bulk(saved.bulk);
  ledger.lost = saved.lost;
  ledger.nlogged = (int) saved.nlogged;
  elapsed = saved.elapsed;
  rasters.snapshot_step = (bigint) saved.snapshot_step;
  rasters.snapshot_time = saved.snapshot_time;
  result[CHANGE] = rasters.change = saved.change;

  if (comm->me != 0) return;
  double ncells;
  take(&ncells, sizeof(double));
  for (double c = 0.0; c < ncells; c++) {
    double values[DepositRasters::PER_CELL];
    take(values, sizeof(values));
    rasters.restore(values);
  }
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::check_key(const Key &key) const
{
  const Key mine = restart_key();
  if (key.format != mine.format)
    error->all(
        FLERR,
        "Fix deposit/grid {} must have restart data of format {:.0f}, got {:.0f}: the file is "
        "of another version of SLOPE, which must continue it, or the run begins anew",
        id, mine.format, key.format);
  if (memcmp(&key, &mine, sizeof(Key)) == 0) return;
  auto text = [](const Key &k) {
    return fmt::format("cell {:.10g}, {:.0f} x {:.0f} cells from {:.10g} {:.10g}, bulk {}", k.cell,
                       k.nx, k.ny, k.xlo, k.ylo,
                       k.bulk > 0.0 ? fmt::format("{:.10g}", k.bulk) : "region");
  };
  error->all(FLERR, "Fix deposit/grid {} must have the grid of the restart file, {}; got {}", id,
             text(key), text(mine));
}

/* ---------------------------------------------------------------------- */

FixDepositGrid::Key FixDepositGrid::restart_key() const
{
  const PlanGrid &grid = options.grid;
  return {RESTART_FORMAT, grid.cell,  (double) grid.n[X], (double) grid.n[Y],
          grid.lo[X],     grid.lo[Y], options.bulk};
}

/* ----------------------------------------------------------------------
   LAMMPS' own granular pair styles take any fix deposit... for the one that inserts balls, and
   ask for their radius: there are none
------------------------------------------------------------------------- */

void *FixDepositGrid::extract(const char *name, int & /*itype*/)
{
  static double none = 0.0;
  return strcmp(name, "radius") == 0 ? &none : nullptr;
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::memory_usage()
{
  return (double) rasters.ncells() * (DepositRasters::BYTES_PER_CELL - sizeof(double)) +
      (double) bins.window().values.capacity() * sizeof(double);
}

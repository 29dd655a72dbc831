/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The deposit on a plan grid, binned in the run. Every rank bins its own balls; rank 0 gets the bins and
   has the rasters. */

#include "fix_deposit_grid.h"

#include "constants.h"
#include "deposit_ground.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "node_memory.h"
#include "pair_gran_restitution.h"
#include "rank_zero.h"
#include "requirements.h"

#include "comm.h"
#include "error.h"
#include "update.h"

#include <cmath>
#include <cstring>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::DepositBins;
using Slope::DepositRasters;
using Slope::MassLedger;
typedef DepositResults Result;

enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

FixDepositGrid::FixDepositGrid(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), options(lmp, narg, arg), balls(lmp, groupbit, options.bulk),
    losses(lmp, balls), report(lmp, id, options, balls), restart_data(lmp, options), results(),
    started(false), fresh(false), sampled(-1), warned(false), elapsed(0.0), offset(0.0)
{
  nevery = options.nevery;
  make_rasters();

  results.vector[Result::CHANGE] = rasters.change;
  scalar_flag = vector_flag = 1;
  size_vector = Result::NUMBER;
  global_freq = 1;
  extscalar = 1;
  extvector = -1;
  extlist = new int[Result::NUMBER];
  for (int k = 0; k < Result::NUMBER; k++) extlist[k] = Result::extensive(k);
  restart_global = 1;
}

/* ---------------------------------------------------------------------- */

FixDepositGrid::~FixDepositGrid()
{
  delete[] extlist;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::make_rasters()
{
  const double here = comm->me == 0 ? options.grid.ncells() : 0.0;
  check_node_memory(lmp, DepositRasters::MOST_BYTES_PER_CELL * here,
                    fmt::format("Fix deposit/grid cell {:g}: {} x {} cells", options.cell,
                                options.grid.n[X], options.grid.n[Y]),
                    "a larger cell or a smaller extent");
  bins.set_grid(options.grid);
  rasters.create(options.grid);
  std::vector<double> base = DepositGround(lmp, options.terrain).read(options.grid);
  on_rank_zero(lmp, "Fix deposit/grid", [&]() {
    rasters.set_base(std::move(base));
  });
}

/* ---------------------------------------------------------------------- */

int FixDepositGrid::setmask()
{
  return PRE_EXCHANGE | END_OF_STEP | POST_RUN;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::init()
{
  require_run(lmp, "Fix deposit/grid");
  for (Fix *fix : compat::fixes_of_style(lmp, "deposit/grid"))
    if (fix != this && static_cast<FixDepositGrid *>(fix)->options.prefix == options.prefix)
      error->all(FLERR, "Fix deposit/grid output must differ from that of fix {}, got {}", fix->id,
                 options.prefix);
  report.begin_run();
  sampled = -1;

  // this may be the init() of a command that drops balls outside of the box

  if (started) losses.end_command();
  losses.begin_command();
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::setup_pre_exchange()
{
  if (!started && update->whichflag == 1) start();
  if (started) losses.end_command();
  pre_exchange();
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::pre_exchange()
{
  if (started) losses.before_exchange();
}

/* ----------------------------------------------------------------------
   first set-up: the mass as it is released
------------------------------------------------------------------------- */

void FixDepositGrid::start()
{
  DepositRelease release(lmp, balls, options);
  DepositRelease::Released &released = results.released;
  released = release.find();
  if (!options.body.empty()) {
    balls.set_bulk(released.body / released.mass.solid);
    losses.begin_command();    // now that the volume of balls is known
  }
  released.volume = balls.volume();
  started = fresh = true;
  release.log(id, released);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::setup(int /*vflag*/)
{
  set_up = update->ntimestep;
  report.keep_guards();

  // first of all set-ups: where the balls lie now they arrived at time 0

  offset = elapsed - clock();
  sample(fresh);
  if (fresh) take_snapshot();
  fresh = false;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::end_of_step()
{
  require_step(lmp, "Fix deposit/grid", set_up);
  sample(true);
  take_snapshot();
  if (options.nfreq > 0 && update->ntimestep % options.nfreq == 0) write_files("running");
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::post_run()
{
  if (update->whichflag != 1) return;
  write_files(report.reason());
  elapsed = now();
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::compute_scalar()
{
  return compute_vector(Result::ON_GRID);
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::compute_vector(int k)
{
  // between runs the deck may have done anything to the atoms since the last sample

  if (started && (sampled != update->ntimestep || update->whichflag == 0)) sample(false);
  return results.vector[k];
}

/* ----------------------------------------------------------------------
   the deposit and the balance as they are now; record: also the maxima
------------------------------------------------------------------------- */

void FixDepositGrid::sample(bool record)
{
  const DepositBalls::Sums sums = balls.bin(bins);    // of all ranks
  for (const std::string &line : losses.add_up()) report.warn(line);

  const double released = results.released.volume;
  double *value = results.vector;
  results.present = sums.number;
  value[Result::RELEASED] = released;
  value[Result::ON_GRID] = add_bins(record);
  value[Result::OFF_GRID] = sums.off_grid;
  value[Result::LOST] = losses.lost.volume;
  value[Result::RESIDUAL] = losses.residual(released, value[Result::ON_GRID], sums.off_grid);
  value[Result::CHANGE] = rasters.change;
  value[Result::NLOST] = losses.lost.number;
  value[Result::FAST_SHARE] = sums.fast / released;
  find_travel(sums);
  sampled = update->ntimestep;
  check_balance();
}

/* ----------------------------------------------------------------------
   into the rasters; returns the volume on the grid
------------------------------------------------------------------------- */

double FixDepositGrid::add_bins(bool record)
{
  const double time = now();
  rasters.clear();
  take_records(world, bins.blocks().all(), [&](const DepositBins::Blocks::Block &block) {
    rasters.add(block, record, time, options.motion);
  });
  return of_rank_zero(rasters.finish(record));
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::of_rank_zero(double value) const
{
  MPI_Bcast(&value, 1, MPI_DOUBLE, 0, world);
  return value;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::find_travel(const DepositBalls::Sums &sums)
{
  const DepositRelease::Mass &from = results.released.mass;
  double *value = results.vector, z;
  const bool any = balls.farthest(from.top, value[Result::FRONT], z);
  value[Result::REACH] = any ? atan2(from.top[Z] - z, value[Result::FRONT]) / Slope::DEGREE : 0.0;
  value[Result::CENTROID] =
      any ? hypot(sums.mass_x / sums.mass - from.x, sums.mass_y / sums.mass - from.y) : 0.0;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::check_balance()
{
  const double *value = results.vector;
  if (warned || std::fabs(value[Result::RESIDUAL]) <= MassLedger::BALANCE * value[Result::RELEASED])
    return;
  warned = true;
  report.warn(fmt::format(
      "the volume balance does not close at step {}: released {:.10g}, on the grid {:.10g}, off "
      "the grid {:.10g}, lost {:.10g}, residual {:.3g}: balls were added or removed other than by "
      "leaving the box",
      sampled, value[Result::RELEASED], value[Result::ON_GRID], value[Result::OFF_GRID],
      value[Result::LOST], value[Result::RESIDUAL]));
}

/* ----------------------------------------------------------------------
   Every window steps: how much of the mass went to another cell since the last time. The steps made
   count, by their time: the deck may change their numbers.
------------------------------------------------------------------------- */

void FixDepositGrid::take_snapshot()
{
  const double time = now();
  if (time - rasters.snapshot_time < (options.window - 0.5) * update->dt) return;
  const double share = of_rank_zero(rasters.moved()) / results.released.volume;
  rasters.take_snapshot(time, share);
  results.vector[Result::CHANGE] = rasters.change;
}

/* ----------------------------------------------------------------------
   time of LAMMPS, before a change of the time step and since
------------------------------------------------------------------------- */

double FixDepositGrid::clock() const
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::write_files(const std::string &reason)
{
  if (sampled != update->ntimestep) sample(false);
  results.time = now();
  const auto law = PairGranRestitution::of(lmp);
  report.write(reason, results, rasters, law ? &law->guards : nullptr);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::write_restart(FILE *fp)
{
  if (started) losses.end_command();
  if (started && (sampled != update->ntimestep || update->whichflag == 0)) sample(false);
  const DepositRestart::Saved saved = {
      (double) started,      results.released,        balls.bulk(),
      losses.lost,           (double) losses.nlogged, update->whichflag == 1 ? now() : elapsed,
      rasters.snapshot_time, rasters.change};
  restart_data.write(fp, id, saved, rasters);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::restart(char *buffer)
{
  DepositRestart::Saved saved;
  restart_data.read(id, buffer, saved, rasters);
  started = saved.started;
  results.released = saved.released;
  balls.set_bulk(saved.bulk);
  losses.lost = saved.lost;
  losses.nlogged = (int) saved.nlogged;
  elapsed = saved.elapsed;
  rasters.snapshot_time = saved.snapshot_time;
  results.vector[Result::CHANGE] = rasters.change = saved.change;
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
  return rasters.bytes() + bins.blocks().bytes();
}

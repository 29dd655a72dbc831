/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The deposit on a plan grid, binned in the run. Every rank bins its own balls; rank 0 gets the bins and
   has the rasters. */

#include "fix_deposit_grid.h"

#include "constants.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "node_memory.h"
#include "pair_gran_restitution.h"
#include "rank_zero.h"
#include "requirements.h"
#include "restart_archive.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::DepositBins;
using Slope::DepositRasters;
typedef DepositResults Result;

static const std::string CALLER = "Fix deposit/grid ";
static constexpr int VERSION = 8;    // of what restart files hold
static constexpr int PER_CELL = DepositRasters::PER_CELL;
static constexpr double BYTES_PER_CELL = PER_CELL * sizeof(double);
static constexpr int MOST_CELLS = (MAXSMALLINT - 4096) / static_cast<int>(BYTES_PER_CELL);

static std::string too_many(double ncells)
{
  return fmt::format("in which it may have {} cells that the mass touched, got {:.0f}: start "
                     "again, with a larger cell",
                     MOST_CELLS, ncells);
}

enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

FixDepositGrid::FixDepositGrid(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), options(lmp, narg, arg), balls(lmp, groupbit, options.bulk),
    left(lmp, balls, options), report(lmp, id, options, balls), results(), started(false),
    fresh(false), sampled(-1), warned(false), kept_by_atom(false), elapsed(0.0), offset(0.0)
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
  restart_global = restart_peratom = 1;
  create_attribute = 1;
  maxexchange = Slope::BallPath::NUMBERS;
  left.grow(atom->nmax);
  atom->add_callback(Atom::GROW);    // last: LAMMPS cannot undo it where the constructor fails
  atom->add_callback(Atom::RESTART);
  kept_by_atom = true;
}

/* ---------------------------------------------------------------------- */

FixDepositGrid::~FixDepositGrid()
{
  delete[] extlist;
  if (!kept_by_atom) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
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
  std::vector<double> base = DepositRelease(lmp, balls, options).ground();
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
  left.check_restart(CALLER + id);
  left.begin_run();
  report.begin_run();
  sampled = -1;

  // this may be the init() of a command that drops balls outside of the box

  if (started) left.end_command();
  left.begin_command(elapsed);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::setup_pre_exchange()
{
  if (!started && update->whichflag == 1) start();
  if (started) left.end_command();
  offset = elapsed - clock();
  pre_exchange();
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::pre_exchange()
{
  if (started) left.before_exchange(now());
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
    left.begin_command(elapsed);    // now that the volume of balls is known
  }
  released.volume = balls.volume();
  released.stiffness_number = release.stiffness_number(released);
  started = fresh = true;
  release.log(id, released);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::setup(int /*vflag*/)
{
  set_up = update->ntimestep;
  report.begin_guards();

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
  for (const std::string &line : left.add_up_lost()) report.warn(line);

  const double released = results.released.volume;
  double *value = results.vector;
  if (record) left.sample(now());
  results.present = sums.number;
  value[Result::RELEASED] = released;
  value[Result::ON_GRID] = add_bins(record);
  value[Result::OFF_GRID] = sums.off_grid;
  value[Result::LOST] = left.lost_volume;
  value[Result::RESIDUAL] = released - value[Result::ON_GRID] - sums.off_grid - left.lost_volume;
  value[Result::CHANGE] = rasters.change;
  value[Result::NLOST] = left.lost_number;
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
  if (warned ||
      std::fabs(value[Result::RESIDUAL]) <= DepositBalls::BALANCE * value[Result::RELEASED])
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
  const double fraction = of_rank_zero(rasters.moved()) / results.released.volume;
  rasters.take_snapshot(time, fraction);
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
  report.write(reason, results, rasters, left.csv(results.time), guards());
}

const ContactGuards *FixDepositGrid::guards() const
{
  const auto law = PairGranRestitution::of(lmp);
  return law ? &law->guards : nullptr;
}

/* ----------------------------------------------------------------------
   What a restart file has: the grid, numbers, and then, after the archive, the cells that the mass touched.
   LAMMPS gives a fix at most 2 GB there: cells that need more are left out, with a warning, and such a file
   is refused.
------------------------------------------------------------------------- */

void FixDepositGrid::archive(Slope::Archive &archive)
{
  const Slope::PlanGrid &grid = options.grid;
  archive.same("grid",
               {{"cell", grid.cell},
                {"columns", (double) grid.n[X]},
                {"rows", (double) grid.n[Y]},
                {"xlo", grid.lo[X]},
                {"ylo", grid.lo[Y]},
                {"bulk", options.bulk}},
               [](const double *k) {
                 return fmt::format(
                     "cell {:.10g}, {:.0f} x {:.0f} cells from {:.10g} {:.10g}, bulk {}", k[0],
                     k[1], k[2], k[3], k[4], k[5] > 0.0 ? fmt::format("{:.10g}", k[5]) : "region");
               });

  DepositRelease::Released &released = results.released;
  double bulk = balls.bulk(), time = update->whichflag == 1 ? now() : elapsed;
  archive.number("started", started);
  archive.number("released_number", released.mass.number);
  archive.number("released_solid", released.mass.solid);
  archive.number("released_x", released.mass.x);
  archive.number("released_y", released.mass.y);
  archive.numbers("released_top", released.mass.top, 3);
  archive.number("released_volume", released.volume);
  archive.number("body", released.body);
  archive.number("front", released.front);
  archive.number("thick", released.thick);
  archive.number("stiffness_number", released.stiffness_number);
  archive.number("bulk_of_the_release", bulk);
  archive.number("lost_number", left.lost_number);
  archive.number("lost_volume", left.lost_volume);
  archive.number("losses_in_the_log", left.nlogged);
  archive.number("elapsed", time);
  archive.number("snapshot_time", rasters.snapshot_time);
  archive.number("change", rasters.change);
  report.archive(archive);
  left.archive(archive);
  archive.same("numbers_of_a_cell", PER_CELL);
  if (!archive.reads()) return;
  balls.set_bulk(bulk);
  elapsed = time;
  results.vector[Result::CHANGE] = rasters.change;
}

void FixDepositGrid::write_restart(FILE *fp)
{
  if (started) left.end_command();
  if (started && (sampled != update->ntimestep || update->whichflag == 0)) sample(false);
  if (update->whichflag == 1) report.note_guards(guards());    // between runs they begin anew
  left.collect();
  if (comm->me > 0) return;

  const int nrows = options.grid.n[Y];
  double ncells = 0.0;
  for (int j = 0; j < nrows; j++) ncells += rasters.touched(j).size() / PER_CELL;
  const bool fits = ncells <= MOST_CELLS;
  double left_out = fits ? 0.0 : ncells;

  Slope::Archive to(style, VERSION);
  archive(to);
  to.number("cells_left_out", left_out);
  to.count("cells", fits ? static_cast<size_t>(ncells) : 0, MOST_CELLS);
  write_archive(lmp, fp, CALLER + id, to, fits ? ncells * BYTES_PER_CELL : 0.0);
  for (int j = 0; j < nrows && fits; j++) {
    const std::vector<double> cells = rasters.touched(j);
    fwrite(cells.data(), sizeof(double), cells.size(), fp);
  }
  if (!fits)
    error->warning(FLERR, "{}{}: nothing can go on from this restart file, {}", CALLER, id,
                   too_many(ncells));
}

/* ----------------------------------------------------------------------
   the cells go to rank 0
------------------------------------------------------------------------- */

void FixDepositGrid::restart(char *buffer)
{
  const double all = options.grid.ncells();
  read_archive(lmp, CALLER + id, [&]() {
    Slope::Archive from(style, VERSION, buffer);
    archive(from);
    double left_out = 0.0;
    from.number("cells_left_out", left_out);
    if (left_out > 0.0)
      throw std::runtime_error("nothing can go on from this restart file, " + too_many(left_out));
    const size_t ncells = from.count("cells", 0, std::min<double>(MOST_CELLS, all));
    const char *next = from.rest();
    for (size_t c = 0; c < ncells; c++, next += sizeof(double) * PER_CELL) {
      double values[PER_CELL];
      memcpy(values, next, sizeof(values));
      if (!(values[0] >= 0.0 && values[0] < all))
        throw std::runtime_error(
            fmt::format("the restart file must be whole, got cell {:g} of {:.0f}", values[0], all));
      if (comm->me == 0) rasters.restore(values);
    }
  });
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
  return rasters.bytes() + bins.blocks().bytes() + left.bytes();
}

/* ----------------------------------------------------------------------
   storage by atom: where each ball started and was seen
------------------------------------------------------------------------- */

void FixDepositGrid::grow_arrays(int nmax)
{
  left.grow(nmax);
}

void FixDepositGrid::copy_arrays(int i, int j, int /*delflag*/)
{
  left.copy(i, j);
}

void FixDepositGrid::set_arrays(int i)
{
  left.clear(i);
}

int FixDepositGrid::pack_exchange(int i, double *buf)
{
  return left.pack(i, buf);
}

int FixDepositGrid::unpack_exchange(int i, double *buf)
{
  return left.unpack(i, buf);
}

int FixDepositGrid::pack_restart(int i, double *buf)
{
  return left.pack_restart(i, buf);
}

void FixDepositGrid::unpack_restart(int i, int nth)
{
  left.unpack_restart(i, nth);
}

int FixDepositGrid::size_restart(int /*i*/)
{
  return DepositLeft::RESTART;
}

int FixDepositGrid::maxsize_restart()
{
  return DepositLeft::RESTART;
}

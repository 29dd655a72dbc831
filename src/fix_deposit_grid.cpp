/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The deposit on a plan grid, binned in the run. Every ball is a cube of its bulk volume; the
   cube's square in plan is cut exactly by the cells, so that volume is conserved on any grid.
   Every rank bins its own balls in the small window of cells that they occupy; rank 0 alone
   holds the rasters and adds the windows up. */

#include "fix_deposit_grid.h"

#include "atomic_file.h"
#include "lammps_compat.h"
#include "pair_gran_restitution.h"
#include "rank_zero.h"
#include "region_surface.h"
#include "region_terrain.h"
#include "slope_version.h"
#include "style_argument.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <stdexcept>
#include <unistd.h>

using namespace LAMMPS_NS;
using namespace FixConst;
using Slope::AtomicFile;
using Slope::ElevationGrid;

static constexpr double PI = 3.14159265358979323846;
static constexpr double SIMPLE_CUBIC = 6.0 / PI;    // bulk volume / volume of a ball
static constexpr double MOTION = 0.1;               // m/s, default of keyword motion
static constexpr double MOVING_SHARE = 0.1;         // of the volume: more is a mass in motion
static constexpr double BALANCE = 1.0e-9;           // of the released volume
static constexpr double MAXCELLS = 4.0e8;
static constexpr double MAXBULK = 1.0e3;          // a ball's square must not be cut by countless cells
static constexpr double MAXCELL = 1.0e12;         // the area of a cell must be finite
static constexpr double BYTES_PER_CELL = 72.0;    // eight rasters, one more to write a file
static constexpr int MAXLOGGED = 5;               // lost balls that get a line in the log
static constexpr double RESTART_FORMAT = 1.0;     // first number of what a restart file holds
static constexpr int PER_CELL = 7;                // numbers of a cell there
static constexpr double DEGREE = PI / 180.0;
static const double NaN = std::numeric_limits<double>::quiet_NaN();

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
  NRESULT
};
enum { X, Y, Z };

/* ----------------------------------------------------------------------
   fix ID group deposit/grid Nevery Nfreq cell S terrain REGION output PREFIX keyword value ...
------------------------------------------------------------------------- */

FixDepositGrid::FixDepositGrid(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), bulk(SIMPLE_CUBIC), motion(MOTION)
{
  if (narg < 5)
    error->all(FLERR, "Fix deposit/grid needs Nevery Nfreq cell S terrain REGION output PREFIX");
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag)
    error->all(FLERR, "Fix deposit/grid requires balls: atom_style must be sphere, got {}",
               atom->atom_style);
  if (domain->dimension != 3)
    error->all(FLERR, "Fix deposit/grid requires a simulation in 3 dimensions, got 2");

  nevery = whole_number_argument(lmp, "Fix deposit/grid Nevery", arg[3]);
  if (nevery < 1) error->all(FLERR, "Fix deposit/grid Nevery must be >= 1, got {}", nevery);
  nfreq = whole_number_argument(lmp, "Fix deposit/grid Nfreq", arg[4]);
  if (nfreq < 0 || nfreq % nevery)
    error->all(FLERR, "Fix deposit/grid Nfreq must be 0 or a multiple of Nevery {}, got {}", nevery,
               nfreq);

  cell = 0.0;
  window = 0;
  series = false;
  bool extent_set = false;
  double extent[4];

  int iarg = 5;
  while (iarg < narg) {
    const std::string keyword = arg[iarg];
    auto text = [&](int k) {
      if (iarg + k >= narg)
        error->all(FLERR, "Fix deposit/grid {}: value {} is missing", keyword, k);
      return arg[iarg + k];
    };
    auto positive = [&]() {
      const double value = number_argument(lmp, "Fix deposit/grid " + keyword, text(1));
      if (!(value > 0.0))
        error->all(FLERR, "Fix deposit/grid {} must be > 0, got {}", keyword, arg[iarg + 1]);
      return value;
    };
    if (keyword == "cell") {
      cell = positive();
      if (cell > MAXCELL)
        error->all(FLERR, "Fix deposit/grid cell must be at most {:g}, got {}", MAXCELL, arg[iarg + 1]);
      iarg += 2;
    } else if (keyword == "terrain") {
      region_id = text(1);
      iarg += 2;
    } else if (keyword == "output") {
      prefix = text(1);
      iarg += 2;
    } else if (keyword == "bulk") {
      bulk = positive();
      if (bulk > MAXBULK)
        error->all(FLERR, "Fix deposit/grid bulk must be at most {:g}, got {}", MAXBULK, arg[iarg + 1]);
      iarg += 2;
    } else if (keyword == "motion") {
      motion = positive();
      iarg += 2;
    } else if (keyword == "window") {
      window = whole_number_argument(lmp, "Fix deposit/grid window", text(1));
      if (window < 1 || window % nevery)
        error->all(FLERR, "Fix deposit/grid window must be a multiple of Nevery {}, got {}", nevery,
                   window);
      iarg += 2;
    } else if (keyword == "series") {
      if (strcmp(text(1), "yes") != 0 && strcmp(text(1), "no") != 0)
        error->all(FLERR, "Fix deposit/grid series must be yes or no, got {}", text(1));
      series = strcmp(text(1), "yes") == 0;
      iarg += 2;
    } else if (keyword == "extent") {
      for (int k = 0; k < 4; k++)
        extent[k] = number_argument(lmp, "Fix deposit/grid extent", text(k + 1));
      extent_set = true;
      iarg += 5;
    } else
      error->all(FLERR,
                 "Fix deposit/grid: unknown keyword {}, must be cell, terrain, output, bulk, "
                 "extent, motion, window or series",
                 keyword);
  }
  if (cell == 0.0) error->all(FLERR, "Fix deposit/grid keyword cell is missing");
  if (region_id.empty()) error->all(FLERR, "Fix deposit/grid keyword terrain is missing");
  if (prefix.empty()) error->all(FLERR, "Fix deposit/grid keyword output is missing");
  cell_inv = 1.0 / cell;
  side_factor = cbrt(bulk * PI / 6.0);
  if (window == 0) window = nfreq > 0 ? nfreq : 10 * nevery;

  // the grid covers its extent with whole cells, from the south-west corner on

  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region_id.c_str(),
                             RegionSurface::UPPER);
  if (!ground.has_boundary())
    error->all(FLERR, "Fix deposit/grid terrain region {} must have an upper boundary, got INF",
               region_id);
  const double whole[4] = {ground.xlo, ground.xhi, ground.ylo, ground.yhi};
  if (!extent_set) memcpy(extent, whole, sizeof(whole));
  const std::string got =
      fmt::format("{:.10g} {:.10g} {:.10g} {:.10g}", extent[0], extent[1], extent[2], extent[3]);
  if (!(extent[0] < extent[1] && extent[2] < extent[3]))
    error->all(FLERR, "Fix deposit/grid extent must have xlo < xhi and ylo < yhi, got {}", got);
  const double tiny = 1.0e-3 * cell;    // coordinates in decks are rounded
  for (int k = 0; k < 4; k += 2)
    if (!(extent[k] >= whole[k] - tiny && extent[k + 1] <= whole[k + 1] + tiny))
      error->all(FLERR,
                 "Fix deposit/grid extent must lie in that of region {}, {:.10g} {:.10g} {:.10g} "
                 "{:.10g}, got {}",
                 region_id, whole[0], whole[1], whole[2], whole[3], got);

  double ncells = 1.0;
  for (int dim = X; dim <= Y; dim++) {
    const double count =
        std::max(1.0, std::ceil((extent[2 * dim + 1] - extent[2 * dim]) / cell - 1.0e-9));
    n[dim] = (int) std::min(count, MAXCELLS);
    lo[dim] = extent[2 * dim];
    hi[dim] = lo[dim] + n[dim] * cell;
    ncells *= count;
  }
  const std::string need = fmt::format("{:.0f} cells, they need {:.3g} GB of memory on one rank",
                                       ncells, 1.0e-9 * ncells * BYTES_PER_CELL);
  if (ncells > MAXCELLS)
    error->all(FLERR, "Fix deposit/grid cell must give at most {:g} cells, got {}", MAXCELLS, need);

  on_rank_zero(lmp, "Fix deposit/grid: " + need, [&]() {
    // Linux gives more than there is, and kills who uses it
    const double have = (double) sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE);
    if (ncells * BYTES_PER_CELL > have)
      throw std::runtime_error(fmt::format("this machine has {:.3g} GB", 1.0e-9 * have));
    const ElevationGrid zero(n[X], n[Y], lo[X], lo[Y], cell, 0.0);
    thickness = snapshot = max_thickness = max_speed = max_energy = zero;
    base = arrival = last_motion = ElevationGrid(n[X], n[Y], lo[X], lo[Y], cell, NaN);
  });
  read_base();

  // state

  started = fresh = warned = false;
  released = Released();
  lost = lost_here = outside = Lost();
  nlogged = 0;
  outside_known = false;
  std::fill(result, result + NRESULT, 0.0);
  result[CHANGE] = change = 1.0;
  present = 0.0;
  sampled = snapshot_step = -1;
  snapshot_time = elapsed = offset = 0.0;

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

/* ----------------------------------------------------------------------
   height of the ground at every cell centre; the columns of a region that has to be searched
   are dear, so every rank takes its share of the rows
------------------------------------------------------------------------- */

void FixDepositGrid::read_base()
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region_id.c_str(),
                             RegionSurface::UPPER);
  std::vector<double> row(n[X]);
  for (int j = 0; j < n[Y]; j++) {
    const int rank = j % comm->nprocs;
    if (comm->me == rank)
      for (int i = 0; i < n[X]; i++)
        if (!ground.height(lo[X] + (i + 0.5) * cell, lo[Y] + (j + 0.5) * cell, row[i]))
          row[i] = NaN;
    if (rank > 0 && comm->me == rank) MPI_Send(row.data(), n[X], MPI_DOUBLE, 0, 0, world);
    if (rank > 0 && comm->me == 0)
      MPI_Recv(row.data(), n[X], MPI_DOUBLE, rank, 0, world, MPI_STATUS_IGNORE);
    if (comm->me == 0) std::copy(row.begin(), row.end(), &base.at(0, j));
  }
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::init()
{
  for (Fix *fix : compat::fixes_of_style(lmp, "deposit/grid"))
    if (fix != this && static_cast<FixDepositGrid *>(fix)->prefix == prefix)
      error->all(FLERR, "Fix deposit/grid output must be another than that of fix {}, got {}",
                 fix->id, prefix);
  check_folder();
  sampled = -1;

  // write_restart and others move the atoms to their ranks after init() and without a call of
  // ours, and then drop those outside of the box: what is outside now is looked at later

  settle_outside();
  outside = count_outside(false);
  outside_known = true;
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
  if (!started) return;
  const Lost now_outside = count_outside(true);
  lost_here.number += now_outside.number;
  lost_here.volume += now_outside.volume;
}

/* ----------------------------------------------------------------------
   same comparisons as in Comm::exchange()
------------------------------------------------------------------------- */

FixDepositGrid::Lost FixDepositGrid::count_outside(bool note)
{
  Lost count = {0.0, 0.0};
  const double *boxlo = domain->triclinic ? domain->boxlo_lamda : domain->boxlo;
  const double *boxhi = domain->triclinic ? domain->boxhi_lamda : domain->boxhi;

  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *x = atom->x[i], lamda[3];
    if (domain->triclinic) {
      domain->x2lamda(x, lamda);
      x = lamda;
    }
    bool out = false;
    for (int dim = 0; dim < 3; dim++) {
      if (domain->boundary[dim][0] == 1 && x[dim] < boxlo[dim]) out = true;
      if (domain->boundary[dim][1] == 1 && x[dim] >= boxhi[dim]) out = true;
    }
    if (!out) continue;
    count.number += 1.0;
    count.volume += volume_of(i);
    if (note && losses.size() < MAXLOGGED) {
      const double *at = atom->x[i];
      losses.push_back({(double) atom->tag[i], {at[0], at[1], at[2]}, (double) update->ntimestep});
    }
  }
  return count;
}

/* ----------------------------------------------------------------------
   balls that were outside when the last command began and are gone were lost in it
------------------------------------------------------------------------- */

void FixDepositGrid::settle_outside()
{
  if (started && outside_known) {
    const Lost still = count_outside(false);
    lost_here.number += outside.number - still.number;
    lost_here.volume += outside.volume - still.volume;
  }
  outside_known = false;
}

/* ----------------------------------------------------------------------
   first set-up: the mass as it is released
------------------------------------------------------------------------- */

void FixDepositGrid::start()
{
  // the highest ball, of several the one with the lowest ID

  struct Top {
    double x[3], tag;
    bool below(const Top &other) const
    {
      return x[Z] < other.x[Z] || (x[Z] == other.x[Z] && tag > other.tag);
    }
  } top = {{0.0, 0.0, -HUGE_VAL}, 0.0};

  double mine[5] = {0.0, 0.0, 0.0, 0.0, 0.0}, all[5];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    Top ball;
    unwrap(i, ball.x);
    ball.tag = atom->tag[i];
    if (top.below(ball)) top = ball;
    const double m = atom->rmass[i];
    const double add[5] = {1.0, volume_of(i), m, m * ball.x[X], m * ball.x[Y]};
    for (int k = 0; k < 5; k++) mine[k] += add[k];
  }
  MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_SUM, world);
  if (all[0] == 0.0)
    error->all(FLERR,
               "Fix deposit/grid group must hold balls when the run starts, got none: its region "
               "or lattice made no ball");

  std::vector<Top> tops(comm->nprocs);
  MPI_Allgather(&top, 4, MPI_DOUBLE, tops.data(), 4, MPI_DOUBLE, world);
  for (const Top &other : tops)
    if (top.below(other)) top = other;

  released.number = all[0];
  released.volume = all[1];
  released.x = all[3] / all[2];
  released.y = all[4] / all[2];
  std::copy(top.x, top.x + 3, released.top);
  double z;
  farthest(released.front, z);

  check_ground();
  started = fresh = true;

  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Fix deposit/grid {}: {:.0f} balls released, bulk volume {:.10g}; {} x {} cells "
                   "of {:g}\n",
                   id, released.number, released.volume, n[X], n[Y], cell);
}

/* ----------------------------------------------------------------------
   every released ball has ground below and around it, or the run ends: a hole in the elevation
   model under the mass would swallow it
------------------------------------------------------------------------- */

void FixDepositGrid::check_ground()
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region_id.c_str(),
                             RegionSurface::UPPER);
  const Region *region = compat::find_region(lmp, region_id);
  const RegTerrain *terrain = dynamic_cast<const RegTerrain *>(region);
  if (terrain && (!terrain->interior || terrain->grid().count_nodata() == 0)) terrain = nullptr;

  auto hole = [&](const double *x, double diameter) {
    double z;
    if (!ground.height(x[0], x[1], z)) return true;
    if (terrain) return terrain->grid().nodata_within(x[0], x[1], diameter);
    for (int k = 0; k < 8; k++) {
      const double px = x[0] + diameter * cos(0.25 * PI * k);
      const double py = x[1] + diameter * sin(0.25 * PI * k);
      if (px < ground.xlo || px > ground.xhi || py < ground.ylo || py > ground.yhi) continue;
      if (!ground.height(px, py, z)) return true;
    }
    return false;
  };

  // the ball with the lowest ID is named, so that the message does not depend on the ranks

  double worst[5] = {HUGE_VAL, 0.0, 0.0, 0.0, 0.0};    // tag, place, diameter
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit) || atom->tag[i] >= worst[0]) continue;
    const double *x = atom->x[i];
    const double diameter = 2.0 * atom->radius[i];
    if (!hole(x, diameter)) continue;
    worst[0] = atom->tag[i];
    std::copy(x, x + 3, worst + 1);
    worst[4] = diameter;
  }
  std::vector<double> all(5 * comm->nprocs);
  MPI_Allgather(worst, 5, MPI_DOUBLE, all.data(), 5, MPI_DOUBLE, world);
  for (int k = 0; k < comm->nprocs; k++)
    if (all[5 * k] < worst[0]) std::copy(&all[5 * k], &all[5 * k] + 5, worst);

  if (worst[0] < HUGE_VAL)
    error->all(FLERR,
               "Fix deposit/grid terrain region {} must have a height within one diameter {:g} of "
               "every released ball, got none at ball {:.0f}, {:.8g} {:.8g} {:.8g} (too deep: "
               "larger depth of region terrain; a small hole: tools/slope terrain --fill)",
               region_id, worst[4], worst[0], worst[1], worst[2], worst[3]);
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
  if (nfreq > 0 && update->ntimestep % nfreq == 0) write_files("running");
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::post_run()
{
  if (update->whichflag != 1) return;

  // fix halt and a time limit leave the loop before the last step, or in it

  const bool halted = update->ntimestep < update->laststep || timer->is_timeout();
  write_files(halted ? "halted" : "run completed");
  elapsed = now();
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
  place_window();

  double mine[7] = {0.0, 0.0, 0.0, 0.0, 0.0, lost_here.number, lost_here.volume}, all[7];
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double x[3];
    unwrap(i, x);
    const double m = atom->rmass[i];
    const double add[5] = {1.0, bin(i), m, m * x[X], m * x[Y]};
    for (int k = 0; k < 5; k++) mine[k] += add[k];
  }
  MPI_Allreduce(mine, all, 7, MPI_DOUBLE, MPI_SUM, world);
  present = all[0];
  lost.number += all[5];
  lost.volume += all[6];
  lost_here = Lost();
  if (all[5] > 0.0 && nlogged < MAXLOGGED) log_losses(lost.number - all[5]);

  double on_grid = add_windows(record);
  MPI_Bcast(&on_grid, 1, MPI_DOUBLE, 0, world);

  result[RELEASED] = released.volume;
  result[ON_GRID] = on_grid;
  result[OFF_GRID] = all[1];
  result[LOST] = lost.volume;
  result[RESIDUAL] = released.volume - on_grid - all[1] - lost.volume;
  result[CHANGE] = change;
  result[NLOST] = lost.number;

  // travel

  double z;
  const bool any = farthest(result[FRONT], z);
  result[REACH] = any ? atan2(released.top[Z] - z, result[FRONT]) / DEGREE : 0.0;
  result[CENTROID] = any ? hypot(all[3] / all[2] - released.x, all[4] / all[2] - released.y) : 0.0;

  sampled = update->ntimestep;

  if (std::fabs(result[RESIDUAL]) > BALANCE * released.volume && !warned) {
    warned = true;
    warn("the volume balance does not close at step {}: released {:.10g}, on the grid {:.10g}, off the "
         "grid {:.10g}, lost {:.10g}, residual {:.3g}: balls came or went other than by leaving the box",
         sampled, released.volume, on_grid, all[1], lost.volume, result[RESIDUAL]);
  }
}

/* ----------------------------------------------------------------------
   plan distance of the ball that is farthest from the place of the highest released one, and
   its height; false, and 0, if there is no ball
------------------------------------------------------------------------- */

bool FixDepositGrid::farthest(double &distance, double &z) const
{
  struct {
    double square;
    int rank;
  } mine = {-1.0, comm->me}, all;
  z = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    double x[3];
    unwrap(i, x);
    const double dx = x[X] - released.top[X], dy = x[Y] - released.top[Y];
    const double square = dx * dx + dy * dy;
    if (square > mine.square) {
      mine.square = square;
      z = x[Z];
    }
  }
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  MPI_Bcast(&z, 1, MPI_DOUBLE, all.rank, world);
  distance = sqrt(std::max(0.0, all.square));
  return all.square >= 0.0;
}

/* ----------------------------------------------------------------------
   by all ranks: to the screen, the log and the summary
------------------------------------------------------------------------- */

template <typename... Args>
void FixDepositGrid::warn(const char *format, const Args &...args)
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
  const int width = sizeof(Loss) / sizeof(double);
  int mine = width * (int) losses.size();
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int k = 1; k < comm->nprocs; k++) starts[k] = starts[k - 1] + counts[k - 1];
  std::vector<Loss> all((starts.back() + counts.back()) / width);
  MPI_Allgatherv(losses.data(), mine, MPI_DOUBLE, all.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, world);
  losses.clear();

  std::sort(all.begin(), all.end(), [](const Loss &a, const Loss &b) {
    return a.step < b.step || (a.step == b.step && a.tag < b.tag);
  });
  for (const Loss &loss : all) {
    if (nlogged == MAXLOGGED) break;
    nlogged++;
    warn("ball {:.0f} left the box at {:.8g} {:.8g} {:.8g}, step {:.0f}, lost so far: {:.0f}{}",
         loss.tag, loss.x[X], loss.x[Y], loss.x[Z], loss.step, ++before,
         nlogged == MAXLOGGED ? ", more are only counted" : "");
  }
}

/* ----------------------------------------------------------------------
   a ball stands for a cube of ground; this is the cube's side
------------------------------------------------------------------------- */

double FixDepositGrid::side_of(int i) const
{
  return side_factor * 2.0 * atom->radius[i];
}

/* ---------------------------------------------------------------------- */

double FixDepositGrid::volume_of(int i) const
{
  const double side = side_of(i);
  return side * side * side;
}

/* ----------------------------------------------------------------------
   place of a ball that does not jump when it crosses a periodic boundary
------------------------------------------------------------------------- */

void FixDepositGrid::unwrap(int i, double *x) const
{
  if (domain->xperiodic || domain->yperiodic || domain->zperiodic)
    domain->unmap(atom->x[i], atom->image[i], x);
  else
    std::copy(atom->x[i], atom->x[i] + 3, x);
}

/* ----------------------------------------------------------------------
   coordinate in the periodic box, which balls leave a little between neighbor lists
------------------------------------------------------------------------- */

double FixDepositGrid::wrap(int dim, double x) const
{
  if (!periodic(dim)) return x;
  return x - domain->prd[dim] * std::floor((x - domain->boxlo[dim]) / domain->prd[dim]);
}

/* ---------------------------------------------------------------------- */

bool FixDepositGrid::periodic(int dim) const
{
  return domain->periodicity[dim] && !domain->triclinic;
}

/* ---------------------------------------------------------------------- */

int FixDepositGrid::cell_of(int dim, double x) const
{
  return std::min(n[dim] - 1, (int) ((x - lo[dim]) * cell_inv));
}

/* ----------------------------------------------------------------------
   a ball's square along one axis: its shares in the cells there, and beyond, the length that is
   off the grid, exactly 0 for a square that does not touch the edge
------------------------------------------------------------------------- */

void FixDepositGrid::cut(int dim, double centre, double side, Shares &found, double &beyond) const
{
  double a = centre - 0.5 * side, b = centre + 0.5 * side;
  found.count = 0;
  beyond = 0.0;
  if (!periodic(dim)) {
    cut_piece(dim, a, b, side, found, beyond);
    return;
  }

  // what is out of the periodic box goes on at its other side

  const double boxlo = domain->boxlo[dim], boxhi = domain->boxhi[dim], prd = domain->prd[dim];
  if (a < boxlo) {
    cut_piece(dim, a + prd, boxhi, side, found, beyond);
    a = boxlo;
  } else if (b > boxhi) {
    cut_piece(dim, boxlo, b - prd, side, found, beyond);
    b = boxhi;
  }
  cut_piece(dim, a, b, side, found, beyond);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::cut_piece(int dim, double a, double b, double side, Shares &found,
                               double &beyond) const
{
  const double from = std::max(a, lo[dim]);
  const double to = std::min(b, hi[dim]);
  beyond += b - a;
  if (!(from < to)) return;
  beyond -= to - from;

  const int last = cell_of(dim, to);
  for (int c = cell_of(dim, from); c <= last; c++) {
    const double left = std::max(from, lo[dim] + c * cell);
    const double right = std::min(to, lo[dim] + (c + 1) * cell);
    if (!(left < right)) continue;
    found.cell[found.count] = c - bins.first[dim];
    found.part[found.count] = (right - left) / side;
    found.count++;
  }
}

/* ----------------------------------------------------------------------
   an empty window around the squares of this rank's balls
------------------------------------------------------------------------- */

void FixDepositGrid::place_window()
{
  double largest = 0.0;
  for (int dim = X; dim <= Y; dim++) {
    double a = HUGE_VAL, b = -HUGE_VAL;
    for (int i = 0; i < atom->nlocal; i++) {
      if (!(atom->mask[i] & groupbit)) continue;
      const double x = wrap(dim, atom->x[i][dim]), side = side_of(i);
      a = std::min(a, x - 0.5 * side);
      b = std::max(b, x + 0.5 * side);
      largest = std::max(largest, side);
    }

    // what goes on at the other side of a periodic box may be anywhere

    if (periodic(dim) && (a < domain->boxlo[dim] || b > domain->boxhi[dim])) {
      a = lo[dim];
      b = hi[dim];
    }
    a = std::max(a, lo[dim]);
    b = std::min(b, hi[dim]);
    bins.first[dim] = a < b ? cell_of(dim, a) : 0;
    bins.size[dim] = a < b ? cell_of(dim, b) - bins.first[dim] + 1 : 0;
  }
  for (Shares &s : shares) {
    s.cell.resize((size_t) (largest * cell_inv) + 6);    // two pieces, each with two cut cells
    s.part.resize(s.cell.size());
  }
  bins.clear();
}

/* ----------------------------------------------------------------------
   one ball into the window: its volume to the cells below its square, its speed and energy to
   the cell below its centre. Returns the volume that is off the grid.
------------------------------------------------------------------------- */

double FixDepositGrid::bin(int i)
{
  const double side = side_of(i);
  const double volume = side * side * side;

  double place[2], beyond[2];
  for (int dim = X; dim <= Y; dim++) {
    place[dim] = wrap(dim, atom->x[i][dim]);
    cut(dim, place[dim], side, shares[dim], beyond[dim]);
  }
  for (int j = 0; j < shares[Y].count && shares[X].count > 0; j++) {
    double *row = &bins.volume(0, shares[Y].cell[j]);
    const double strip = volume * shares[Y].part[j];
    for (int k = 0; k < shares[X].count; k++) row[shares[X].cell[k]] += strip * shares[X].part[k];
  }

  if (place[X] >= lo[X] && place[X] < hi[X] && place[Y] >= lo[Y] && place[Y] < hi[Y]) {
    const int ic = cell_of(X, place[X]) - bins.first[X];
    const int jc = cell_of(Y, place[Y]) - bins.first[Y];
    const double *v = atom->v[i], *omega = atom->omega[i];
    const double vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double ww = omega[0] * omega[0] + omega[1] * omega[1] + omega[2] * omega[2];
    const double r = atom->radius[i];
    const double energy = 0.5 * atom->rmass[i] * (vv + 0.4 * r * r * ww);
    double &most_speed = bins.speed(ic, jc), &most_energy = bins.energy(ic, jc);
    most_speed = std::max(most_speed, sqrt(vv));
    most_energy = std::max(most_energy, energy);
  }
  if (beyond[X] == 0.0 && beyond[Y] == 0.0) return 0.0;
  return volume * (1.0 - (1.0 - beyond[X] / side) * (1.0 - beyond[Y] / side));
}

/* ----------------------------------------------------------------------
   all windows into the rasters of rank 0; returns, there, the volume on the grid
------------------------------------------------------------------------- */

double FixDepositGrid::add_windows(bool record)
{
  int place[4] = {bins.first[X], bins.first[Y], bins.size[X], bins.size[Y]};
  if (comm->me != 0) {
    MPI_Send(place, 4, MPI_INT, 0, 0, world);
    MPI_Send(bins.values.data(), (int) bins.values.size(), MPI_DOUBLE, 0, 0, world);
    return 0.0;
  }

  for (int j = filled.first[Y]; j < filled.first[Y] + filled.size[Y]; j++)
    std::fill_n(&thickness.at(filled.first[X], j), filled.size[X], 0.0);
  filled.size[X] = filled.size[Y] = 0;

  add_window(bins, record);
  Window other;
  for (int rank = 1; rank < comm->nprocs; rank++) {
    MPI_Recv(place, 4, MPI_INT, rank, 0, world, MPI_STATUS_IGNORE);
    std::copy(place, place + 2, other.first);
    std::copy(place + 2, place + 4, other.size);
    other.clear();
    MPI_Recv(other.values.data(), (int) other.values.size(), MPI_DOUBLE, rank, 0, world,
             MPI_STATUS_IGNORE);
    add_window(other, record);
  }

  // the volume is taken from what the raster holds, so that the balance checks the raster

  double sum = 0.0;
  for (int j = filled.first[Y]; j < filled.first[Y] + filled.size[Y]; j++) {
    double row = 0.0;
    for (int i = filled.first[X]; i < filled.first[X] + filled.size[X]; i++) {
      const double h = thickness.at(i, j);
      row += h;
      if (record && h > max_thickness.at(i, j)) max_thickness.at(i, j) = h;
    }
    sum += row;
  }
  return sum * cell * cell;
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::add_window(Window &from, bool record)
{
  if (from.values.empty()) return;
  const double area = cell * cell;
  const double time = now();
  for (int j = 0; j < from.size[Y]; j++)
    for (int i = 0; i < from.size[X]; i++) {
      const int gi = from.first[X] + i, gj = from.first[Y] + j;
      thickness.at(gi, gj) += from.volume(i, j) / area;
      const double speed = from.speed(i, j);
      if (!record || speed < 0.0) continue;
      max_speed.at(gi, gj) = std::max(max_speed.at(gi, gj), speed);
      max_energy.at(gi, gj) = std::max(max_energy.at(gi, gj), from.energy(i, j));
      if (std::isnan(arrival.at(gi, gj))) arrival.at(gi, gj) = time;
      if (speed > motion) last_motion.at(gi, gj) = time;
    }
  filled.cover(from);
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::Window::clear()
{
  values.assign(3 * ncells(), 0.0);
  std::fill_n(values.begin() + ncells(), ncells(), -1.0);    // speed: no centre was here
}

/* ----------------------------------------------------------------------
   grow to cover another window
------------------------------------------------------------------------- */

void FixDepositGrid::Window::cover(const Window &other)
{
  if (other.ncells() == 0) return;
  const bool empty = ncells() == 0;
  for (int dim = X; dim <= Y; dim++) {
    int end = other.first[dim] + other.size[dim];
    if (!empty) end = std::max(end, first[dim] + size[dim]);
    first[dim] = empty ? other.first[dim] : std::min(first[dim], other.first[dim]);
    size[dim] = end - first[dim];
  }
}

/* ----------------------------------------------------------------------
   every window steps: how much of the mass went to another cell since the last time, as a
   share of what was released, per second
------------------------------------------------------------------------- */

void FixDepositGrid::take_snapshot()
{
  if (update->ntimestep % window) return;
  const double time = now();
  if (comm->me == 0) {
    if (snapshot_step >= 0 && snapshot_step + window == update->ntimestep) {
      double sum = 0.0;
      for (size_t k = 0; k < thickness.z.size(); k++)
        sum += std::fabs(thickness.z[k] - snapshot.z[k]);
      change = 0.5 * sum * cell * cell / (released.volume * (time - snapshot_time));
    }
    snapshot.z = thickness.z;
  }
  MPI_Bcast(&change, 1, MPI_DOUBLE, 0, world);
  result[CHANGE] = change;
  snapshot_step = update->ntimestep;
  snapshot_time = time;
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
    AtomicFile(prefix + ".summary.yaml");    // opened beside, and removed
  });
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::write_files(const std::string &reason)
{
  if (sampled != update->ntimestep) sample(false);

  const Motion balls = motion_of_balls();
  const std::string guarded = guards();
  on_rank_zero(lmp, "Fix deposit/grid", [&]() {
    Files files;
    std::vector<std::string> names;
    write_rasters(files, names);
    add_file(files, prefix + ".summary.yaml").write(summary(reason, balls, guarded, names));

    // on a full disk either all of them are new, or none

    for (auto &file : files) file->close();
    for (auto &file : files) file->commit();
  });
}

/* ----------------------------------------------------------------------
   on rank 0: speeds of all balls
------------------------------------------------------------------------- */

FixDepositGrid::Motion FixDepositGrid::motion_of_balls() const
{
  std::vector<double> mine;
  double moving = 0.0, all_moving;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *v = atom->v[i];
    mine.push_back(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    if (mine.back() > motion) moving += volume_of(i);
  }
  MPI_Reduce(&moving, &all_moving, 1, MPI_DOUBLE, MPI_SUM, 0, world);

  int count = mine.size();    // not const: LAMMPS' stand-in for MPI has no const
  std::vector<int> counts(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, world);
  for (int k = 1; k < comm->nprocs; k++) starts[k] = starts[k - 1] + counts[k - 1];
  std::vector<double> all(comm->me == 0 ? starts.back() + counts.back() : 0);
  MPI_Gatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE,
              0, world);

  Motion found = {0.0, 0.0, 0.0};
  if (all.empty()) return found;
  auto middle = all.begin() + all.size() / 2;
  std::nth_element(all.begin(), middle, all.end());
  found.median = *middle;
  found.largest = *std::max_element(all.begin(), all.end());
  found.share = all_moving / (released.volume - lost.volume);
  return found;
}

/* ---------------------------------------------------------------------- */

AtomicFile &FixDepositGrid::add_file(Files &files, const std::string &path)
{
  files.emplace_back(new AtomicFile(path));
  return *files.back();
}

/* ---------------------------------------------------------------------- */

void FixDepositGrid::write_rasters(Files &files, std::vector<std::string> &names) const
{
  ElevationGrid surface = base;
  for (size_t k = 0; k < surface.z.size(); k++) surface.z[k] += thickness.z[k];

  // the sum of the thickness as written is the volume on the grid to 1e-9

  auto write = [&](const std::string &name, const ElevationGrid &grid, int digits) {
    grid.write(add_file(files, name), digits);
    names.push_back(name.substr(name.rfind('/') + 1));
  };
  if (series) {
    const std::string numbered = fmt::format("{}.{}", prefix, update->ntimestep);
    write(numbered + ".thickness.asc", thickness, 12);
  }
  write(prefix + ".thickness.asc", thickness, 12);
  write(prefix + ".surface.asc", surface, 9);
  write(prefix + ".max_thickness.asc", max_thickness, 9);
  write(prefix + ".max_speed.asc", max_speed, 9);
  write(prefix + ".max_energy.asc", max_energy, 9);
  write(prefix + ".arrival.asc", arrival, 9);
  write(prefix + ".last_motion.asc", last_motion, 9);
}

/* ----------------------------------------------------------------------
   YAML; a number that is no count has a point in it, or YAML would read 1e-05 as text
------------------------------------------------------------------------- */

static std::string real(double value)
{
  std::string text = fmt::format("{:.15g}", value);
  if (text.find('.') != std::string::npos) return text;
  return text.insert(std::min(text.find('e'), text.size()), ".0");
}

static std::string quoted(const std::string &text)
{
  std::string inner;
  for (const char c : text) inner += c == '\'' ? "''" : std::string(1, c);
  return "'" + inner + "'";
}

/* ----------------------------------------------------------------------
   what the guards of the contacts found in this run, and all warnings so far
------------------------------------------------------------------------- */

std::string FixDepositGrid::guards() const
{
  std::string s;
  std::vector<std::string> all;
  auto law = dynamic_cast<PairGranRestitution *>(force->pair_match("gran/restitution", 1));
  if (law) {
    const PairGranRestitution::Guards found = law->guards();
    s += "guards:  # overlap: of the smaller radius; growth: of the largest energy of motion\n";
    s += "  largest_overlap: " + real(found.deepest) + "\n";
    s += fmt::format("  deep_contacts: {}\n", found.deep);
    s += "  energy_growth: " + real(found.energy_growth) + "\n";
    s += fmt::format("  dangerous_builds: {}\n", found.dangerous_builds);
    all = law->warnings;
  }
  all.insert(all.end(), warnings.begin(), warnings.end());
  s += all.empty() ? "warnings: []\n" : "warnings:\n";
  for (const std::string &warning : all) s += "  - " + quoted(warning) + "\n";
  return s;
}

/* ---------------------------------------------------------------------- */

std::string FixDepositGrid::summary(const std::string &reason, const Motion &balls,
                                    const std::string &guarded,
                                    const std::vector<std::string> &files) const
{
  std::string s;
  auto line = [&](const std::string &key, const std::string &value) {
    s += key + ": " + value + "\n";
  };
  auto count = [&](double value) {
    return fmt::format("{:.0f}", value);
  };

  s += "# fix deposit/grid of the SLOPE package for LAMMPS; units of the run, angles in degrees\n";
  line("slope_version", quoted(SLOPE_VERSION));
  line("lammps_version", quoted(lmp->version));
  line("fix", quoted(id));
  line("step", fmt::format("{}", update->ntimestep));
  line("time", real(now()));
  line("dt", real(update->dt));
  line("ranks", fmt::format("{}", comm->nprocs));
  line("bulk_factor", real(bulk));
  s += "grid:\n";
  line("  cell", real(cell));
  line("  columns", fmt::format("{}", n[X]));
  line("  rows", fmt::format("{}", n[Y]));
  line("  extent",
       fmt::format("[{}, {}, {}, {}]", real(lo[X]), real(hi[X]), real(lo[Y]), real(hi[Y])));
  s += "balls:\n";
  line("  released", count(released.number));
  line("  present", count(present));
  line("  lost", count(lost.number));
  s += "volume:  # bulk; released = on_grid + off_grid + lost + residual\n";
  line("  released", real(result[RELEASED]));
  line("  on_grid", real(result[ON_GRID]));
  line("  off_grid", real(result[OFF_GRID]));
  line("  lost", real(result[LOST]));
  line("  residual", real(result[RESIDUAL]));
  s += "travel:  # in plan; front: farthest ball from the highest released one\n";
  line("  front", real(result[FRONT]));
  line("  front_at_release", real(released.front));
  line("  centroid", real(result[CENTROID]));
  line("  reach_angle", real(result[REACH]));
  s += "largest:\n";
  line("  thickness", real(thickness.zmax()));
  line("  max_thickness", real(max_thickness.zmax()));
  line("  max_speed", real(max_speed.zmax()));
  line("  max_energy", real(max_energy.zmax()));
  s += "motion:  # of the balls now; moving_share: of the volume, faster than threshold\n";
  line("  threshold", real(motion));
  line("  largest_speed", real(balls.largest));
  line("  median_speed", real(balls.median));
  line("  moving_share", real(balls.share));
  line("change_rate",
       real(result[CHANGE]) + "  # share of the volume that changes cell, per second");
  line("moving", balls.share > MOVING_SHARE ? "true" : "false");
  s += guarded;
  s += "stop:\n";
  line("  step", fmt::format("{}", update->ntimestep));
  line("  time", real(now()));
  line("  reason", quoted(reason));
  s += "files:\n";
  for (const std::string &file : files) s += "  - " + quoted(file) + "\n";
  return s;
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
                       lost,
                       (double) nlogged,
                       update->whichflag == 1 ? now() : elapsed,
                       (double) snapshot_step,
                       snapshot_time,
                       change};
  std::vector<double> cells;
  for (size_t k = 0; k < max_thickness.z.size(); k++) {
    if (max_thickness.z[k] == 0.0 && std::isnan(arrival.z[k])) continue;
    const double values[PER_CELL] = {(double) k,      max_thickness.z[k], max_speed.z[k],
                                     max_energy.z[k], arrival.z[k],       last_motion.z[k],
                                     snapshot.z[k]};
    cells.insert(cells.end(), values, values + PER_CELL);
  }

  const Key key = restart_key();
  const double ncells = cells.size() / PER_CELL;
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

  const Key mine = restart_key();
  Key key;
  take(&key, sizeof(Key));
  if (key.format != mine.format)
    error->all(FLERR, "Fix deposit/grid {}: the restart file is from another version of the fix",
               id);
  if (memcmp(&key, &mine, sizeof(Key)) != 0) {
    auto text = [](const Key &k) {
      return fmt::format("cell {:.10g}, {:.0f} x {:.0f} cells from {:.10g} {:.10g}, bulk {:.10g}",
                         k.cell, k.nx, k.ny, k.xlo, k.ylo, k.bulk);
    };
    error->all(FLERR, "Fix deposit/grid {} must have the grid of the restart file, {}; got {}", id,
               text(key), text(mine));
  }

  Saved saved;
  take(&saved, sizeof(Saved));
  started = saved.started;
  released = saved.released;
  lost = saved.lost;
  nlogged = (int) saved.nlogged;
  elapsed = saved.elapsed;
  snapshot_step = (bigint) saved.snapshot_step;
  snapshot_time = saved.snapshot_time;
  result[CHANGE] = change = saved.change;

  if (comm->me != 0) return;
  double ncells;
  take(&ncells, sizeof(double));
  for (double c = 0.0; c < ncells; c++) {
    double values[PER_CELL];
    take(values, sizeof(values));
    const size_t k = (size_t) values[0];
    max_thickness.z[k] = values[1];
    max_speed.z[k] = values[2];
    max_energy.z[k] = values[3];
    arrival.z[k] = values[4];
    last_motion.z[k] = values[5];
    snapshot.z[k] = values[6];
  }
}

/* ---------------------------------------------------------------------- */

FixDepositGrid::Key FixDepositGrid::restart_key() const
{
  return {RESTART_FORMAT, cell, (double) n[X], (double) n[Y], lo[X], lo[Y], bulk};
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
  return (double) base.z.size() * (BYTES_PER_CELL - sizeof(double)) +
      (double) bins.values.capacity() * sizeof(double);
}

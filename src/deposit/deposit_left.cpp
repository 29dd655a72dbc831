/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_left.h"

#include "deposit_balls.h"
#include "deposit_options.h"
#include "large_messages.h"
#include "region_surface.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

using namespace LAMMPS_NS;
using Slope::BallPath;
using Slope::LeftBall;

static constexpr int PARTS = 4;        // of a cell along a side: ground may be missing in between
static constexpr int MAXLOGGED = 5;    // lost balls that get a line in the log
static const double START[1] = {-1.0};

enum { X, Y, Z };

static_assert(sizeof(BallPath) == BallPath::NUMBERS * sizeof(double), "numbers only");

/* ---------------------------------------------------------------------- */

DepositLeft::DepositLeft(LAMMPS *lmp, const DepositBalls &balls_in,
                         const DepositOptions &options_in) :
    Pointers(lmp),
    lost_number(0.0), lost_volume(0.0), nlogged(0), balls(balls_in), options(options_in),
    extra(lmp, "path"), sampled(std::numeric_limits<double>::quiet_NaN()), lost_here{0.0, 0.0},
    cells(START)
{
}

DepositLeft::~DepositLeft() = default;

/* ---------------------------------------------------------------------- */

void DepositLeft::begin_run()
{
  ground.reset(new RegionSurface(lmp, "Fix deposit/grid terrain", options.terrain.c_str(),
                                 RegionSurface::UPPER));
  cells.set_grid(options.grid);
}

/* ----------------------------------------------------------------------
   into the box where it is periodic: ground is there
------------------------------------------------------------------------- */

void DepositLeft::wrap(double *x) const
{
  for (int dim = X; dim <= Y; dim++) {
    if (!domain->periodicity[dim] || domain->triclinic) continue;
    const double lo = domain->boxlo[dim], length = domain->boxhi[dim] - lo;
    x[dim] -= length * std::floor((x[dim] - lo) / length);
  }
}

bool DepositLeft::over_ground(const double *place) const
{
  double x[2] = {place[X], place[Y]}, z;
  wrap(x);
  for (int dim = X; dim <= Y; dim++)
    if (x[dim] < options.grid.lo[dim] || x[dim] > options.grid.hi[dim]) return false;
  if (!ground->is_raster() &&
      everywhere(options.grid.cell_of(X, x[X]), options.grid.cell_of(Y, x[Y])))
    return true;
  return ground->height(x[X], x[Y], z);
}

/* ---------------------------------------------------------------------- */

bool DepositLeft::everywhere(int i, int j) const
{
  typedef Slope::BlockOfCells Block;
  double &known = cells.make(Block::of_cell(i), Block::of_cell(j)).values[0][Block::index(i, j)];
  if (known != UNKNOWN) return known == EVERYWHERE;
  known = EVERYWHERE;
  const double part = options.grid.cell / PARTS;
  const double corner[2] = {options.grid.lo[X] + i * options.grid.cell,
                            options.grid.lo[Y] + j * options.grid.cell};
  for (int k = 0; k <= PARTS && known == EVERYWHERE; k++)
    for (int m = 0; m <= PARTS && known == EVERYWHERE; m++) {
      double z;
      if (!ground->height(corner[X] + k * part, corner[Y] + m * part, z)) known = SOMEWHERE;
    }
  return known == EVERYWHERE;
}

/* ---------------------------------------------------------------------- */

BallPath DepositLeft::path_now(int i, double now) const
{
  BallPath path = paths[i];
  double x[3];
  balls.unwrap(i, x);
  path.move(x, std::isnan(sampled) ? now : sampled, now, [this](const double *place) {
    return over_ground(place);
  });
  return path;
}

LeftBall DepositLeft::left_ball(int i, const BallPath &path) const
{
  LeftBall ball = {(double) atom->tag[i],
                   balls.volume_of(i),
                   path.left,
                   {path.at[X], path.at[Y]},
                   {path.start[X], path.start[Y]}};
  wrap(ball.x);
  return ball;
}

/* ---------------------------------------------------------------------- */

void DepositLeft::sample(double now)
{
  std::string changed;
  if (!ground->stands(changed))    // of a run with pre no
    error->all(FLERR, "Fix deposit/grid terrain region {} must not change before the run ends",
               changed);
  for (int i = 0; i < atom->nlocal; i++)
    if (balls.selected(i)) paths[i] = path_now(i, now);
  sampled = now;
}

/* ----------------------------------------------------------------------
   one that leaves the box above ground left there
------------------------------------------------------------------------- */

LeftBall DepositLeft::lost_ball(int i, double now) const
{
  BallPath path = path_now(i, now);
  if (!path.is_out()) path.left = now;
  return left_ball(i, path);
}

/* ---------------------------------------------------------------------- */

void DepositLeft::before_exchange(double now)
{
  double volume = 0.0;
  for (const int i : balls.outside()) {
    gone.push_back(lost_ball(i, now));
    volume += gone.back().volume;
    lost_here[0]++;
    const double *x = atom->x[i];
    if (first_lost.size() < MAXLOGGED)
      first_lost.push_back({(double) atom->tag[i], {x[X], x[Y], x[Z]}, (double) update->ntimestep});
  }
  lost_here[1] += volume;
}

/* ---------------------------------------------------------------------- */

void DepositLeft::begin_command(double now)
{
  doubtful.clear();
  for (const int i : balls.outside()) doubtful.push_back(lost_ball(i, now));
}

void DepositLeft::end_command()
{
  int mine = !doubtful.empty(), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return;
  std::vector<double> tags;
  for (const int i : balls.outside()) tags.push_back((double) atom->tag[i]);
  tags = gather_records(world, tags);
  const std::set<double> still(tags.begin(), tags.end());
  for (const LeftBall &ball : gather_records(world, doubtful)) {
    if (still.count(ball.tag)) continue;
    gone.push_back(ball);
    lost_here[0]++;
    lost_here[1] += ball.volume;
  }
  doubtful.clear();
}

/* ----------------------------------------------------------------------
   the first balls by step, then by ball
------------------------------------------------------------------------- */

std::vector<std::string> DepositLeft::add_up_lost()
{
  double all[2], before = lost_number;
  MPI_Allreduce(lost_here, all, 2, MPI_DOUBLE, MPI_SUM, world);
  lost_number += all[0];
  lost_volume += all[1];
  lost_here[0] = lost_here[1] = 0.0;
  if (all[0] == 0.0 || nlogged >= MAXLOGGED) return {};
  std::vector<Place> first = gather_records(world, first_lost);
  broadcast(world, first);
  first_lost.clear();
  std::sort(first.begin(), first.end(), [](const Place &a, const Place &b) {
    return a.step < b.step || (a.step == b.step && a.tag < b.tag);
  });
  std::vector<std::string> lines;
  for (const Place &ball : first)
    if (nlogged < MAXLOGGED)
      lines.push_back(fmt::format(
          "ball {:.0f} left the box at {:.8g} {:.8g} {:.8g}, step {:.0f}, lost so far: {:.0f}{}",
          ball.tag, ball.x[X], ball.x[Y], ball.x[Z], ball.step, ++before,
          ++nlogged < MAXLOGGED ? "" : ", more are only counted"));
  return lines;
}

/* ---------------------------------------------------------------------- */

std::string DepositLeft::csv(double now) const
{
  std::vector<LeftBall> mine = gone;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!balls.selected(i)) continue;
    const BallPath path = path_now(i, now);
    if (path.is_out()) mine.push_back(left_ball(i, path));
  }
  return Slope::left_csv(gather_records(world, mine));
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

int DepositLeft::pack(int i, double *buf) const
{
  memcpy(buf, &paths[i], sizeof(BallPath));
  return BallPath::NUMBERS;
}

int DepositLeft::unpack(int i, const double *buf)
{
  memcpy(static_cast<void *>(&paths[i]), buf, sizeof(BallPath));
  return BallPath::NUMBERS;
}

// as LAMMPS wants it, the length first

int DepositLeft::pack_restart(int i, double *buf) const
{
  buf[0] = RESTART;
  return 1 + pack(i, buf + 1);
}

void DepositLeft::unpack_restart(int i, int nth)
{
  if (const double *from = extra.record_of_ball(i, nth, RESTART, 0)) unpack(i, from + 1);
}

/* ---------------------------------------------------------------------- */

void DepositLeft::collect()
{
  gone = gather_records(world, gone);
}

void DepositLeft::archive(Slope::Archive &archive)
{
  archive.number("left_sampled", sampled);
  archive.records("left", gone);
  if (archive.reads() && comm->me > 0) gone.clear();
}

/* ---------------------------------------------------------------------- */

double DepositLeft::bytes() const
{
  return (double) paths.capacity() * sizeof(BallPath) +
      (double) gone.capacity() * sizeof(LeftBall) + cells.bytes();
}

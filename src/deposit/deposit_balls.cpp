/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_balls.h"

#include "constants.h"
#include "histogram.h"
#include "large_messages.h"
#include "requirements.h"

#include "atom.h"
#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using Slope::DepositBins;
using Slope::DepositSummary;
using Slope::Histogram;

static constexpr double SLOWEST = 1.0e-9;    // of the largest speed: slower is 0 in the median

enum { X, Y, Z };

/* ---------------------------------------------------------------------- */

DepositBalls::DepositBalls(LAMMPS *lmp, int groupbit_in, double bulk) :
    Pointers(lmp), groupbit(groupbit_in), fast(from_si_speed(lmp, DepositSummary::FAST))
{
  set_bulk(bulk);
}

/* ---------------------------------------------------------------------- */

void DepositBalls::set_bulk(double bulk)
{
  factor = bulk;
  side_factor = cbrt(bulk * Slope::PI / 6.0);
}

/* ---------------------------------------------------------------------- */

bool DepositBalls::selected(int i) const
{
  return atom->mask[i] & groupbit;
}

/* ---------------------------------------------------------------------- */

double DepositBalls::side_of(int i) const
{
  return side_factor * 2.0 * atom->radius[i];
}

/* ---------------------------------------------------------------------- */

double DepositBalls::volume_of(int i) const
{
  const double side = side_of(i);
  return side * side * side;
}

/* ---------------------------------------------------------------------- */

void DepositBalls::unwrap(int i, double *x) const
{
  if (domain->xperiodic || domain->yperiodic || domain->zperiodic)
    domain->unmap(atom->x[i], atom->image[i], x);
  else
    std::copy(atom->x[i], atom->x[i] + 3, x);
}

/* ---------------------------------------------------------------------- */

double DepositBalls::speed_of(int i) const
{
  const double *v = atom->v[i];
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* ---------------------------------------------------------------------- */

DepositBalls::Sums DepositBalls::bin(DepositBins &bins) const
{
  for (int dim = X; dim <= Y; dim++)
    bins.set_period(dim, domain->periodicity[dim] && !domain->triclinic, domain->boxlo[dim],
                    domain->boxhi[dim]);
  bins.clear();

  Sums sums = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (int i = 0; i < atom->nlocal; i++) {
    if (!selected(i)) continue;
    double x[3];
    unwrap(i, x);
    const double *v = atom->v[i], *omega = atom->omega[i];
    const double vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double ww = omega[0] * omega[0] + omega[1] * omega[1] + omega[2] * omega[2];
    const double m = atom->rmass[i], r = atom->radius[i], side = side_of(i), speed = sqrt(vv);
    sums.number += 1.0;
    sums.off_grid += bins.bin(atom->x[i], side, speed, 0.5 * m * (vv + 0.4 * r * r * ww));
    sums.mass += m;
    sums.mass_x += m * x[X];
    sums.mass_y += m * x[Y];
    if (speed > fast) sums.fast += side * side * side;
  }
  Sums all;
  MPI_Allreduce(&sums, &all, sizeof(Sums) / sizeof(double), MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   same comparisons as in Comm::exchange()
------------------------------------------------------------------------- */

std::vector<int> DepositBalls::outside() const
{
  std::vector<int> found;
  const double *boxlo = domain->triclinic ? domain->boxlo_lamda : domain->boxlo;
  const double *boxhi = domain->triclinic ? domain->boxhi_lamda : domain->boxhi;

  for (int i = 0; i < atom->nlocal; i++) {
    if (!selected(i)) continue;
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
    if (out) found.push_back(i);
  }
  return found;
}

/* ---------------------------------------------------------------------- */

double DepositBalls::volume() const
{
  double mine = 0.0, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (selected(i)) mine += volume_of(i);
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ---------------------------------------------------------------------- */

bool DepositBalls::farthest(const double *place, double &distance, double &z) const
{
  double most = -1.0;
  z = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!selected(i)) continue;
    double x[3];
    unwrap(i, x);
    const double dx = x[X] - place[X], dy = x[Y] - place[Y];
    const double square = dx * dx + dy * dy;
    if (square > most) {
      most = square;
      z = x[Z];
    }
  }
  most = with_largest(world, most, z);
  distance = sqrt(std::max(0.0, most));
  return most >= 0.0;
}

/* ----------------------------------------------------------------------
   in plan; degrees below the horizontal. A ball at the place itself went nowhere: straight down.
------------------------------------------------------------------------- */

void DepositBalls::seen_from(const double *place, int i, double &distance, double &angle) const
{
  double x[3];
  unwrap(i, x);
  distance = hypot(x[X] - place[X], x[Y] - place[Y]);
  angle = distance > 0.0 ? atan2(place[Z] - x[Z], distance) / Slope::DEGREE : 90.0;
}

/* ----------------------------------------------------------------------
   of the angle the share is at or above it, so the histogram is that of its negative: the flatter
   side is the safe one
------------------------------------------------------------------------- */

std::vector<DepositSummary::Quantile> DepositBalls::quantiles(const double *place,
                                                              double lost) const
{
  double mine[3] = {0.0, -HUGE_VAL, -HUGE_VAL}, most[3];    // farthest; - flattest, steepest
  double distance, angle;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!selected(i)) continue;
    seen_from(place, i, distance, angle);
    mine[0] = std::max(mine[0], distance);
    mine[1] = std::max(mine[1], -angle);
    mine[2] = std::max(mine[2], angle);
  }
  MPI_Allreduce(mine, most, 3, MPI_DOUBLE, MPI_MAX, world);
  std::vector<DepositSummary::Quantile> found;
  if (most[1] == -HUGE_VAL) {    // no ball is left: nothing is known
    for (const double share : Slope::SHARES) found.push_back({share, {HUGE_VAL, HUGE_VAL}});
    return found;
  }

  Histogram distances(0.0, most[0]), angles(-most[2], most[1]);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!selected(i)) continue;
    seen_from(place, i, distance, angle);
    distances.add(distance, volume_of(i));
    angles.add(-angle, volume_of(i));
  }
  add_up(world, distances.weights);
  add_up(world, angles.weights);

  // of the volume that was released: what was lost went farther than what is left

  double left = 0.0;
  for (const double weight : distances.weights) left += weight;
  for (const double share : Slope::SHARES) {
    const double of_left = share * (left + lost) / left;
    if (of_left <= 1.0 + BALANCE)    // all that is left, but for rounding
      found.push_back({share, {distances.quantile(of_left), -angles.quantile(of_left)}});
    else
      found.push_back({share, {HUGE_VAL, HUGE_VAL}});    // unknown
  }
  return found;
}

/* ----------------------------------------------------------------------
   speeds of a deposit at rest and of its few last balls are far apart, so the histogram for the
   median is that of their logarithm
------------------------------------------------------------------------- */

DepositSummary::Motion DepositBalls::motion(double threshold, double &moving) const
{
  double mine[3] = {0.0, 0.0, 0.0}, all[3];    // largest; volume that moves, that is fast
  for (int i = 0; i < atom->nlocal; i++) {
    if (!selected(i)) continue;
    const double speed = speed_of(i);
    mine[0] = std::max(mine[0], speed);
    if (speed > threshold) mine[1] += volume_of(i);
    if (speed > fast) mine[2] += volume_of(i);
  }
  MPI_Allreduce(mine, all, 1, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(mine + 1, all + 1, 2, MPI_DOUBLE, MPI_SUM, world);
  moving = all[1];
  DepositSummary::Motion found = {threshold, all[0], 0.0, 0.0, all[2], 0.0, fast};
  if (found.largest == 0.0) return found;

  Histogram speeds(log(SLOWEST), 0.0);
  for (int i = 0; i < atom->nlocal; i++)
    if (selected(i)) speeds.add(log(std::max(SLOWEST, speed_of(i) / found.largest)), 1.0);
  add_up(world, speeds.weights);
  const double median = speeds.quantile(0.5);
  const bool first_bin = median < log(SLOWEST) + 1.5 * speeds.bin();    // holds all that is slower
  found.median = first_bin ? 0.0 : found.largest * exp(median);
  return found;
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_ground.h"

#include "constants.h"
#include "deposit_balls.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "region_surface.h"
#include "region_terrain.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using Slope::PlanGrid;

enum { X, Y };

/* ---------------------------------------------------------------------- */

std::vector<double> DepositGround::read(const PlanGrid &grid) const
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region.c_str(), RegionSurface::UPPER);
  auto first_row = [&](int rank) {    // each rank has its share of them
    return static_cast<int>(static_cast<bigint>(grid.n[Y]) * rank / comm->nprocs);
  };
  std::vector<double> mine;
  mine.reserve(static_cast<size_t>(grid.n[X]) * (first_row(comm->me + 1) - first_row(comm->me)));
  for (int j = first_row(comm->me); j < first_row(comm->me + 1); j++)
    for (int i = 0; i < grid.n[X]; i++) {
      double z;
      const bool any = ground.height(grid.centre(X, i), grid.centre(Y, j), z);
      mine.push_back(any ? z : std::numeric_limits<double>::quiet_NaN());
    }
  return gather_records(world, mine);
}

/* ---------------------------------------------------------------------- */

void DepositGround::check(const DepositBalls &balls)
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region.c_str(), RegionSurface::UPPER);
  Region *solid = compat::find_region(lmp, region);
  const auto *terrain = dynamic_cast<const RegTerrain *>(solid);
  if (terrain && (!solid->interior || terrain->grid().count_nodata() == 0)) terrain = nullptr;

  // what was solid below the last place that was searched mostly is so below the next one

  double guess = ground.zlo;
  auto found = [&](double x, double y) {
    if (solid->match(x, y, guess)) return true;
    double z;
    if (!ground.height(x, y, z)) return false;
    guess = 0.5 * (z + ground.zlo);
    return true;
  };
  auto hole = [&](const double *x, double diameter) {
    if (!found(x[0], x[1])) return true;
    if (terrain) return terrain->grid().nodata_within(x[0], x[1], diameter);
    for (int k = 0; k < 8; k++) {
      const double px = x[0] + diameter * cos(0.25 * Slope::PI * k);
      const double py = x[1] + diameter * sin(0.25 * Slope::PI * k);
      if (px < ground.xlo || px > ground.xhi || py < ground.ylo || py > ground.yhi) continue;
      if (!found(px, py)) return true;
    }
    return false;
  };

  // the ball with the lowest ID is named, so that the message does not depend on the ranks

  double worst[5] = {HUGE_VAL, 0.0, 0.0, 0.0, 0.0};    // tag, place, diameter
  for (int i = 0; i < atom->nlocal; i++) {
    if (!balls.selected(i) || atom->tag[i] >= worst[0]) continue;
    const double *x = atom->x[i];
    const double diameter = 2.0 * atom->radius[i];
    if (!hole(x, diameter)) continue;
    worst[0] = atom->tag[i];
    std::copy(x, x + 3, worst + 1);
    worst[4] = diameter;
  }
  with_largest(world, -worst[0], worst);
  if (worst[0] == HUGE_VAL) return;
  error->all(FLERR,
             "Fix deposit/grid terrain region {} must have a height within one diameter {:g} of "
             "every released ball, got none at ball {:.0f}, {:.8g} {:.8g} {:.8g}: there the slip "
             "surface reaches below the bottom of the ground (check its toe and depth, or give "
             "region terrain a larger depth), or the survey has a hole (tools/slope terrain "
             "--fill)",
             region, worst[4], worst[0], worst[1], worst[2], worst[3]);
}

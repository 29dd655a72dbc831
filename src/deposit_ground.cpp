/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_ground.h"

#include "deposit_balls.h"
#include "lammps_compat.h"
#include "region_surface.h"
#include "region_terrain.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace LAMMPS_NS;
using Slope::ElevationGrid;
using Slope::PlanGrid;

static constexpr double PI = 3.14159265358979323846;
static const double NaN = std::numeric_limits<double>::quiet_NaN();

enum { X, Y };

/* ----------------------------------------------------------------------
   searching the columns of a region takes time, so every rank takes its share of the rows
------------------------------------------------------------------------- */

void DepositGround::read(const PlanGrid &grid, ElevationGrid &base)
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region.c_str(), RegionSurface::UPPER);
  std::vector<double> row(grid.n[X]);
  for (int j = 0; j < grid.n[Y]; j++) {
    const int rank = j % comm->nprocs;
    if (comm->me == rank)
      for (int i = 0; i < grid.n[X]; i++)
        if (!ground.height(grid.lo[X] + (i + 0.5) * grid.cell, grid.lo[Y] + (j + 0.5) * grid.cell,
                           row[i]))
          row[i] = NaN;
    if (rank > 0 && comm->me == rank) MPI_Send(row.data(), grid.n[X], MPI_DOUBLE, 0, 0, world);
    if (rank > 0 && comm->me == 0)
      MPI_Recv(row.data(), grid.n[X], MPI_DOUBLE, rank, 0, world, MPI_STATUS_IGNORE);
    if (comm->me == 0) std::copy(row.begin(), row.end(), &base.at(0, j));
  }
}

/* ---------------------------------------------------------------------- */

void DepositGround::check(const DepositBalls &balls)
{
  const RegionSurface ground(lmp, "Fix deposit/grid terrain", region.c_str(), RegionSurface::UPPER);
  Region *solid = compat::find_region(lmp, region);
  const auto *terrain = dynamic_cast<const RegTerrain *>(solid);
  if (terrain && (!terrain->interior || terrain->grid().count_nodata() == 0)) terrain = nullptr;

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
      const double px = x[0] + diameter * cos(0.25 * PI * k);
      const double py = x[1] + diameter * sin(0.25 * PI * k);
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
  std::vector<double> all(5 * comm->nprocs);
  MPI_Allgather(worst, 5, MPI_DOUBLE, all.data(), 5, MPI_DOUBLE, world);
  for (int k = 0; k < comm->nprocs; k++)
    if (all[5 * k] < worst[0]) std::copy(&all[5 * k], &all[5 * k] + 5, worst);

  if (worst[0] < HUGE_VAL)
    error->all(FLERR,
               "Fix deposit/grid terrain region {} must have a height within one diameter {:g} of "
               "every released ball, got none at ball {:.0f}, {:.8g} {:.8g} {:.8g} (too deep: "
               "larger depth of region terrain; a small hole: tools/slope terrain --fill)",
               region, worst[4], worst[0], worst[1], worst[2], worst[3]);
}

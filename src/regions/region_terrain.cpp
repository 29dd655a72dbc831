/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_terrain.h"

#include "comm.h"
#include "constants.h"
#include "error.h"
#include "node_memory.h"
#include "rank_zero.h"
#include "style_argument.h"

using namespace LAMMPS_NS;
using Slope::FARTHEST;

static constexpr double DEFAULT_CELLS = 5.0;    // depth and headroom, in cells of the raster

/* ----------------------------------------------------------------------
   region ID terrain FILE.asc keyword value ...
------------------------------------------------------------------------- */

RegTerrain::RegTerrain(LAMMPS *lmp, int narg, char **arg) :
    FileRegion(lmp, narg, arg, {"depth", "headroom"})
{
  read(arg[2]);

  const double cells = DEFAULT_CELLS * elevation.cell;
  bottom = zmin - given("depth", cells);

  bboxflag = interior;
  extent_xlo = elevation.xlo;
  extent_xhi = elevation.xhi();
  extent_ylo = elevation.ylo;
  extent_yhi = elevation.yhi();
  extent_zlo = bottom;
  extent_zhi = zmax + given("headroom", cells);

  if (!(extent_xlo >= -FARTHEST && extent_xlo < extent_xhi && extent_xhi <= FARTHEST &&
        extent_ylo >= -FARTHEST && extent_ylo < extent_yhi && extent_yhi <= FARTHEST &&
        extent_zlo >= -FARTHEST && extent_zlo < extent_zhi && extent_zhi <= FARTHEST))
    error->all(
        FLERR,
        "Region terrain: {} with depth and headroom must have an extent within +-{:g}, got x "
        "{:.8g} to {:.8g}, y {:.8g} to {:.8g}, z {:.8g} to {:.8g}",
        arg[2], FARTHEST, extent_xlo, extent_xhi, extent_ylo, extent_yhi, extent_zlo, extent_zhi);

  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Region terrain {}: {} x {} cells of {:.8g}, x {:.8g} to {:.8g}, "
                   "y {:.8g} to {:.8g}, heights {:.8g} to {:.8g}, {} cells without data\n",
                   id, elevation.nx, elevation.ny, elevation.cell, extent_xlo, extent_xhi,
                   extent_ylo, extent_yhi, zmin, zmax, nodata);
}

RegTerrain::~RegTerrain() = default;

/* ----------------------------------------------------------------------
   one rank reads; its errors end the run on all ranks
------------------------------------------------------------------------- */

void RegTerrain::read(const char *path)
{
  double head[6];
  on_rank_zero(lmp, caller, [&]() {
    elevation = Slope::ElevationGrid::read(path);
    head[0] = elevation.xlo;
    head[1] = elevation.ylo;
    head[2] = elevation.cell;
    head[3] = elevation.zmin();
    head[4] = elevation.zmax();
    head[5] = elevation.count_nodata();
  });
  int size[2] = {elevation.nx, elevation.ny};
  MPI_Bcast(size, 2, MPI_INT, 0, world);
  MPI_Bcast(head, 6, MPI_DOUBLE, 0, world);
  elevation.nx = size[0];
  elevation.ny = size[1];
  elevation.xlo = head[0];
  elevation.ylo = head[1];
  elevation.cell = head[2];
  zmin = head[3];
  zmax = head[4];
  nodata = static_cast<int>(head[5]);
  if (comm->nprocs == 1) return;

  heights.reset(
      new NodeArray(lmp, static_cast<size_t>(size[0]) * size[1],
                    fmt::format("Region terrain: {}: {} x {} cells", path, size[0], size[1])));
  heights->fill(elevation.z.data());
  elevation.refer_to(heights->data());
}

/* ----------------------------------------------------------------------
   below the ground surface; no height (NaN) has nothing below it
------------------------------------------------------------------------- */

int RegTerrain::inside(double x, double y, double z)
{
  return z >= bottom && z <= elevation.height(x, y);
}

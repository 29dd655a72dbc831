/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_polygon.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "large_messages.h"
#include "rank_zero.h"
#include "requirements.h"

#include <vector>

using namespace LAMMPS_NS;

static constexpr double BIG = 1.0e20;    // what LAMMPS' regions write for INF

/* ----------------------------------------------------------------------
   region ID polygon FILE.csv keyword value ...
------------------------------------------------------------------------- */

RegPolygon::RegPolygon(LAMMPS *lmp, int narg, char **arg) : FileRegion(lmp, narg, arg)
{
  read(arg[2]);

  bboxflag = interior;
  extent_xlo = polygon.xlo;
  extent_xhi = polygon.xhi;
  extent_ylo = polygon.ylo;
  extent_yhi = polygon.yhi;
  extent_zlo = -BIG;
  extent_zhi = BIG;

  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Region polygon {}: {} rings, {} points, x {:.8g} to {:.8g}, "
                   "y {:.8g} to {:.8g}, area {:.8g}\n",
                   id, polygon.sizes.size(), polygon.xy.size() / 2, extent_xlo, extent_xhi,
                   extent_ylo, extent_yhi, polygon.area());
}

/* ----------------------------------------------------------------------
   region block refuses INF before there is a box; here that would forbid the intersection with a
   terrain that the box is made of, so that a box without end is found when it is used
------------------------------------------------------------------------- */

void RegPolygon::init()
{
  Region::init();
  if (domain->box_exist && (domain->boxlo[2] <= -BIG || domain->boxhi[2] >= BIG))
    error->all(FLERR,
               "Region polygon {} has no end in z: the simulation box needs one, e.g. create it on "
               "the region's intersection with a region terrain",
               id);
}

/* ----------------------------------------------------------------------
   one rank reads; its errors end the run on all ranks
------------------------------------------------------------------------- */

void RegPolygon::read(const char *path)
{
  on_rank_zero(lmp, caller, [&]() {
    polygon = Slope::Polygon::read(path, in_si(lmp));
  });

  std::vector<double> xy = polygon.xy;
  std::vector<int> sizes = polygon.sizes;
  broadcast(world, xy);
  broadcast(world, sizes);
  if (comm->me != 0) polygon = Slope::Polygon(xy, sizes);
}

/* ---------------------------------------------------------------------- */

int RegPolygon::inside(double x, double y, double /*z*/)
{
  return covers(x, y);
}

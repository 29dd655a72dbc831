/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_polygon.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "rank_zero.h"
#include "style_argument.h"

#include <cstring>
#include <vector>

using namespace LAMMPS_NS;

static constexpr double BIG = 1.0e20;    // what LAMMPS' regions write for INF

/* ----------------------------------------------------------------------
   region ID polygon FILE.csv keyword value ...
------------------------------------------------------------------------- */

RegPolygon::RegPolygon(LAMMPS *lmp, int narg, char **arg) : Region(lmp, narg, arg)
{
  if (narg < 3) error->all(FLERR, "Region polygon: file name of the rings is missing");

  std::vector<char *> rest;
  for (int iarg = 3, n; iarg < narg; iarg += n) {
    n = region_keyword(lmp, "Region polygon", "", narg - iarg, &arg[iarg]);
    if (strcmp(arg[iarg], "units") != 0) rest.insert(rest.end(), &arg[iarg], &arg[iarg] + n);
  }

  std::string units = "units", box = "box";
  rest.push_back(&units[0]);
  rest.push_back(&box[0]);
  options((int) rest.size(), rest.data());

  read(arg[2]);

  bboxflag = interior;
  extent_xlo = polygon.xlo;
  extent_xhi = polygon.xhi;
  extent_ylo = polygon.ylo;
  extent_yhi = polygon.yhi;
  extent_zlo = -BIG;
  extent_zhi = BIG;

  cmax = tmax = 0;

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
  on_rank_zero(lmp, "Region polygon", [&]() {
    polygon = Slope::Polygon::read(path);
  });

  std::vector<double> xy = polygon.xy;
  std::vector<int> sizes = polygon.sizes;
  int n[2] = {(int) xy.size(), (int) sizes.size()};
  MPI_Bcast(n, 2, MPI_INT, 0, world);
  xy.resize(n[0]);
  sizes.resize(n[1]);
  MPI_Bcast(xy.data(), n[0], MPI_DOUBLE, 0, world);
  MPI_Bcast(sizes.data(), n[1], MPI_INT, 0, world);
  if (comm->me != 0) polygon = Slope::Polygon(xy, sizes);
}

/* ---------------------------------------------------------------------- */

int RegPolygon::inside(double x, double y, double /*z*/)
{
  return covers(x, y);
}

/* ---------------------------------------------------------------------- */

int RegPolygon::surface_interior(double * /*x*/, double /*cutoff*/)
{
  return no_contacts();
}

/* ---------------------------------------------------------------------- */

int RegPolygon::surface_exterior(double * /*x*/, double /*cutoff*/)
{
  return no_contacts();
}

/* ---------------------------------------------------------------------- */

int RegPolygon::no_contacts()
{
  error->one(FLERR,
             "Region polygon {} has no smooth wall: fixed balls make walls, see fix "
             "wall/gran/balls",
             id);
  return 0;
}

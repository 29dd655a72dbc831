/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_options.h"

#include "elevation_grid.h"
#include "large_messages.h"
#include "node_memory.h"
#include "rank_zero.h"
#include "stl_file.h"
#include "style_argument.h"
#include "terrain_surface.h"
#include "text_file.h"
#include "triangle_mesh.h"

#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <utility>

using namespace LAMMPS_NS;
using namespace Slope;

static constexpr double TOO_LARGE = 100.0;    // largest sizes of a mesh, in those of the box
static constexpr double DOUBTED = 10.0;

/* ---------------------------------------------------------------------- */

SurfaceOptions::SurfaceOptions(LAMMPS *lmp, const std::string &_caller, int narg, char **arg) :
    Pointers(lmp), point{0.0, 0.0, 0.0}, every(0), caller(_caller), terrain(false), scale(1.0),
    lower(0.0), move{0.0, 0.0, 0.0}
{
  if (narg < 2)
    error->all(FLERR, "{}: needs TYPE and FILE.stl or terrain FILE.asc, got {} arguments", caller,
               narg);
  type = atom_type_argument(lmp, caller + " type", arg[0]);

  int iarg = 1;
  terrain = std::string(arg[iarg]) == "terrain";
  if (terrain && ++iarg == narg) error->all(FLERR, "{} terrain: FILE.asc is missing", caller);
  file = arg[iarg++];
  read_keywords(narg - iarg, &arg[iarg]);
  point.z -= lower;
}

/* ---------------------------------------------------------------------- */

void SurfaceOptions::read_keywords(int narg, char **arg)
{
  KeywordReader word(lmp, caller, narg, arg);
  const auto of_stl = [&](const char *keyword, const char *values) {
    const bool is_it = word.is(keyword, values);
    if (is_it && terrain)
      error->all(FLERR, "{}: {} is for STL files, a terrain stays where its file has it", caller,
                 keyword);
    return is_it;
  };
  while (word.next())
    if (of_stl("scale", "F"))
      scale = word.positive();
    else if (of_stl("move", "dx dy dz"))
      move = {word.number(1), word.number(2), word.number(3)};
    else if (of_stl("lower", "L"))
      lower = word.number();
    else if (word.is("point", "x y z"))
      point = {word.number(1), word.number(2), word.number(3)};
    else if (word.is("output", "PREFIX Nevery")) {
      output = word.text(1);
      every = word.whole_number(2);
      word.must(every >= 1, ">= 1", 2);
    } else
      word.unknown();
}

/* ----------------------------------------------------------------------
   one rank reads; its errors end the run on all ranks
------------------------------------------------------------------------- */

std::unique_ptr<TouchedSurface> SurfaceOptions::surface() const
{
  std::unique_ptr<TouchedSurface> made = terrain ? read_terrain() : read_stl();
  check_place(*made);
  return made;
}

std::unique_ptr<TouchedSurface> SurfaceOptions::read_stl() const
{
  StlFile stl;
  on_rank_zero(lmp, caller, [&]() {
    stl = StlFile::read(file, scale, moved(move, -lower, {0.0, 0.0, 1.0}));
  });
  broadcast(world, stl.triangles);
  MPI_Bcast(&stl.rounding, 1, MPI_DOUBLE, 0, world);
  const double n = static_cast<double>(stl.triangles.size());
  std::unique_ptr<TouchedSurface> made;
  on_all_ranks(lmp, caller, [&]() {
    made.reset(new TriangleMesh(stl.triangles));
  });
  made->rounding = stl.rounding;
  made->lower = lower;

  double area = 0.0;
  for (const Triangle &t : stl.triangles) area += t.area();
  const Vector &low = made->low(), &high = made->high();
  if (comm->me == 0) {
    utils::logmesg(lmp,
                   "{}: {}, area {:.6g}, x {:.8g} to {:.8g}, y {:.8g} to {:.8g}, z {:.8g} to "
                   "{:.8g}\n",
                   caller, counted(n, "triangle"), area, low.x, high.x, low.y, high.y,
                   low.z + lower, high.z + lower);
    if (stl.skipped)
      error->warning(FLERR, "{}: {} of the {:.0f} triangles of {} have no area and are skipped",
                     caller, stl.skipped, n + stl.skipped, file);
    if (stl.surplus > 0.0)
      error->warning(
          FLERR,
          "{}: {} should end after the {} that its head says, got {} more, which {} not read",
          caller, file, counted(n + stl.skipped, "triangle"), counted(stl.surplus, "byte"),
          stl.surplus == 1.0 ? "is" : "are");
  }
  return made;
}

std::unique_ptr<TouchedSurface> SurfaceOptions::read_terrain() const
{
  int size[2];
  double cell;
  std::unique_ptr<TerrainSurface> read;
  on_rank_zero(lmp, caller, [&]() {
    const ElevationGrid grid = ElevationGrid::read(file);
    size[0] = grid.nx;
    size[1] = grid.ny;
    cell = grid.cell;
    read.reset(new TerrainSurface(grid, file));
  });
  std::unique_ptr<TouchedSurface> made = shared(std::move(read));
  const Vector &low = made->low(), &high = made->high();
  if (comm->me == 0)
    utils::logmesg(
        lmp,
        "{}: smooth ground, {} x {} cells of {:.8g}, x {:.8g} to {:.8g}, y {:.8g} to {:.8g}, z "
        "{:.8g} to {:.8g}\n",
        caller, size[0], size[1], cell, low.x, high.x, low.y, high.y, low.z, high.z);
  return made;
}

/* ----------------------------------------------------------------------
   one copy of the heights for the ranks of a node
------------------------------------------------------------------------- */

namespace {
struct SharedTerrain : TerrainSurface {
  SharedTerrain(const About &about, std::unique_ptr<NodeArray> values_in) :
      TerrainSurface(about, values_in->data()), values(std::move(values_in))
  {
  }
  double memory_usage() const override { return values->bytes(); }

 private:
  std::unique_ptr<NodeArray> values;
};
}    // namespace

std::unique_ptr<TouchedSurface> SurfaceOptions::shared(std::unique_ptr<TerrainSurface> read) const
{
  if (comm->nprocs == 1) return std::move(read);
  TerrainSurface::About about;
  if (read) about = read->about();
  MPI_Bcast(&about, sizeof(about), MPI_BYTE, 0, world);
  std::unique_ptr<NodeArray> values(new NodeArray(
      lmp, static_cast<size_t>(about.nx) * about.ny,
      fmt::format("{}: {}: {} x {} cells", caller, file, about.nx - 2, about.ny - 2)));
  values->fill(read ? read->heights() : nullptr);
  return std::unique_ptr<TouchedSurface>(new SharedTerrain(about, std::move(values)));
}

/* ----------------------------------------------------------------------
   a file in millimetres: far too large, or nowhere near the balls
------------------------------------------------------------------------- */

void SurfaceOptions::check_place(const TouchedSurface &made) const
{
  const double low[3] = {made.low().x, made.low().y, made.low().z};
  const double high[3] = {made.high().x, made.high().y, made.high().z};
  double size = 0.0, box = 0.0;
  for (int d = 0; d < 3; d++) {
    size = std::max(size, high[d] - low[d]);
    box = std::max(box, domain->boxhi[d] - domain->boxlo[d]);
    const bool fixed = domain->boundary[d][0] < 2 && domain->boundary[d][1] < 2;
    const double from = domain->boxlo[d], to = domain->boxhi[d];
    if (fixed && (high[d] < from || low[d] > to))
      error->all(
          FLERR,
          "{}: the surface of {} must reach into the box, {} {:.8g} to {:.8g}, got {:.8g} to "
          "{:.8g}: is it in other units (scale 0.001) or another place (move)?",
          caller, file, "xyz"[d], from, to, low[d], high[d]);
  }
  if (size > TOO_LARGE * box)
    error->all(FLERR,
               "{}: the surface of {} must be at most {:g} times as large as the box, {:.6g}, got "
               "{:.6g}: is it in other units (scale 0.001)?",
               caller, file, TOO_LARGE, box, size);
  if (size > DOUBTED * box && comm->me == 0)
    error->warning(
        FLERR,
        "{}: the surface of {} is {:.3g} times as large as the box, {:.6g}: is it in other "
        "units (scale 0.001)?",
        caller, file, size / box, box);
}

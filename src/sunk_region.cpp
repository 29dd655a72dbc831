/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "sunk_region.h"

#include "domain.h"
#include "error.h"
#include "lammps_compat.h"
#include "region.h"
#include "sunk_surface.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr double PITCH = 0.125;    // between columns, in diameters or sinks
static constexpr int LOOKS = 32;       // columns along each side of the body that tell its ground
static constexpr double MOST = 0.9;    // of these must end at it
static constexpr double SAME = 1.0e-6;    // heights, in diameters

/* ---------------------------------------------------------------------- */

SunkRegion::SunkRegion(LAMMPS *lmp, const std::string &caller, const std::string &region_in,
                       int side_in, double sink_in, double diameter_in) :
    Pointers(lmp),
    region(region_in), side(side_in), sink(sink_in), diameter(diameter_in)
{
  boundary.reset(new RegionSurface(lmp, caller, region.c_str(), side, PITCH * diameter));
  if (side == RegionSurface::UPPER || !boundary->has_boundary()) return;
  find_columns();
  find_ground(caller);
  if (!ground.empty())
    top.reset(
        new RegionSurface(lmp, caller, ground.c_str(), RegionSurface::UPPER, PITCH * diameter));
}

SunkRegion::~SunkRegion() = default;

/* ----------------------------------------------------------------------
   some of the columns of the body, spread over its plan
------------------------------------------------------------------------- */

void SunkRegion::find_columns()
{
  for (int j = 0; j < LOOKS; j++)
    for (int i = 0; i < LOOKS; i++) {
      const double x = boundary->xlo + (i + 0.5) / LOOKS * (boundary->xhi - boundary->xlo);
      const double y = boundary->ylo + (j + 0.5) / LOOKS * (boundary->yhi - boundary->ylo);
      double z;
      if (boundary->height(x, y, z)) columns.insert(columns.end(), {x, y});
    }
}

/* ----------------------------------------------------------------------
   the ground that the body is part of: it ends above where the body does
------------------------------------------------------------------------- */

void SunkRegion::find_ground(const std::string &caller)
{
  const double step = PITCH * diameter;
  const RegionSurface upper(lmp, caller, region.c_str(), RegionSurface::UPPER, step);
  if (!upper.has_boundary()) return;

  double widest = 0.0;
  for (Region *candidate : compat::regions(lmp)) {
    if (region == candidate->id ||
        !RegionSurface::is_fit(candidate, RegionSurface::UPPER, boundary->xlo, boundary->xhi,
                               boundary->ylo, boundary->yhi))
      continue;
    const RegionSurface ends(lmp, caller, candidate->id, RegionSurface::UPPER, step);
    const double area = (ends.xhi - ends.xlo) * (ends.yhi - ends.ylo);
    if (area < widest || (area == widest && candidate->id >= ground)) continue;

    int known = 0, same = 0;
    for (size_t k = 0; k < columns.size(); k += 2) {
      double mine, its;
      if (!upper.height(columns[k], columns[k + 1], mine)) continue;
      known++;
      if (ends.height(columns[k], columns[k + 1], its) && std::fabs(mine - its) <= SAME * diameter)
        same++;
    }
    if (known == 0 || same < MOST * known) continue;
    widest = area;
    ground = candidate->id;
  }
}

bool SunkRegion::lies_in(const RegionSurface &others) const
{
  size_t common = 0;
  double z;
  for (size_t k = 0; k < columns.size(); k += 2)
    if (others.height(columns[k], columns[k + 1], z)) common += 2;
  return common > 0 && common >= MOST * columns.size();
}

/* ---------------------------------------------------------------------- */

double SunkRegion::lowest() const
{
  return surface->lowest();
}

double SunkRegion::floor() const
{
  if (top) return top->zlo;
  if (side == RegionSurface::UPPER) return boundary->zlo;
  return domain->box_exist && domain->boundary[2][0] < 2 ? domain->boxlo[2] : -HUGE_VAL;
}

/* ---------------------------------------------------------------------- */

void SunkRegion::build()
{
  if (surface) return;
  Slope::Bed bed = {boundary->xlo,
                    boundary->xhi,
                    boundary->ylo,
                    boundary->yhi,
                    nullptr,
                    nullptr,
                    side == RegionSurface::LOWER};
  bed.height = [this](double x, double y, double near, double &z) {
    return boundary->height_near(x, y, near, z);
  };
  if (top)
    bed.ground = [this](double x, double y, double near, double &z) {
      return top->height_near(x, y, near, z);
    };
  const double pitch = std::min(PITCH * std::max(sink, diameter), 0.5 * sink);
  surface.reset(new Slope::SunkSurface(bed, sink, pitch));
}

void SunkRegion::release()
{
  surface.reset();
}

void SunkRegion::plan(double &xlo, double &xhi, double &ylo, double &yhi) const
{
  xlo = surface->xlo;
  xhi = surface->xhi;
  ylo = surface->ylo;
  yhi = surface->yhi;
  if (!top) return;
  xlo = std::max(xlo, top->xlo);
  xhi = std::min(xhi, top->xhi);
  ylo = std::max(ylo, top->ylo);
  yhi = std::min(yhi, top->yhi);
}

bool SunkRegion::centre(double x, double y, double &z) const
{
  return surface->height(x, y, z);
}

bool SunkRegion::height(double x, double y, double &z) const
{
  double end;
  if (side == RegionSurface::UPPER && !boundary->height(x, y, end)) return false;
  if (!surface->height(x, y, z)) return false;
  return !top || (top->height(x, y, end) && z < end);
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "sunk_region.h"

#include "domain.h"
#include "lammps_compat.h"
#include "region.h"
#include "sunk_surface.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr double PITCH = 0.125;    // between columns, in diameters or sinks
static constexpr int LOOKS = 32;    // columns along each side of the body that tell its ground
static constexpr int ROUNDS = 3;
static constexpr double MOST = 0.9;       // of these must end at it
static constexpr double SAME = 1.0e-6;    // heights, in diameters

/* ---------------------------------------------------------------------- */

SunkRegion::SunkRegion(LAMMPS *lmp, const std::string &caller, const std::string &region_in,
                       int side_in, double sink_in, double diameter_in) :
    Pointers(lmp),
    region(region_in), side(side_in), sink(sink_in), diameter(diameter_in), flush(false)
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
   some of the columns of the body, spread over its plan; where few are found they are looked for
   again, around those
------------------------------------------------------------------------- */

void SunkRegion::find_columns()
{
  double lo[2] = {boundary->xlo, boundary->ylo}, hi[2] = {boundary->xhi, boundary->yhi};
  for (int round = 0; round < ROUNDS; round++) {
    const double dx = (hi[0] - lo[0]) / LOOKS, dy = (hi[1] - lo[1]) / LOOKS;
    columns.clear();
    double found[4] = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL}, z;
    for (int j = 0; j < LOOKS; j++)
      for (int i = 0; i < LOOKS; i++) {
        const double x = lo[0] + (i + 0.5) * dx, y = lo[1] + (j + 0.5) * dy;
        if (!boundary->height(x, y, z)) continue;
        columns.insert(columns.end(), {x, y});
        found[0] = std::min(found[0], x);
        found[1] = std::max(found[1], x);
        found[2] = std::min(found[2], y);
        found[3] = std::max(found[3], y);
      }
    if (columns.empty() || columns.size() > 4 * LOOKS) return;
    lo[0] = std::max(lo[0], found[0] - dx);
    hi[0] = std::min(hi[0], found[1] + dx);
    lo[1] = std::max(lo[1], found[2] - dy);
    hi[1] = std::min(hi[1], found[3] + dy);
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
    const RegionSurface other(lmp, caller, candidate->id, RegionSurface::UPPER, step);
    const double area = (other.xhi - other.xlo) * (other.yhi - other.ylo);
    if (area < widest || (area == widest && candidate->id >= ground)) continue;

    int known = 0, same = 0;
    for (size_t k = 0; k < columns.size(); k += 2) {
      double mine, its;
      if (!upper.height(columns[k], columns[k + 1], mine)) continue;
      known++;
      if (other.height(columns[k], columns[k + 1], its) && std::fabs(mine - its) <= SAME * diameter)
        same++;
    }
    if (known == 0 || same < MOST * known) continue;
    widest = area;
    ground = candidate->id;
    flush = same == known && known >= LOOKS;
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

// an upper boundary is not looked at everywhere

double SunkRegion::lowest() const
{
  if (side == RegionSurface::LOWER) return surface->lowest();
  const double dx = (boundary->xhi - boundary->xlo) / LOOKS;
  const double dy = (boundary->yhi - boundary->ylo) / LOOKS;
  double found = HUGE_VAL, z;
  for (int j = 0; j < LOOKS; j++)
    for (int i = 0; i < LOOKS; i++)
      if (boundary->height(boundary->xlo + (i + 0.5) * dx, boundary->ylo + (j + 0.5) * dy, z))
        found = std::min(found, z);
  return found - sink;
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
    double end;    // a search of the column from its bottom takes long
    if (flush && std::isnan(near) && top->height(x, y, end))
      return boundary->height_below(x, y, end, z);
    return boundary->height_near(x, y, near, z);
  };
  if (top)
    bed.ground = [this](double x, double y, double near, double &z) {
      return top->height_near(x, y, near, z);
    };
  const double size = side == RegionSurface::LOWER ? diameter : 0.5 * diameter;
  const double pitch = std::min(PITCH * std::max(sink, size), 0.5 * sink);
  surface.reset(new Slope::SunkSurface(bed, sink, pitch));
}

bool SunkRegion::stands(std::string &changed) const
{
  return boundary->stands(changed) && (!top || top->stands(changed));
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

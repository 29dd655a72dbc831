/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_surface.h"

#include "domain.h"
#include "error.h"
#include "lammps_compat.h"
#include "region.h"
#include "region_columns.h"
#include "region_intersect.h"
#include "region_marks.h"
#include "region_terrain.h"
#include "region_union.h"
#include "style_argument.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr int NEAR_STEPS = 16;
static constexpr double THIN =
    0.008;    // of a step: no part of a region, but two surfaces in one place

/* ---------------------------------------------------------------------- */

RegionSurface::RegionSurface(LAMMPS *lmp, const std::string &caller, const char *region_id,
                             int side, double step_in) :
    Pointers(lmp),
    terrain(nullptr)
{
  Region *const region = region_argument(lmp, caller, region_id);
  if (region->openflag)
    error->all(FLERR, "{} region {} must have no open faces, got some", caller, region_id);
  if (!region->bboxflag)
    error->all(FLERR, "{} region {} must have a bounding box, style {} has none here", caller,
               region_id, region->style);

  xlo = region->extent_xlo;
  xhi = region->extent_xhi;
  ylo = region->extent_ylo;
  yhi = region->extent_yhi;
  zlo = region->extent_zlo;
  zhi = region->extent_zhi;
  bounded = side == LOWER ? zlo > -UNBOUNDED : zhi < UNBOUNDED;

  double *lo[3] = {&xlo, &ylo, &zlo}, *hi[3] = {&xhi, &yhi, &zhi};
  for (int d = 0; d < 3; d++) {
    const double *boxlo = domain->triclinic ? domain->boxlo_bound : domain->boxlo;
    const double *boxhi = domain->triclinic ? domain->boxhi_bound : domain->boxhi;
    if (*lo[d] > -UNBOUNDED && *hi[d] < UNBOUNDED) continue;
    if (!domain->box_exist)
      error->all(FLERR,
                 "{} region {} must be bounded as long as there is no simulation box, got INF",
                 caller, region_id);
    if (*lo[d] <= -UNBOUNDED) *lo[d] = boxlo[d];
    if (*hi[d] >= UNBOUNDED) *hi[d] = boxhi[d];
  }

  lower = side == LOWER;
  step = step_in > 0.0 ? step_in : (zhi - zlo) / STEPS;

  // the upper boundary of a terrain is its elevation grid: no search

  if (side == UPPER && region->interior) terrain = dynamic_cast<RegTerrain *>(region);
  if (!terrain) columns = RegionColumns::of(lmp, region, {zlo, zhi, step});
  note_parts(region);
}

RegionSurface::~RegionSurface() = default;

/* ---------------------------------------------------------------------- */

void RegionSurface::note_parts(Region *part)
{
  made_of.push_back({part->id, part, region_marks(part)});
  if (dynamic_cast<RegIntersect *>(part) || dynamic_cast<RegUnion *>(part))
    for (Region *inner : compat::parts_of(lmp, part)) note_parts(inner);
}

bool RegionSurface::stands(std::string &changed) const
{
  for (const Part &part : made_of) {
    Region *const now = compat::find_region(lmp, part.id);
    if (now == part.region && region_marks(now) == part.marks) continue;
    changed = part.id;
    return false;
  }
  return true;
}

/* ---------------------------------------------------------------------- */

bool RegionSurface::height(double x, double y, double &z) const
{
  if (x < xlo || x > xhi || y < ylo || y > yhi || !(zlo <= zhi)) return false;

  if (terrain) {
    z = terrain->grid().height(x, y);
    return !std::isnan(z);
  }

  if (!column(x, y)) return false;
  z = lower ? parts.lowest().lo : parts.topmost().hi;
  return true;
}

// what is in the bounding box; false if that is nothing

bool RegionSurface::column(double x, double y) const
{
  columns->column(x, y, parts);
  if (parts.empty()) return false;
  parts.intersect(Slope::Interval{zlo, zhi});
  parts.ignore(THIN * step);
  return !parts.empty();
}

/* ----------------------------------------------------------------------
   of the part at the known height, or of the next one on the way into the region, not too far away
------------------------------------------------------------------------- */

bool RegionSurface::height_near(double x, double y, double near, double &z) const
{
  if (terrain || std::isnan(near)) return height(x, y, z);
  if (x < xlo || x > xhi || y < ylo || y > yhi) return false;
  if (!column(x, y)) return false;
  near = std::min(std::max(near, zlo), zhi);
  const double reach = NEAR_STEPS * step;
  for (size_t k = 0; k < parts.size(); k++) {
    const Slope::Interval &part = parts[lower ? k : parts.size() - 1 - k];
    const double end = lower ? part.lo : part.hi;
    if (lower ? part.hi < near : part.lo > near) continue;
    if (std::fabs(end - near) > reach) return false;
    z = end;
    return true;
  }
  return false;
}

bool RegionSurface::height_below(double x, double y, double top, double &z) const
{
  if (x < xlo || x > xhi || y < ylo || y > yhi) return false;
  if (!column(x, y)) return false;
  for (size_t k = parts.size(); k > 0; k--) {
    const Slope::Interval &part = parts[k - 1];
    if (part.lo >= top) continue;
    z = part.lo;
    return part.hi >= top - step;
  }
  return false;
}

/* ---------------------------------------------------------------------- */

bool RegionSurface::is_fit(const Region *r, int side, double xlo, double xhi, double ylo,
                           double yhi)
{
  if (r->dynamic || r->varshape || r->openflag || !r->bboxflag) return false;
  if (side == LOWER ? r->extent_zlo <= -UNBOUNDED : r->extent_zhi >= UNBOUNDED) return false;
  return r->extent_xlo <= xlo && r->extent_xhi >= xhi && r->extent_ylo <= ylo &&
      r->extent_yhi >= yhi;
}

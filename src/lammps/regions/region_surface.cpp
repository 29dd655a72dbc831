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
#include "region_shapes.h"
#include "region_union.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr double UNBOUNDED = 1.0e19;     // LAMMPS writes INF as 1e20
static constexpr double PRECISION = 1.0e-12;    // of the region's height
static constexpr double DEFAULT_STEPS = 1000.0;
static constexpr double ROUGHLY = 1.0e-3;    // of a step
static constexpr int NEAR_STEPS = 16;
static constexpr double THIN =
    0.008;    // of a step: no part of a region, but two surfaces in one place

/* ---------------------------------------------------------------------- */

RegionSurface::RegionSurface(LAMMPS *lmp, const std::string &caller, const char *region_id,
                             int side, double step_in) :
    Pointers(lmp),
    terrain(nullptr)
{
  region = compat::find_region(lmp, region_id);
  if (!region) error->all(FLERR, "{} region {} does not exist", caller, region_id);
  region->init();

  if (region->dynamic_check())
    error->all(FLERR, "{} region {} must not move, got one that moves or varies", caller,
               region_id);
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

  start = side == LOWER ? zlo : zhi;
  direction = side == LOWER ? 1.0 : -1.0;
  step = step_in > 0.0 ? step_in : (zhi - zlo) / DEFAULT_STEPS;

  // the upper boundary of a terrain is its elevation grid: no search

  if (side == UPPER && region->interior) terrain = dynamic_cast<RasterRegion *>(region);
  if (!terrain) columns = RegionColumns::of(lmp, region);
  note_parts(region);
}

RegionSurface::~RegionSurface() = default;

/* ---------------------------------------------------------------------- */

void RegionSurface::note_parts(Region *part)
{
  made_of.push_back({part->id, part, part->extent_zlo, part->extent_zhi});
  if (dynamic_cast<RegIntersect *>(part) || dynamic_cast<RegUnion *>(part))
    for (Region *inner : compat::parts_of(lmp, part)) note_parts(inner);
}

bool RegionSurface::stands(std::string &changed) const
{
  for (const Part &part : made_of) {
    const Region *now = compat::find_region(lmp, part.id);
    if (now == part.region &&
        (!now->bboxflag || (now->extent_zlo == part.zlo && now->extent_zhi == part.zhi)))
      continue;
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

  if (!columns) return search(x, y, z);
  if (!column(x, y)) return false;
  z = direction > 0.0 ? parts.lowest().lo : parts.topmost().hi;
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

/* ---------------------------------------------------------------------- */

bool RegionSurface::search(double x, double y, double &z) const
{
  // the first point inside, walking into the region

  const double length = zhi - zlo;
  double out = 0.0, in = 0.0;    // distance walked
  while (!inside(x, y, in)) {
    if (in >= length) return false;
    out = in;
    in = std::min(in + step, length);
  }

  return between(x, y, out, in, PRECISION * length, z);
}

/* ---------------------------------------------------------------------- */

bool RegionSurface::inside(double x, double y, double walked) const
{
  return region->match(x, y, start + direction * walked);
}

/* ----------------------------------------------------------------------
   of the part at the known height, or of the next one on the way into the region, not too far away
------------------------------------------------------------------------- */

bool RegionSurface::height_near(double x, double y, double near, double &z) const
{
  if (terrain || std::isnan(near)) return height(x, y, z);
  if (x < xlo || x > xhi || y < ylo || y > yhi) return false;
  if (!columns) return search_near(x, y, near, z);

  if (!column(x, y)) return false;
  near = std::min(std::max(near, zlo), zhi);
  const double reach = NEAR_STEPS * step;
  const bool lower = direction > 0.0;
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

bool RegionSurface::search_near(double x, double y, double near, double &z) const
{
  // from the known height walk out of the region or into it

  const double length = zhi - zlo;
  double here = 0.0, next = std::min(std::max(direction * (near - start), 0.0), length);
  const bool above = inside(x, y, next);
  bool passed = false;
  for (int k = 0; k < NEAR_STEPS && !passed; k++) {
    here = next;
    next += above ? -step : step;
    if (next < 0.0 || next > length) return height(x, y, z);
    passed = inside(x, y, next) != above;
  }
  if (!passed) return false;

  const double precision = ROUGHLY * step;
  return above ? between(x, y, next, here, precision, z) : between(x, y, here, next, precision, z);
}

/* ---------------------------------------------------------------------- */

bool RegionSurface::height_below(double x, double y, double top, double &z) const
{
  if (x < xlo || x > xhi || y < ylo || y > yhi) return false;
  if (!columns) return search_below(x, y, top, z);

  if (!column(x, y)) return false;
  for (size_t k = parts.size(); k > 0; k--) {
    const Slope::Interval &part = parts[k - 1];
    if (part.lo >= top) continue;
    z = part.lo;
    return part.hi >= top - step;
  }
  return false;
}

bool RegionSurface::search_below(double x, double y, double top, double &z) const
{
  double in = top - zlo - 0.5 * step;
  if (in < 0.0 || !inside(x, y, in)) return false;
  for (double out = in - step; out >= 0.0; in = out, out -= step)
    if (!inside(x, y, out)) return between(x, y, out, in, ROUGHLY * step, z);
  return height(x, y, z);
}

// the boundary between a point outside and one inside, distances walked, to a precision in m

bool RegionSurface::between(double x, double y, double out, double in, double precision,
                            double &z) const
{
  while (in - out > precision) {
    const double middle = 0.5 * (in + out);
    if (middle <= out || middle >= in) break;
    if (inside(x, y, middle))
      in = middle;
    else
      out = middle;
  }
  z = start + direction * in;
  return true;
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

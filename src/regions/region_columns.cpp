/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_columns.h"

#include "lammps_compat.h"
#include "region.h"
#include "region_intersect.h"
#include "region_polygon.h"
#include "region_terrain.h"
#include "region_union.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using Slope::Interval;
using Slope::Intervals;

/* ---------------------------------------------------------------------- */

// what a shape takes of the line at x,y

struct Terrain {
  const Slope::ElevationGrid *grid;
  double bottom;
};

static Interval column_of(const Terrain &t, double x, double y)
{
  return {t.bottom, t.grid->height(x, y)};
}

static Interval column_of(const RegPolygon *prism, double x, double y)
{
  return prism->covers(x, y) ? Interval::all() : Interval::none();
}

static Interval column_of(const compat::Sphere &s, double x, double y)
{
  return Slope::column_of_sphere(x - s.x, y - s.y, s.z, s.radius);
}

static Interval column_of(const compat::Block &b, double x, double y)
{
  const bool in = x >= b.lo[0] && x <= b.hi[0] && y >= b.lo[1] && y <= b.hi[1];
  return in ? Interval{b.lo[2], b.hi[2]} : Interval::none();
}

static Interval column_of(const compat::Plane &p, double x, double y)
{
  return Slope::column_of_half_space(x - p.x, y - p.y, p.z, p.normal[0], p.normal[1], p.normal[2]);
}

static Interval column_of(const compat::Cylinder &c, double x, double y)
{
  if (c.axis == 'z') {
    const double dx = x - c.c1, dy = y - c.c2;
    const bool in = std::sqrt(dx * dx + dy * dy) <= c.radius;
    return in ? Interval{c.lo, c.hi} : Interval::none();
  }
  const double along = c.axis == 'x' ? x : y, across = c.axis == 'x' ? y : x;
  const bool in = along >= c.lo && along <= c.hi;
  return in ? Slope::column_of_sphere(across - c.c1, 0.0, c.c2, c.radius) : Interval::none();
}

namespace LAMMPS_NS {

template <class Shape> class ShapeColumns : public RegionColumns {
 public:
  explicit ShapeColumns(const Shape &s, int rank = 0) : RegionColumns(rank), shape(s) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    found.set(column_of(shape, x, y));
  }

 private:
  const Shape shape;
};

// a style of which only the inside is known; the ends of what is found are exact

class SearchedColumns : public RegionColumns {
 public:
  SearchedColumns(Region *r, const Search &s) : RegionColumns(3), region(r), search(s)
  {
    if (!r->bboxflag) return;
    search.zlo = std::max(s.zlo, r->extent_zlo);
    search.zhi = std::min(s.zhi, r->extent_zhi);
  }

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    found.set(Interval::none());
    double z = search.zlo, lo = z;
    bool in = has(x, y, z);
    for (bigint k = 1; z < search.zhi; k++) {
      const double next = std::min(search.zlo + k * search.step, search.zhi);
      const bool was = in;
      in = has(x, y, next);
      if (in && !was) lo = edge(x, y, z, next);
      if (was && !in) found.append({lo, edge(x, y, next, z)});
      z = next;
    }
    if (in) found.append({lo, z});
  }

 private:
  Region *const region;
  Search search;

  bool has(double x, double y, double z) const { return (region->match(x, y, z) != 0) == side_in; }

  double edge(double x, double y, double out, double in) const
  {
    for (double middle = 0.5 * (out + in); middle != out && middle != in; middle = 0.5 * (out + in))
      (has(x, y, middle) ? in : out) = middle;
    return in;
  }
};

// an intersection or a union; the parts that take the least time come first

class CombinedColumns : public RegionColumns {
 public:
  CombinedColumns(bool intersect_in, std::vector<std::unique_ptr<RegionColumns>> parts_in) :
      RegionColumns(2), intersect(intersect_in), parts(std::move(parts_in))
  {
    std::stable_sort(
        parts.begin(), parts.end(),
        [](const std::unique_ptr<RegionColumns> &a, const std::unique_ptr<RegionColumns> &b) {
          return a->cost < b->cost;
        });
  }

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    parts[0]->column(x, y, found);
    for (size_t k = 1; k < parts.size(); k++) {
      if (intersect && found.empty()) return;
      parts[k]->column(x, y, part);
      if (intersect)
        found.intersect(part);
      else
        found.unite(part);
    }
  }

 private:
  const bool intersect;
  std::vector<std::unique_ptr<RegionColumns>> parts;
  mutable Intervals part;    // keeps its memory
};

}    // namespace LAMMPS_NS

/* ---------------------------------------------------------------------- */

void RegionColumns::column(double x, double y, Intervals &found) const
{
  if (everything) return found.set(Interval::all());
  inside(x, y, found);
  if (!side_in) found.complement();
}

/* ---------------------------------------------------------------------- */

std::unique_ptr<RegionColumns> RegionColumns::of(LAMMPS *lmp, Region *region, const Search &search)
{
  auto columns = make_shape(lmp, region, search);
  columns->side_in = region->interior;
  columns->everything = region->openflag;    // as Region::match() has it
  return columns;
}

// false if the region is no such shape

template <class Shape>
static bool take_shape(Region *region, std::unique_ptr<RegionColumns> &columns)
{
  Shape shape;
  if (!compat::shape(region, shape)) return false;
  columns.reset(new ShapeColumns<Shape>(shape));
  return true;
}

std::unique_ptr<RegionColumns> RegionColumns::make_shape(LAMMPS *lmp, Region *region,
                                                         const Search &search)
{
  typedef std::unique_ptr<RegionColumns> Columns;
  if (const auto *raster = dynamic_cast<RegTerrain *>(region))
    return Columns(new ShapeColumns<Terrain>({&raster->grid(), region->extent_zlo}, 1));
  if (const auto *prism = dynamic_cast<RegPolygon *>(region))
    return Columns(new ShapeColumns<const RegPolygon *>(prism));
  Columns columns;
  if (take_shape<compat::Sphere>(region, columns) || take_shape<compat::Block>(region, columns) ||
      take_shape<compat::Plane>(region, columns) || take_shape<compat::Cylinder>(region, columns))
    return columns;

  const bool intersect = dynamic_cast<RegIntersect *>(region);
  if (!intersect && !dynamic_cast<RegUnion *>(region))
    return Columns(new SearchedColumns(region, search));
  std::vector<Columns> parts;
  for (Region *part : compat::parts_of(lmp, region)) parts.push_back(of(lmp, part, search));
  return Columns(new CombinedColumns(intersect, std::move(parts)));
}

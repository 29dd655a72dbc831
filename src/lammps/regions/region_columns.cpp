/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_columns.h"

#include "lammps_compat.h"
#include "region.h"
#include "region_intersect.h"
#include "region_shapes.h"
#include "region_union.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using Slope::Interval;
using Slope::Intervals;

/* ---------------------------------------------------------------------- */

namespace LAMMPS_NS {

class TerrainColumns : public RegionColumns {
 public:
  TerrainColumns(const RasterRegion &r, double _bottom) : grid(r.grid()), bottom(_bottom) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    found.set({bottom, grid.height(x, y)});
  }
  int cost() const override { return 1; }

 private:
  const Slope::ElevationGrid &grid;
  const double bottom;
};

class PrismColumns : public RegionColumns {
 public:
  explicit PrismColumns(const PrismRegion &r) : prism(r) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    found.set(prism.covers(x, y) ? Interval::all() : Interval::none());
  }

 private:
  const PrismRegion &prism;
};

class SphereColumns : public RegionColumns {
 public:
  explicit SphereColumns(const compat::Sphere &s) : sphere(s) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    found.set(Slope::column_of_sphere(x - sphere.x, y - sphere.y, sphere.z, sphere.radius));
  }

 private:
  const compat::Sphere sphere;
};

class BlockColumns : public RegionColumns {
 public:
  explicit BlockColumns(const compat::Block &b) : block(b) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    const bool in = x >= block.lo[0] && x <= block.hi[0] && y >= block.lo[1] && y <= block.hi[1];
    found.set(in ? Interval{block.lo[2], block.hi[2]} : Interval::none());
  }

 private:
  const compat::Block block;
};

class PlaneColumns : public RegionColumns {
 public:
  explicit PlaneColumns(const compat::Plane &p) : plane(p) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    found.set(Slope::column_of_half_space(x - plane.x, y - plane.y, plane.z, plane.normal[0],
                                          plane.normal[1], plane.normal[2]));
  }

 private:
  const compat::Plane plane;
};

class CylinderColumns : public RegionColumns {
 public:
  explicit CylinderColumns(const compat::Cylinder &c) : cylinder(c) {}

 protected:
  void inside(double x, double y, Intervals &found) const override
  {
    const compat::Cylinder &c = cylinder;
    if (c.axis == 'z') {
      const double dx = x - c.c1, dy = y - c.c2;
      const bool in = std::sqrt(dx * dx + dy * dy) <= c.radius;
      return found.set(in ? Interval{c.lo, c.hi} : Interval::none());
    }
    const double along = c.axis == 'x' ? x : y, across = c.axis == 'x' ? y : x;
    const bool in = along >= c.lo && along <= c.hi;
    found.set(in ? Slope::column_of_sphere(across - c.c1, 0.0, c.c2, c.radius) : Interval::none());
  }

 private:
  const compat::Cylinder cylinder;
};

// a style of which only the inside is known; the ends of what is found are exact

class SearchedColumns : public RegionColumns {
 public:
  SearchedColumns(Region *r, const Search &s) : region(r), search(s)
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
  int cost() const override { return 3; }

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
      intersect(intersect_in), parts(std::move(parts_in))
  {
    std::stable_sort(
        parts.begin(), parts.end(),
        [](const std::unique_ptr<RegionColumns> &a, const std::unique_ptr<RegionColumns> &b) {
          return a->cost() < b->cost();
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
  int cost() const override { return 2; }

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

std::unique_ptr<RegionColumns> RegionColumns::make_shape(LAMMPS *lmp, Region *region,
                                                         const Search &search)
{
  typedef std::unique_ptr<RegionColumns> Columns;
  compat::Sphere sphere;
  compat::Block block;
  compat::Plane plane;
  compat::Cylinder cylinder;
  if (auto *raster = dynamic_cast<RasterRegion *>(region))
    return Columns(new TerrainColumns(*raster, region->extent_zlo));
  if (auto *prism = dynamic_cast<PrismRegion *>(region)) return Columns(new PrismColumns(*prism));
  if (compat::shape(region, sphere)) return Columns(new SphereColumns(sphere));
  if (compat::shape(region, block)) return Columns(new BlockColumns(block));
  if (compat::shape(region, plane)) return Columns(new PlaneColumns(plane));
  if (compat::shape(region, cylinder)) return Columns(new CylinderColumns(cylinder));

  const bool intersect = dynamic_cast<RegIntersect *>(region);
  if (!intersect && !dynamic_cast<RegUnion *>(region))
    return Columns(new SearchedColumns(region, search));
  std::vector<Columns> parts;
  for (Region *part : compat::parts_of(lmp, region)) parts.push_back(of(lmp, part, search));
  return Columns(new CombinedColumns(intersect, std::move(parts)));
}

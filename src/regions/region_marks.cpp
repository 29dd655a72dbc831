/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "region_marks.h"

#include "file_region.h"
#include "lammps_compat.h"

#include "region_intersect.h"
#include "region_union.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr int PLACES = 1024;
static constexpr double SPREAD[3] = {0.8191725133961645, 0.6710436067037893,
                                     0.5497004779019703};    // evenly, in three dimensions

typedef std::vector<double> Marks;

/* ---------------------------------------------------------------------- */

static Marks numbers_of(const compat::Sphere &s)
{
  return {s.x, s.y, s.z, s.radius};
}

static Marks numbers_of(const compat::Block &b)
{
  return {b.lo[0], b.lo[1], b.lo[2], b.hi[0], b.hi[1], b.hi[2]};
}

static Marks numbers_of(const compat::Plane &p)
{
  return {p.x, p.y, p.z, p.normal[0], p.normal[1], p.normal[2]};
}

static Marks numbers_of(const compat::Cylinder &c)
{
  return {c.axis + 0.0, c.c1, c.c2, c.radius, c.lo, c.hi};
}

template <class Shape> static bool take_numbers(Region *region, Marks &marks)
{
  Shape shape;
  if (!compat::shape(region, shape)) return false;
  const Marks numbers = numbers_of(shape);
  marks.insert(marks.end(), numbers.begin(), numbers.end());
  return true;
}

/* ----------------------------------------------------------------------
   which of the places are inside, 32 in a number
------------------------------------------------------------------------- */

static void look_inside(Region *r, Marks &marks)
{
  const double lo[3] = {r->extent_xlo, r->extent_ylo, r->extent_zlo};
  const double hi[3] = {r->extent_xhi, r->extent_yhi, r->extent_zhi};
  for (int k = 0; k < PLACES; k++) {
    double x[3], whole;
    for (int d = 0; d < 3; d++) x[d] = lo[d] + std::modf(SPREAD[d] * k, &whole) * (hi[d] - lo[d]);
    if (k % 32 == 0) marks.push_back(0.0);
    marks.back() += std::ldexp(r->match(x[0], x[1], x[2]) != 0, k % 32);
  }
}

/* ---------------------------------------------------------------------- */

Marks LAMMPS_NS::region_marks(Region *r)
{
  Marks marks = {r->interior + 0.0, r->openflag + 0.0, r->bboxflag + 0.0, r->dynamic + 0.0,
                 r->varshape + 0.0};
  for (const char *c = r->style; *c; c++) marks.push_back(*c);
  if (r->bboxflag)
    marks.insert(
        marks.end(),
        {r->extent_xlo, r->extent_xhi, r->extent_ylo, r->extent_yhi, r->extent_zlo, r->extent_zhi});
  if (const auto *of_file = dynamic_cast<FileRegion *>(r))
    marks.push_back(of_file->number);
  else if (!take_numbers<compat::Sphere>(r, marks) && !take_numbers<compat::Block>(r, marks) &&
           !take_numbers<compat::Plane>(r, marks) && !take_numbers<compat::Cylinder>(r, marks) &&
           !dynamic_cast<RegIntersect *>(r) && !dynamic_cast<RegUnion *>(r) && r->bboxflag)
    look_inside(r, marks);
  return marks;
}

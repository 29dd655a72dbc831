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

using namespace LAMMPS_NS;

static constexpr int PLACES = 1024;
static constexpr double SPREAD[3] = {0.8191725133961645, 0.6710436067037893,
                                     0.5497004779019703};    // evenly, in three dimensions

typedef std::vector<double> Marks;

/* ---------------------------------------------------------------------- */

template <class Shape> static bool take_numbers(Region *region, Marks &marks)
{
  Shape shape;
  if (!compat::shape(region, shape)) return false;
  const auto *const numbers = reinterpret_cast<const double *>(&shape);
  marks.insert(marks.end(), numbers, numbers + sizeof(shape) / sizeof(double));
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

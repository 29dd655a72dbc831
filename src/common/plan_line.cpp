// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "plan_line.h"

#include "constants.h"
#include "number_rows.h"
#include "text_file.h"

#include <algorithm>
#include <cmath>

using namespace Slope;

/* ---------------------------------------------------------------------- */

PlanLine::PlanLine(const std::vector<double> &_xy) :
    xy(_xy), xlo(HUGE_VAL), xhi(-HUGE_VAL), ylo(HUGE_VAL), yhi(-HUGE_VAL)
{
  for (size_t k = 0; k < xy.size(); k += 2) {
    start.push_back(k == 0 ? 0.0
                           : start.back() + std::hypot(xy[k] - xy[k - 2], xy[k + 1] - xy[k - 1]));
    xlo = std::min(xlo, xy[k]);
    xhi = std::max(xhi, xy[k]);
    ylo = std::min(ylo, xy[k + 1]);
    yhi = std::max(yhi, xy[k + 1]);
  }
}

/* ---------------------------------------------------------------------- */

PlanLine PlanLine::read(const std::string &path, bool si)
{
  std::vector<double> points;
  read_number_rows(path, {"xy", "x y or x,y", si, 1.0}, [&](const NumberRow &row) {
    const double x = row.values[0], y = row.values[1];
    if (!(std::fabs(x) <= FARTHEST && std::fabs(y) <= FARTHEST))
      throw line_error(path, row.line,
                       "x and y must be within +-" + number_text(FARTHEST) + ", got " +
                           number_text(x) + " " + number_text(y));
    const size_t n = points.size();
    if (n > 0 && row.apart)
      throw line_error(path, row.line,
                       "must be the next point of one line, without an empty line before it, got "
                       "another line at " +
                           number_text(x) + " " + number_text(y));
    if (n > 0 && x == points[n - 2] && y == points[n - 1])
      throw line_error(path, row.line,
                       "two points in a row must differ, got " + number_text(x) + " " +
                           number_text(y) + " twice");
    points.push_back(x);
    points.push_back(y);
  });
  if (points.size() < 4)
    throw std::runtime_error(path + ": must hold at least 2 points x y of a line, got " +
                             std::to_string(points.size() / 2));
  return PlanLine(points);
}

/* ----------------------------------------------------------------------
   to tell one line from another, also from the same one in the other direction
------------------------------------------------------------------------- */

double PlanLine::checksum() const
{
  double sum = 0.0, x_weight = 0.0, y_weight = 0.0;
  for (size_t k = 0; k < xy.size(); k += 2) {
    x_weight = std::fmod(x_weight + GOLDEN, 1.0);
    y_weight = std::fmod(y_weight + 0.4142135623730950, 1.0);
    sum += (1.0 + x_weight) * xy[k] + (1.0 + y_weight) * xy[k + 1];
  }
  return sum;
}

double PlanLine::largest() const
{
  double most = 0.0;
  for (const double one : xy) most = std::max(most, std::fabs(one));
  return most;
}

/* ----------------------------------------------------------------------
   twice the area of the triangle a b c: > 0 if c is to the left of the line from a to b
------------------------------------------------------------------------- */

static double left_of(const double *a, const double *b, const double *c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* ----------------------------------------------------------------------
   All places are shifted to the east by next to nothing, and to the north by even less: none is then
   on a line. Whether they were is known exactly for lines along x and y, and elsewhere to rounding.
   Each question has the same answer whenever it is asked of the same points: of the end of one path
   and the start of the next, and of a corner for both pieces that meet there.
------------------------------------------------------------------------- */

static bool place_is_left(double area, const double *p, const double *q)
{
  if (area != 0.0) return area > 0.0;
  return q[1] != p[1] ? q[1] < p[1] : q[0] > p[0];
}

static bool corner_is_left(double area, const double *from, const double *to)
{
  if (area != 0.0) return area > 0.0;
  return to[1] != from[1] ? to[1] > from[1] : to[0] < from[0];
}

/* ---------------------------------------------------------------------- */

void PlanLine::cross(const double *from, const double *to, std::vector<Crossing> &found) const
{
  if (std::max(from[0], to[0]) < xlo || std::min(from[0], to[0]) > xhi ||
      std::max(from[1], to[1]) < ylo || std::min(from[1], to[1]) > yhi)
    return;

  const size_t before = found.size();
  for (size_t k = 0; k + 1 < start.size(); k++) {
    const double *p = &xy[2 * k], *q = p + 2;
    const double a = left_of(p, q, from), b = left_of(p, q, to);
    const bool left = place_is_left(a, p, q);
    if (left == place_is_left(b, p, q)) continue;
    const double c = left_of(from, to, p), d = left_of(from, to, q);
    if (corner_is_left(c, from, to) == corner_is_left(d, from, to)) continue;
    const double part = c / (c - d);
    found.push_back({a / (a - b), start[k] + part * (start[k + 1] - start[k]),
                     p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1]), left ? 1 : -1});
  }
  std::sort(found.begin() + before, found.end(), [](const Crossing &one, const Crossing &two) {
    return one.passed < two.passed;
  });
}

/* ---------------------------------------------------------------------- */

static double square_of_distance(const double *a, const double *b)
{
  const double dx = a[0] - b[0], dy = a[1] - b[1];
  return dx * dx + dy * dy;
}

bool PlanLine::is_near(const double *place, double reach) const
{
  return is_near(place, reach, 0, start.size() - 1);
}

/* ----------------------------------------------------------------------
   From the first point to the last one: none of the way is farther from the point in the middle than
   the longer half, so that most places need one comparison.
------------------------------------------------------------------------- */

bool PlanLine::is_near(const double *place, double reach, size_t first, size_t last) const
{
  const size_t middle = first + (last - first) / 2;
  const double *p = &xy[2 * middle], *q = &xy[2 * last];
  const double far = reach + std::max(start[middle] - start[first], start[last] - start[middle]);
  if (square_of_distance(place, p) > far * far) return false;
  if (middle > first)
    return is_near(place, reach, first, middle) || is_near(place, reach, middle, last);

  const double dx = q[0] - p[0], dy = q[1] - p[1];
  const double part = ((place[0] - p[0]) * dx + (place[1] - p[1]) * dy) / (dx * dx + dy * dy);
  const double within = std::min(1.0, std::max(0.0, part));
  const double nearest[2] = {p[0] + within * dx, p[1] + within * dy};
  return !(square_of_distance(place, nearest) > reach * reach);    // near, too, if it has no length
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "motion_record.h"

#include "number_rows.h"
#include "text_file.h"

#include <algorithm>
#include <cmath>

using namespace Slope;

static constexpr double LARGEST = 1.0e9;    // of times and accelerations: their products are finite

/* ----------------------------------------------------------------------
   the integrals at the points: the acceleration's is a trapezoid, and that of the velocity follows
   from the same straight line
------------------------------------------------------------------------- */

MotionRecord::MotionRecord(const std::vector<Point> &_points, double _scale) :
    points(_points), v(_points), d(_points), scale(_scale)
{
  for (size_t k = 0; k < points.size(); k++)
    for (int c = 0; c < 3; c++) {
      if (k == 0) {
        v[k].a[c] = d[k].a[c] = 0.0;
        continue;
      }
      const double h = points[k].t - points[k - 1].t;
      const double a0 = points[k - 1].a[c], a1 = points[k].a[c];
      v[k].a[c] = v[k - 1].a[c] + 0.5 * h * (a0 + a1);
      d[k].a[c] = d[k - 1].a[c] + h * (v[k - 1].a[c] + h * (2.0 * a0 + a1) / 6.0);
    }
}

/* ---------------------------------------------------------------------- */

MotionRecord MotionRecord::read(const std::string &path, double scale, bool si)
{
  std::vector<Point> points;
  read_number_rows(path, {"txyz", "t ax ay az", si, scale}, [&](const NumberRow &row) {
    const Point p = {row.values[0], {row.values[1], row.values[2], row.values[3]}};
    for (const double value : row.values)
      if (std::fabs(value) > LARGEST)
        throw line_error(path, row.line,
                         "numbers must be within +-" + number_text(LARGEST) + ", got " +
                             number_text(value));
    const size_t n = points.size();
    if (n > 0 && p.t < points[n - 1].t)
      throw line_error(path, row.line,
                       "times must not fall, got " + number_text(p.t) + " after " +
                           number_text(points[n - 1].t));
    if (n > 1 && p.t == points[n - 2].t)
      throw line_error(path, row.line,
                       "at most two lines may have the same time, a jump, got a third one of " +
                           number_text(p.t));
    points.push_back(p);
  });
  if (points.size() < 2)
    throw std::runtime_error(path + ": must hold at least 2 lines t ax ay az, got " +
                             std::to_string(points.size()));
  return MotionRecord(points, scale);
}

/* ---------------------------------------------------------------------- */

int MotionRecord::find(double t, double &passed, double &share) const
{
  const auto next =
      std::upper_bound(points.begin(), points.end(), t, [](double time, const Point &p) {
        return time < p.t;
      });
  const int k = (int) (next - points.begin()) - 1;
  passed = share = 0.0;
  if (k < 0) return k;
  passed = t - points[k].t;
  if (next != points.end()) share = passed / (next->t - points[k].t);
  return k;
}

/* ---------------------------------------------------------------------- */

void MotionRecord::acceleration(double t, double *a) const
{
  double passed, share;
  const int k = find(t, passed, share);
  const bool inside = k >= 0 && k + 1 < (int) points.size();
  for (int c = 0; c < 3; c++)
    a[c] = inside ? scale * (points[k].a[c] + share * (points[k + 1].a[c] - points[k].a[c])) : 0.0;
}

/* ---------------------------------------------------------------------- */

void MotionRecord::velocity(double t, double *out) const
{
  double passed, share;
  const int k = find(t, passed, share);
  const bool inside = k >= 0 && k + 1 < (int) points.size();
  for (int c = 0; c < 3; c++) {
    out[c] = k < 0 ? 0.0 : v[k].a[c];
    if (inside) {
      const double a0 = points[k].a[c], rise = points[k + 1].a[c] - a0;
      out[c] += passed * (a0 + 0.5 * share * rise);
    }
    out[c] *= scale;
  }
}

/* ---------------------------------------------------------------------- */

void MotionRecord::displacement(double t, double *out) const
{
  double passed, share;
  const int k = find(t, passed, share);
  const bool inside = k >= 0 && k + 1 < (int) points.size();
  for (int c = 0; c < 3; c++) {
    out[c] = k < 0 ? 0.0 : d[k].a[c] + passed * v[k].a[c];    // after the end: on and on
    if (inside) {
      const double a0 = points[k].a[c], rise = points[k + 1].a[c] - a0;
      out[c] += passed * passed * (0.5 * a0 + share * rise / 6.0);
    }
    out[c] *= scale;
  }
}

/* ---------------------------------------------------------------------- */

double MotionRecord::peak() const
{
  double most = 0.0;
  for (const Point &p : points)
    most = std::max(most, p.a[0] * p.a[0] + p.a[1] * p.a[1] + p.a[2] * p.a[2]);
  return std::fabs(scale) * std::sqrt(most);
}

/* ---------------------------------------------------------------------- */

double MotionRecord::checksum() const
{
  double sum = scale * points.size();
  double weight = 1.0;
  for (const Point &p : points) {
    sum += weight * (p.t + 3.0 * p.a[0] + 5.0 * p.a[1] + 7.0 * p.a[2]);
    weight = weight < 1000.0 ? weight + 1.0 : 1.0;
  }
  return sum;
}

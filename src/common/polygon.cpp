// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "polygon.h"

#include "constants.h"
#include "number_rows.h"
#include "text_file.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

using namespace Slope;

static constexpr double MOST_PARTS = 64.0;     // of edges in strips, per edge: bounds the memory
static constexpr double ROUNDING = 4.0e-16;    // relative error of a determinant's terms

namespace {

struct Point {
  double x, y;
  bool operator==(const Point &p) const { return x == p.x && y == p.y; }
};

struct Segment {
  Point a, b;
  int ring;
  int line;          // in the file, of point a
  int next, prev;    // edges of the same ring that share a point with it

  double xmin() const { return std::min(a.x, b.x); }
  double xmax() const { return std::max(a.x, b.x); }
  double ymin() const { return std::min(a.y, b.y); }
  double ymax() const { return std::max(a.y, b.y); }
};

struct Rings {
  std::vector<std::vector<Point>> points;
  std::vector<std::vector<int>> lines;
};

Rings read_rings(const std::string &path, bool si)
{
  Rings rings;
  read_number_rows(path, {"xy", "x,y", si, 1.0}, [&](const NumberRow &row) {
    const Point p = {row.values[0], row.values[1]};
    if (!(std::fabs(p.x) <= FARTHEST && std::fabs(p.y) <= FARTHEST))
      throw line_error(path, row.line,
                       "x and y must be within +-" + number_text(FARTHEST) + ", got " +
                           number_text(p.x) + "," + number_text(p.y));
    if (row.apart || rings.points.empty()) {
      rings.points.emplace_back();
      rings.lines.emplace_back();
    }
    if (!rings.points.back().empty() && rings.points.back().back() == p) return;
    rings.points.back().push_back(p);
    rings.lines.back().push_back(row.line);
  });
  if (rings.points.empty())
    throw std::runtime_error(path + ": must hold a ring of points x,y, it has none");

  for (size_t r = 0; r < rings.points.size(); r++) {
    std::vector<Point> &points = rings.points[r];
    if (points.size() > 1 && points.front() == points.back()) {
      points.pop_back();
      rings.lines[r].pop_back();
    }
    if (points.size() < 3)
      throw line_error(path, rings.lines[r][0],
                       "a ring must have at least 3 points, got " + std::to_string(points.size()));
  }
  return rings;
}

// A number of twice the digits, hi + lo: enough for the sign of a determinant of coordinates, so
// that a polygon that other programs take for valid is valid here

struct Exact {
  double hi, lo;
};

Exact difference(double a, double b)
{
  const double hi = a - b;
  const double part = hi - a;
  return {hi, (a - (hi - part)) - (b + part)};
}

Exact product(const Exact &a, const Exact &b)
{
  const double most = a.hi * b.hi;
  const double rest = std::fma(a.hi, b.hi, -most) + (a.hi * b.lo + a.lo * b.hi);
  const double hi = most + rest;
  return {hi, rest - (hi - most)};
}

// On which side of the line from a to b is c? 1: left, -1: right, 0: on it

int side(const Point &a, const Point &b, const Point &c)
{
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double bound = ROUNDING * (std::fabs(left) + std::fabs(right));
  if (left - right > bound) return 1;
  if (left - right < -bound) return -1;

  const Exact l = product(difference(b.x, a.x), difference(c.y, a.y));
  const Exact r = product(difference(b.y, a.y), difference(c.x, a.x));
  if (l.hi != r.hi) return l.hi > r.hi ? 1 : -1;
  return l.lo > r.lo ? 1 : l.lo < r.lo ? -1 : 0;
}

// Whether two edges meet where they may not. Edges of one ring: anywhere but in the point that
// neighbours share. Edges of two rings: only a true crossing is an error, rings may touch.

bool meet(const Segment &s, const Segment &t, bool neighbours)
{
  if (neighbours) {
    const Point &shared = s.b == t.a ? s.b : s.a;
    const Point &p = s.b == t.a ? s.a : s.b;
    const Point &q = s.b == t.a ? t.b : t.a;
    const double same = (p.x - shared.x) * (q.x - shared.x) + (p.y - shared.y) * (q.y - shared.y);
    return side(p, shared, q) == 0 && same > 0.0;
  }
  const int c = side(s.a, s.b, t.a) * side(s.a, s.b, t.b);
  const int d = side(t.a, t.b, s.a) * side(t.a, t.b, s.b);
  if (s.ring != t.ring) return c < 0 && d < 0;
  return c <= 0 && d <= 0 && s.xmin() <= t.xmax() && t.xmin() <= s.xmax() && s.ymin() <= t.ymax() &&
      t.ymin() <= s.ymax();
}

// where they do; for edges on one line a point that both have

Point meeting(const Segment &s, const Segment &t)
{
  const double ux = s.b.x - s.a.x, uy = s.b.y - s.a.y;
  const double vx = t.b.x - t.a.x, vy = t.b.y - t.a.y;
  const double det = ux * vy - uy * vx;
  const double f = ((t.a.x - s.a.x) * vy - (t.a.y - s.a.y) * vx) / det;
  if (f >= 0.0 && f <= 1.0) return {s.a.x + f * ux, s.a.y + f * uy};
  for (const Point &p : {t.a, t.b})
    if (p.x >= s.xmin() && p.x <= s.xmax() && p.y >= s.ymin() && p.y <= s.ymax()) return p;
  return s.a;
}

// The first edge (in the file) that meets another one where it may not, and the first such one. Edges are
// compared with those that begin beside them, along the side of the box of which they are the smaller part.

void check_crossings(const std::string &path, const std::vector<Segment> &all, const Polygon &box)
{
  double x = 0.0, y = 0.0;
  for (const Segment &s : all) {
    x += s.xmax() - s.xmin();
    y += s.ymax() - s.ymin();
  }
  const bool wide = x * (box.yhi - box.ylo) < y * (box.xhi - box.xlo);
  const auto from = [&](int e) {
    return wide ? all[e].xmin() : all[e].ymin();
  };
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return from(a) < from(b);
  });
  std::pair<int, int> found((int) all.size(), 0);
  for (auto e = order.begin(); e != order.end(); ++e) {
    const double end = wide ? all[*e].xmax() : all[*e].ymax();
    for (auto other = e + 1; other != order.end() && from(*other) <= end; ++other) {
      const std::pair<int, int> pair = std::minmax(*e, *other);
      const Segment &s = all[pair.first], &t = all[pair.second];
      if (wide ? s.ymin() > t.ymax() || t.ymin() > s.ymax()
               : s.xmin() > t.xmax() || t.xmin() > s.xmax())
        continue;
      if (pair < found && meet(s, t, pair.second == s.next || pair.second == s.prev)) found = pair;
    }
  }
  if (found.first == (int) all.size()) return;

  const Segment &s = all[found.first], &t = all[found.second];
  const Point at = meeting(s, t);
  const std::string where = " at " + number_text(at.x) + "," + number_text(at.y);
  if (s.ring == t.ring)
    throw line_error(path, s.line,
                     "a ring must not cross or touch itself, the edges from lines " +
                         std::to_string(s.line) + " and " + std::to_string(t.line) + " meet" +
                         where);
  throw line_error(path, s.line,
                   "rings must not cross, the edges from lines " + std::to_string(s.line) +
                       " and " + std::to_string(t.line) + " do" + where);
}

}    // namespace

/* ---------------------------------------------------------------------- */

Polygon::Polygon(const std::vector<double> &_xy, const std::vector<int> &_sizes) :
    xy(_xy), sizes(_sizes), scale(0.0)
{
  xlo = xhi = xy.at(0);
  ylo = yhi = xy.at(1);
  for (size_t k = 0; k < xy.size(); k += 2) {
    xlo = std::min(xlo, xy[k]);
    xhi = std::max(xhi, xy[k]);
    ylo = std::min(ylo, xy[k + 1]);
    yhi = std::max(yhi, xy[k + 1]);
  }

  // edges along x are crossed by no ray along x; the order of the ends is that of y, whatever way
  // the ring goes round, so that edges of two rings round in the same way

  size_t start = 0;
  for (const int size : sizes) {
    for (int k = 0; k < size; k++) {
      const double *p = &xy[2 * (start + k)];
      const double *q = &xy[2 * (start + (k + 1) % size)];
      if (p[1] < q[1]) edges.push_back({p[0], p[1], q[0], q[1]});
      if (p[1] > q[1]) edges.push_back({q[0], q[1], p[0], p[1]});
    }
    start += size;
  }
  cut_into_strips();
}

/* ----------------------------------------------------------------------
   edges into strips
------------------------------------------------------------------------- */

int Polygon::strip(double y) const
{
  const double at = (y - ylo) * scale;    // of a height that is next to none, scale is infinite
  return at > 0.0 ? (int) std::min(first.size() - 2.0, at) : 0;
}

void Polygon::cut_into_strips()
{
  if (edges.empty()) return;

  // as many strips as edges, but fewer if edges are long and in too many of them

  double parts;
  int n = 2 * (int) edges.size();
  do {
    n = (n + 1) / 2;
    scale = n / (yhi - ylo);
    first.assign(n + 1, 0);
    parts = 0.0;
    for (const Edge &e : edges) parts += strip(e.y1) - strip(e.y0) + 1;
  } while (n > 1 && parts > MOST_PARTS * edges.size());

  // counted, then put

  first.assign(n + 1, 0);
  for (const Edge &e : edges)
    for (int k = strip(e.y0); k <= strip(e.y1); k++) first[k + 1]++;
  for (int k = 0; k < n; k++) first[k + 1] += first[k];
  members.resize(first[n]);
  std::vector<int> place = first;
  for (size_t i = 0; i < edges.size(); i++)
    for (int k = strip(edges[i].y0); k <= strip(edges[i].y1); k++)
      members[place[k]++] = static_cast<int>(i);
  for (int k = 0; k < n; k++)
    std::sort(members.begin() + first[k], members.begin() + first[k + 1], [this](int a, int b) {
      return edges[a].xmax() > edges[b].xmax();
    });
}

/* ---------------------------------------------------------------------- */

Polygon Polygon::read(const std::string &path, bool si)
{
  const Rings rings = read_rings(path, si);

  std::vector<double> points;
  std::vector<int> sizes;
  std::vector<Segment> all;
  for (size_t r = 0; r < rings.points.size(); r++) {
    const std::vector<Point> &ring = rings.points[r];
    const int n = (int) ring.size(), base = (int) all.size();
    for (int k = 0; k < n; k++) {
      const Point &p = ring[k], &q = ring[(k + 1) % n];
      points.push_back(p.x);
      points.push_back(p.y);
      all.push_back({p, q, (int) r, rings.lines[r][k], base + (k + 1) % n, base + (k + n - 1) % n});
    }
    bool flat = true;
    for (const Point &p : ring) flat = flat && side(ring[0], ring[1], p) == 0;
    if (flat)
      throw line_error(path, rings.lines[r][0],
                       "a ring must have an area > 0, its points are on a line");
    sizes.push_back(n);
  }

  const Polygon polygon(points, sizes);
  check_crossings(path, all, polygon);
  const double area = polygon.area();
  if (!(area > 0.0))
    throw std::runtime_error(path + ": must have an area > 0, got " + number_text(area) +
                             ", rings cancel each other");
  return polygon;
}

/* ----------------------------------------------------------------------
   a ray to the east crosses an odd number of edges
------------------------------------------------------------------------- */

bool Polygon::inside(double x, double y) const
{
  if (!(x >= xlo && x <= xhi && y >= ylo && y <= yhi)) return false;    // NaN, too
  if (edges.empty()) return false;
  auto is_east = [=](const Edge &e) {
    return (e.x1 - e.x0) * (y - e.y0) > (x - e.x0) * (e.y1 - e.y0);
  };

  const int k = strip(y);
  bool odd = false;
  for (int i = first[k]; i < first[k + 1]; i++) {
    const Edge &e = edges[members[i]];
    if (e.xmax() <= x) break;
    if (e.y0 <= y && y < e.y1 && is_east(e)) odd = !odd;
  }
  return odd;
}

/* ----------------------------------------------------------------------
   Between two neighbouring heights of points no edges cross: there the inside is trapezoids. Rings
   that only touch may still cross each other in a point, so that they cannot be told apart. A
   single ring cannot, and may have very many points.
------------------------------------------------------------------------- */

double Polygon::area() const
{
  double total = 0.0;
  if (sizes.size() == 1) {
    for (size_t k = 0; k < xy.size(); k += 2) {
      const double *p = &xy[k], *q = &xy[(k + 2) % xy.size()];
      total += 0.5 * ((p[0] - xlo) * (q[1] - p[1]) - (p[1] - ylo) * (q[0] - p[0]));
    }
    return std::fabs(total);
  }

  std::vector<double> heights, cuts;
  for (size_t k = 1; k < xy.size(); k += 2) heights.push_back(xy[k]);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  std::vector<Edge> here, from_south = edges;
  std::sort(from_south.begin(), from_south.end(), [](const Edge &a, const Edge &b) {
    return a.y0 < b.y0;
  });

  auto next = from_south.begin();
  for (size_t k = 0; k + 1 < heights.size(); k++) {
    const double south = heights[k], height = heights[k + 1] - south;
    here.erase(std::remove_if(here.begin(), here.end(),
                              [=](const Edge &e) {
                                return e.y1 <= south;
                              }),
               here.end());
    for (; next != from_south.end() && next->y0 <= south; ++next) here.push_back(*next);
    cuts.clear();
    for (const Edge &e : here) cuts.push_back(e.xat(south + 0.5 * height));
    std::sort(cuts.begin(), cuts.end());
    for (size_t i = 0; i + 1 < cuts.size(); i += 2) total += height * (cuts[i + 1] - cuts[i]);
  }
  return total;
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "triangle_mesh.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace Slope;

static double part(const Vector &v, int axis)
{
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* ---------------------------------------------------------------------- */

TriangleMesh::TriangleMesh(const std::vector<Triangle> &list) : triangles(list), sum(0.0)
{
  const int n = count();
  std::vector<Vector> middles(n);
  order.resize(n);
  for (int k = 0; k < n; k++) {
    const Triangle &t = triangles[k];
    middles[k] = t.middle();
    order[k] = k;
    const double turns = GOLDEN * (k + 1);    // another order is another mesh
    const double weight = 1.0 + turns - std::floor(turns);
    sum += weight *
        (t.a.x + 2.0 * t.a.y + 3.0 * t.a.z + 5.0 * t.b.x + 7.0 * t.b.y + 11.0 * t.b.z +
         13.0 * t.c.x + 17.0 * t.c.y + 19.0 * t.c.z);
  }
  boxes.reserve(2 * (n / LEAF) + 1);
  build(middles, 0, n);
}

/* ----------------------------------------------------------------------
   box of a part of the order, its halves after it; returns its number
------------------------------------------------------------------------- */

int TriangleMesh::build(const std::vector<Vector> &middles, int first, int last)
{
  Box box;
  Vector from = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, to = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  box.low = from;
  box.high = to;
  auto widen = [](Vector &low, Vector &high, const Vector &v) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  };
  for (int k = first; k < last; k++) {
    const Triangle &t = triangles[order[k]];
    for (const Vector *corner : {&t.a, &t.b, &t.c}) widen(box.low, box.high, *corner);
    widen(from, to, middles[order[k]]);
  }
  box.first = first;
  box.last = last;
  box.other = 0;
  const int number = static_cast<int>(boxes.size());
  boxes.push_back(box);
  if (last - first <= LEAF) return number;

  int axis = 0;
  for (int d = 1; d < 3; d++)
    if (part(to, d) - part(from, d) > part(to, axis) - part(from, axis)) axis = d;
  const int half = (first + last) / 2;
  std::nth_element(order.begin() + first, order.begin() + half, order.begin() + last,
                   [&](int a, int b) {
                     const double u = part(middles[a], axis), v = part(middles[b], axis);
                     return u < v || (u == v && a < b);
                   });
  build(middles, first, half);
  const int other = build(middles, half, last);
  boxes[number].other = other;
  return number;
}

/* ---------------------------------------------------------------------- */

template <class Beside, class Use> void TriangleMesh::each(Beside beside, Use use) const
{
  int todo[64], ntodo = 1;    // the boxes halve: never more than their depth
  todo[0] = 0;
  while (ntodo) {
    const int number = todo[--ntodo];
    const Box &box = boxes[number];
    if (beside(box)) continue;
    if (box.other) {
      todo[ntodo++] = box.other;
      todo[ntodo++] = number + 1;
    } else {
      for (int k = box.first; k < box.last; k++) use(order[k]);
    }
  }
}

void TriangleMesh::find_near(const Vector &x, double reach, std::vector<int> &numbers) const
{
  auto beyond = [reach](double at, double low, double high) {
    return at < low - reach || at > high + reach;
  };
  each(
      [&](const Box &box) {
        return beyond(x.x, box.low.x, box.high.x) || beyond(x.y, box.low.y, box.high.y) ||
            beyond(x.z, box.low.z, box.high.z);
      },
      [&](int number) {
        numbers.push_back(number);
      });
}

/* ----------------------------------------------------------------------
   corners are the same if their coordinates are
------------------------------------------------------------------------- */

bool TriangleMesh::closed() const
{
  const int ncorner = 3 * count();
  auto corner = [this](int k) -> const Vector & {
    const Triangle &t = triangles[k / 3];
    return k % 3 == 0 ? t.a : k % 3 == 1 ? t.b : t.c;
  };
  auto before = [&corner](int k, int l) {
    const Vector &a = corner(k), &b = corner(l);
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  };
  std::vector<int> sorted(ncorner), name(ncorner);
  for (int k = 0; k < ncorner; k++) sorted[k] = k;
  std::sort(sorted.begin(), sorted.end(), before);
  for (int k = 1; k < ncorner; k++)
    name[sorted[k]] = name[sorted[k - 1]] + before(sorted[k - 1], sorted[k]);

  std::vector<std::pair<int, int>> edges(ncorner);
  for (int k = 0; k < ncorner; k++)
    edges[k] = std::minmax({name[k], name[k % 3 == 2 ? k - 2 : k + 1]});
  std::sort(edges.begin(), edges.end());
  for (int k = 0; k < ncorner; k += 2)
    if (k + 1 == ncorner || edges[k] != edges[k + 1] ||
        (k + 2 < ncorner && edges[k] == edges[k + 2]))
      return false;
  return true;
}

/* ----------------------------------------------------------------------
   whether the triangle is above x. Seen from above, a point on an edge is in one of its two triangles:
   the same numbers decide for both.
------------------------------------------------------------------------- */

static bool above(const Triangle &t, const Vector &x)
{
  auto beyond = [&x](const Vector &p, const Vector &q) {
    if ((p.y > x.y) == (q.y > x.y)) return false;
    const Vector &low = p.y < q.y ? p : q, &high = p.y < q.y ? q : p;
    return x.x < low.x + (x.y - low.y) * ((high.x - low.x) / (high.y - low.y));
  };
  if ((beyond(t.a, t.b) != beyond(t.b, t.c)) == beyond(t.c, t.a)) return false;
  const Vector n = t.twice_area();
  const double z = n.z == 0.0 ? t.middle().z
                              : t.a.z - (n.x * (x.x - t.a.x) + n.y * (x.y - t.a.y)) / n.z;
  return z > x.z;
}

bool TriangleMesh::encloses(const Vector &x) const
{
  bool inside = false;
  each(
      [&x](const Box &box) {
        return x.x < box.low.x || x.x > box.high.x || x.y < box.low.y || x.y > box.high.y ||
            x.z > box.high.z;
      },
      [&](int number) {
        inside ^= above(triangles[number], x);
      });
  return inside;
}

/* ---------------------------------------------------------------------- */

double TriangleMesh::memory_usage() const
{
  return static_cast<double>(triangles.capacity()) * sizeof(Triangle) +
      static_cast<double>(boxes.capacity()) * sizeof(Box) +
      static_cast<double>(order.capacity()) * sizeof(int);
}

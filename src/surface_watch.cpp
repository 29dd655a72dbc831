/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_watch.h"

#include <algorithm>
#include <cmath>

using namespace Slope;

static constexpr double FAR_AWAY = 1.0e15;    // m: no ball touches a phantom there
static constexpr double SHELL = 0.05;    // of the radius: how far around a ball triangles are kept
static constexpr double ON_PLANE = 1.0e-9;    // of the radius
static constexpr double COS_FOLLOWED = 0.7071067811865476;

/* ---------------------------------------------------------------------- */

void SurfaceWatch::clear()
{
  slots.clear();
  listed.clear();
  watched.clear();
}

/* ---------------------------------------------------------------------- */

int SurfaceWatch::add_ball(int i, const std::vector<int> &triangles)
{
  Ball ball;
  ball.i = i;
  ball.first = listed.size();
  listed.insert(listed.end(), triangles.begin(), triangles.end());
  ball.last = listed.size();
  ball.first_slot = -1;
  ball.seen = {0.0, 0.0, 0.0};
  ball.free = -1.0;    // not looked at yet
  watched.push_back(ball);
  return balls() - 1;
}

int SurfaceWatch::new_slot(int ball)
{
  const int number = static_cast<int>(slots.size());
  Slot slot;
  slot.at = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0, -1};
  slot.centre = {FAR_AWAY, FAR_AWAY, FAR_AWAY};
  slot.radius = 0.0;
  slot.ball = ball;
  slot.next = -1;
  slot.on = slot.touches = false;
  slots.push_back(slot);
  int *link = &watched[ball].first_slot;
  while (*link >= 0) link = &slots[*link].next;
  *link = number;
  return number;
}

int SurfaceWatch::add_slot(int ball, const Vector &normal)
{
  const int number = new_slot(ball);
  slots[number].at.normal = normal;
  slots[number].touches = true;
  return number;
}

/* ----------------------------------------------------------------------
   triangles that the ball may touch while it moves less than a distance from here
------------------------------------------------------------------------- */

void SurfaceWatch::find_near(Ball &ball, const Vector &x, double radius, double step,
                             const TouchedSurface &surface)
{
  const double shell = std::max(SHELL * radius, 2.0 * step);
  double nearest = HUGE_VAL;
  ball.near.clear();
  for (size_t k = ball.first; k < ball.last; k++) {
    const Triangle t = surface.triangle(listed[k]);
    const double d = nearest_point(t, listed[k], x).distance;
    nearest = std::min(nearest, d);
    if (d < radius + shell) ball.near.push_back({t, listed[k]});
  }
  ball.seen = x;
  ball.free = ball.near.empty() ? nearest - radius : shell;
}

/* ---------------------------------------------------------------------- */

void SurfaceWatch::find_features(int number, const Vector &x, double radius, double step,
                                 const TouchedSurface &surface)
{
  Ball &ball = watched[number];
  const Vector way = minus(x, ball.seen);
  const bool known = ball.free > 0.0 && dot(way, way) < ball.free * ball.free;
  if (known && ball.near.empty() && ball.first_slot < 0) return;
  if (!known) find_near(ball, x, radius, step, surface);

  double limit = radius;    // what has been touched is followed for a step beyond
  for (int s = ball.first_slot; s >= 0; s = slots[s].next)
    if (slots[s].touches) limit = HUGE_VAL;
  points.clear();
  for (const Near &n : ball.near) {
    const SurfacePoint p = nearest_point(n.triangle, n.number, x);
    if (p.distance < limit) points.push_back(p);
  }
  hand_out(number, choose(points, radius), x, radius);
}

/* ---------------------------------------------------------------------- */

size_t SurfaceWatch::choose(std::vector<SurfacePoint> &points, double radius)
{
  std::sort(points.begin(), points.end(), [](const SurfacePoint &p, const SurfacePoint &q) {
    return p.distance < q.distance || (p.distance == q.distance && p.triangle < q.triangle);
  });
  const double on_plane = ON_PLANE * radius;
  std::vector<SurfacePoint> own;
  for (size_t k = 0; k < points.size(); k++) {
    bool stands_out = true;
    for (size_t m = 0; stands_out && m < k; m++)    // the nearest ones first: most end there
      stands_out = dot(minus(points[k].point, points[m].point), points[m].normal) > on_plane;
    if (stands_out) own.push_back(points[k]);
  }
  if (own.size() > 1) share_overlaps(own, radius);
  std::copy(own.begin(), own.end(), points.begin());
  return own.size();
}

/* ----------------------------------------------------------------------
   Effective overlaps of points sorted by distance, as distances that give them. A point that stands
   out by h from the tangent planes of the nearer ones has the part s of its overlap d in the energy,

     E = 1/2 k sum s^2,   s = d where d <= h/2, h - h^2/(4 d) beyond,

   so E is steady where points come, go and change their order, and a curved surface of many small
   faces is one contact. The force is the gradient of E: with dh/dx = n_q - cos n_p it is along n_p
   for the point p and along n_q for the nearer one, which gives up what p takes over.
------------------------------------------------------------------------- */

void SurfaceWatch::share_overlaps(std::vector<SurfacePoint> &own, double radius)
{
  std::vector<double> overlaps;
  for (const SurfacePoint &p : own) overlaps.push_back(radius - p.distance);
  std::vector<double> effective = overlaps;
  for (size_t k = 1; k < own.size(); k++) {
    double height = HUGE_VAL, cosine = 0.0;
    size_t by = 0;    // the nearer one whose plane is next
    for (size_t m = 0; m < k; m++) {
      const double c = dot(own[k].normal, own[m].normal);
      const double h = own[m].distance - own[k].distance * c;
      if (h >= height) continue;
      height = h;
      cosine = c;
      by = m;
    }
    const double d = overlaps[k];
    if (d <= 0.5 * height) continue;
    const double ratio = 0.5 * height / d;
    const double part = height * (1.0 - 0.5 * ratio), by_height = 1.0 - ratio;
    effective[k] = part * (ratio * ratio + by_height * cosine);
    effective[by] -= part * by_height;
  }
  for (size_t k = 0; k < own.size(); k++) own[k].distance = radius - effective[k];
}

/* ---------------------------------------------------------------------- */

void SurfaceWatch::set(Slot &slot, const SurfacePoint &at, const Vector &x, double radius)
{
  slot.at = at;
  slot.on = true;
  slot.touches = at.distance < radius;
  slot.centre = moved(x, -(at.distance + radius), at.normal);
  slot.radius = radius;
}

/* ----------------------------------------------------------------------
   The first count points to the slots of the ball: those that touched a step ago go on with the
   point whose normal is nearest to theirs, and the others are free for what is new.
------------------------------------------------------------------------- */

void SurfaceWatch::hand_out(int ball, size_t count, const Vector &x, double radius)
{
  taken.assign(count, 0);
  std::vector<int> open, unused;
  for (int s = watched[ball].first_slot; s >= 0; s = slots[s].next) {
    (slots[s].touches ? open : unused).push_back(s);
    slots[s].on = slots[s].touches = false;
    slots[s].centre = {FAR_AWAY, FAR_AWAY, FAR_AWAY};
    slots[s].radius = radius;
  }
  while (!open.empty()) {
    double best = COS_FOLLOWED;
    size_t best_slot = open.size(), best_point = 0;
    for (size_t s = 0; s < open.size(); s++)
      for (size_t p = 0; p < count; p++) {
        const double c = dot(slots[open[s]].at.normal, points[p].normal);
        if (taken[p] || !(c > best)) continue;
        best = c;
        best_slot = s;
        best_point = p;
      }
    if (best_slot == open.size()) break;
    set(slots[open[best_slot]], points[best_point], x, radius);
    taken[best_point] = 1;
    open.erase(open.begin() + best_slot);
  }
  for (size_t p = 0; p < count; p++) {
    if (taken[p] || !(points[p].distance < radius)) continue;
    int s;
    if (unused.empty()) {
      s = new_slot(ball);
    } else {
      s = unused.front();
      unused.erase(unused.begin());
    }
    set(slots[s], points[p], x, radius);
  }
}

/* ---------------------------------------------------------------------- */

double SurfaceWatch::memory_usage() const
{
  double bytes = static_cast<double>(slots.capacity()) * sizeof(Slot) +
      static_cast<double>(listed.capacity()) * sizeof(int) +
      static_cast<double>(watched.capacity()) * sizeof(Ball);
  for (const Ball &b : watched) bytes += static_cast<double>(b.near.capacity()) * sizeof(Near);
  return bytes;
}

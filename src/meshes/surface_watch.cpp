// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_watch.h"

#include "way_out.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

using namespace Slope;

namespace {

// Which of the points that a ball touches belong to one smooth surface, and are one contact. Derivation:
// doc/src/theory.rst, Surfaces of triangles.
class OneSurface {
 public:
  // Contacts, the nearest one first, that turn little from a nearer one are one with it, and its overlap
  // is the shortest way of the ball out of all of them. So are two nearest ones with another one between
  // them that is almost as near. Leaves the nearest one of each surface; returns the ways, m.
  static std::vector<Vector> join(std::vector<SurfaceContact> &contacts, double radius)
  {
    OneSurface all(contacts);
    for (size_t k = 0; k < contacts.size(); k++) all.add(k);
    std::vector<SurfaceContact> nearest;
    std::vector<Vector> ways;
    for (const Surface &s : all.surfaces) {
      if (s.members.empty()) continue;
      nearest.push_back(contacts[s.members[0]]);
      SurfaceContact &c = nearest.back();
      c.joined = s.members.size() > 1;
      ways.push_back(moved({0.0, 0.0, 0.0}, c.overlap, c.at.normal));
      const std::vector<OverlappedFace> faces = all.overlapped(s);
      if (faces.size() < 2) continue;
      ways.back() = WayOut::of(faces, radius);
      c.overlap = c.spring = size_of(ways.back());
    }
    contacts = nearest;
    return ways;
  }

 private:
  static constexpr double COS_NEIGHBORS = 0.8660254;    // 30 degrees
  static constexpr double COS_OF_MEAN = 0.25;    // least, of a member and the mean of the normals
  static constexpr double ALMOST = 0.9;          // of an overlap

  struct Surface {
    std::vector<size_t> members;    // the nearest one first; none: it is part of another one
    Vector sum;                     // of their normals
  };

  const std::vector<SurfaceContact> &contacts;
  std::vector<Surface> surfaces;
  std::vector<size_t> of;    // of each contact, its surface

  explicit OneSurface(const std::vector<SurfaceContact> &list) : contacts(list) {}

  const Vector &normal(size_t k) const { return contacts[k].at.normal; }
  static bool faces_mean(const Vector &n, const Vector &sum)
  {
    return dot(n, sum) >= COS_OF_MEAN * size_of(sum);
  }

  // to the surface of the nearer contact whose normal is nearest, or to one of its own
  void add(size_t k)
  {
    size_t best = surfaces.size();
    double most = COS_NEIGHBORS;
    for (size_t m = 0; m < k; m++) {
      const double cosine = dot(normal(k), normal(m));
      if (cosine < most || !faces_mean(normal(k), surfaces[of[m]].sum)) continue;
      most = cosine;
      best = of[m];
    }
    if (best == surfaces.size()) surfaces.push_back({{}, {0.0, 0.0, 0.0}});
    surfaces[best].members.push_back(k);
    surfaces[best].sum = moved(surfaces[best].sum, 1.0, normal(k));
    of.push_back(best);
    for (size_t m = 0; m < k; m++)
      if (of[m] != of[k] && dot(normal(k), normal(m)) >= COS_NEIGHBORS) unite(of[m], of[k], k);
  }

  // two surfaces beside contact k
  void unite(size_t a, size_t b, size_t k)
  {
    if (a > b) std::swap(a, b);    // a has the nearest contact of both
    Surface &to = surfaces[a], &from = surfaces[b];
    if (contacts[k].overlap < ALMOST * contacts[from.members[0]].overlap) return;
    const Vector sum = moved(to.sum, 1.0, from.sum);
    for (const Surface *s : {&to, &from})
      for (const size_t m : s->members)
        if (!faces_mean(normal(m), sum)) return;
    for (const size_t m : from.members) of[m] = a;
    to.members.insert(to.members.end(), from.members.begin(), from.members.end());
    to.sum = sum;
    from.members.clear();
  }

  std::vector<OverlappedFace> overlapped(const Surface &s) const
  {
    std::vector<OverlappedFace> list;
    for (const size_t m : s.members)
      if (contacts[m].overlap > 0.0) list.push_back({normal(m), contacts[m].overlap});
    return list;
  }
};

}    // namespace

static constexpr double FAR_AWAY = 1.0e15;    // m: no ball touches a phantom there
static constexpr double SHELL = 0.05;    // of the radius: how far around a ball triangles are kept
static constexpr double ON_PLANE = 1.0e-9;       // of the radius
static constexpr double COS_FOLLOWED = 0.5;      // 60 degrees
static constexpr double LEAST_SHARE = 1.0e-3;    // of its depth that a contact always keeps
static constexpr double MOST_TURN = 10.0;    // per motion: where the centre all but lies on an edge
static constexpr double TINY = 1.0e-300;     // m
static constexpr int MOST_SWEEPS = 100;
static constexpr double SWEPT = 1.0e-9;    // of the largest overlap

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
  ball.free = -1.0;    // not examined yet
  watched.push_back(ball);
  return balls() - 1;
}

int SurfaceWatch::new_slot(int ball)
{
  const int number = static_cast<int>(slots.size());
  Slot slot;
  slot.contact = {};
  slot.contact.at.normal = {0.0, 0.0, 1.0};
  slot.contact.at.triangle = -1;
  slot.centre = {FAR_AWAY, FAR_AWAY, FAR_AWAY};
  slot.radius = 0.0;
  slot.ball = ball;
  slot.next = -1;
  slot.touches = false;
  slots.push_back(slot);
  int *link = &watched[ball].first_slot;
  while (*link >= 0) link = &slots[*link].next;
  *link = number;
  return number;
}

int SurfaceWatch::add_slot(int ball, const Vector &normal)
{
  const int number = new_slot(ball);
  slots[number].contact.at.normal = normal;
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
  choose(points, radius, own);
  hand_out(number, x, radius);
}

/* ----------------------------------------------------------------------
   Of a contact and a nearer one, by its tangent plane: height h of the contact above that plane, and
   its gradient as the ball moves, along (normal of the plane, own normal)

   dh = n dp + (p - p') dn': p moves on its face, along its side, or not at all; the plane's normal n'
   turns if the nearer point is on a side or a corner. What is across both normals is left out.
------------------------------------------------------------------------- */

namespace {
struct Height {
  double value, along_plane, along_own;
};

Height height_above(const SurfacePoint &plane, const SurfacePoint &own)
{
  const double c = dot(own.normal, plane.normal);
  Height h = {plane.distance - own.distance * c, 0.0, 0.0};
  const double sine_square = 1.0 - c * c;
  if (!(sine_square > 0.0)) return h;
  auto share = [sine_square](double component) {
    return std::min(1.0, component * component / sine_square);
  };
  auto unit = [](const Vector &v) {
    return moved({0.0, 0.0, 0.0}, 1.0 / size_of(v), v);
  };

  double moves = 0.0;    // share of the ball's motion across the plane that the point follows
  if (own.on == SurfacePoint::FACE) moves = 1.0;
  if (own.on == SurfacePoint::SIDE) moves = share(dot(unit(own.side), plane.normal));
  double turns = 0.0;
  if (plane.on == SurfacePoint::CORNER) turns = 1.0;
  if (plane.on == SurfacePoint::SIDE)
    turns = share(dot(cross(unit(plane.side), plane.normal), own.normal));
  if (turns > 0.0) turns *= std::min(own.distance / std::max(plane.distance, TINY), MOST_TURN);

  // moves (n' - c n) - turns (n - c n')
  h.along_plane = moves + turns * c;
  h.along_own = -moves * c - turns;
  return h;
}

/* ----------------------------------------------------------------------
   overlaps > 0 whose forces have the same sum, where the gradient has one below: a deepest face among
   many in a hollow no larger than the ball (coordinate descent on the square of the difference)
------------------------------------------------------------------------- */

void keep_all_pressing(std::vector<SurfaceContact> &own, double radius)
{
  auto least = [radius](const SurfaceContact &c) {
    return LEAST_SHARE * (radius - c.at.distance);
  };
  double largest = 0.0;
  bool pull = false;
  Vector error = {0.0, 0.0, 0.0};    // sum of what is added
  for (SurfaceContact &c : own) {
    if (!(c.at.distance < radius)) continue;
    largest = std::max(largest, c.overlap);
    if (c.overlap >= least(c)) continue;
    pull = true;
    error = moved(error, least(c) - c.overlap, c.at.normal);
    c.overlap = least(c);
  }
  double change = pull ? HUGE_VAL : 0.0;
  for (int sweep = 0; sweep < MOST_SWEEPS && change > SWEPT * largest; sweep++) {
    change = 0.0;
    for (SurfaceContact &c : own) {
      if (!(c.at.distance < radius)) continue;
      const double to = std::max(least(c), c.overlap - dot(error, c.at.normal));
      error = moved(error, to - c.overlap, c.at.normal);
      change = std::max(change, std::fabs(to - c.overlap));
      c.overlap = to;
    }
  }
}

/* ----------------------------------------------------------------------
   A contact of depth d that stands out by h from the tangent planes of the nearer ones has the
   compression s in the energy,

     E = 1/2 k sum s^2,   s = d where d <= h/2, h - h^2/(4 d) beyond,

   so E is steady where contacts come, go and change their order, and a curved surface of many small
   faces is one contact. The force is the gradient of E.
------------------------------------------------------------------------- */

void share_overlaps(std::vector<SurfaceContact> &own, double radius)
{
  for (size_t k = 1; k < own.size(); k++) {
    Height height = {HUGE_VAL, 0.0, 0.0};
    size_t by = 0;    // the nearer one whose plane is next
    for (size_t m = 0; m < k; m++) {
      const Height h = height_above(own[m].at, own[k].at);
      if (h.value >= height.value) continue;
      height = h;
      by = m;
    }
    const double d = own[k].overlap;
    if (d <= 0.5 * height.value) continue;
    const double ratio = 0.5 * height.value / d, by_height = 1.0 - ratio;
    const double part = height.value * (1.0 - 0.5 * ratio);
    own[k].spring = part;
    own[k].overlap = part * (ratio * ratio - by_height * height.along_own);
    own[by].overlap -= part * by_height * height.along_plane;
  }
  keep_all_pressing(own, radius);
}

}    // namespace

/* ---------------------------------------------------------------------- */

void SurfaceWatch::choose(std::vector<SurfacePoint> &points, double radius,
                          std::vector<SurfaceContact> &own)
{
  std::sort(points.begin(), points.end(), [](const SurfacePoint &p, const SurfacePoint &q) {
    return p.distance < q.distance || (p.distance == q.distance && p.triangle < q.triangle);
  });
  const double on_plane = ON_PLANE * radius;
  own.clear();
  for (size_t k = 0; k < points.size(); k++) {
    bool stands_out = true;
    for (size_t m = 0; stands_out && m < k; m++)    // the nearest ones first: most end there
      stands_out = dot(minus(points[k].point, points[m].point), points[m].normal) > on_plane;
    const double depth = radius - points[k].distance;
    if (stands_out) own.push_back({points[k], depth, std::max(depth, 0.0), false});
  }
  if (own.size() < 2) return;
  const std::vector<Vector> ways = OneSurface::join(own, radius);
  if (own.size() > 1) share_overlaps(own, radius);
  for (size_t k = 0; k < own.size(); k++) {
    const double overlap = size_of(ways[k]);
    if (own[k].spring > 0.0) own[k].at.normal = moved({0.0, 0.0, 0.0}, 1.0 / overlap, ways[k]);
  }
}

/* ---------------------------------------------------------------------- */

void SurfaceWatch::set(Slot &slot, const SurfaceContact &contact, const Vector &x, double radius)
{
  slot.contact = contact;
  slot.touches = contact.overlap > 0.0;
  slot.centre = moved(x, contact.overlap - 2.0 * radius, contact.at.normal);
  slot.radius = radius;
}

/* ----------------------------------------------------------------------
   What a contact with this normal is now. If the ball has just left several faces of one surface, the way
   out of them is that of the step before: the dashpot acts on until the end, and not along the nearest one.
------------------------------------------------------------------------- */

SurfaceContact SurfaceWatch::followed(SurfaceContact now, const Vector &normal)
{
  if (!now.joined || now.overlap > 0.0) return now;
  now.overlap /= dot(now.at.normal, normal);
  now.at.normal = normal;
  return now;
}

/* ----------------------------------------------------------------------
   The contacts found to the slots of the ball: slots that touched a step ago go on with the contact
   whose normal is nearest to theirs, and the others are free for what is new.
------------------------------------------------------------------------- */

void SurfaceWatch::hand_out(int ball, const Vector &x, double radius)
{
  const size_t count = own.size();
  taken.assign(count, 0);
  std::vector<int> open, unused;
  for (int s = watched[ball].first_slot; s >= 0; s = slots[s].next) {
    (slots[s].touches ? open : unused).push_back(s);
    slots[s].touches = false;
    slots[s].centre = {FAR_AWAY, FAR_AWAY, FAR_AWAY};
    slots[s].radius = radius;
  }
  while (!open.empty()) {
    double best = COS_FOLLOWED;
    size_t best_slot = open.size(), best_point = 0;
    for (size_t s = 0; s < open.size(); s++)
      for (size_t p = 0; p < count; p++) {
        const double c = dot(slots[open[s]].contact.at.normal, own[p].at.normal);
        if (taken[p] || !(c > best)) continue;
        best = c;
        best_slot = s;
        best_point = p;
      }
    if (best_slot == open.size()) break;
    Slot &slot = slots[open[best_slot]];
    set(slot, followed(own[best_point], slot.contact.at.normal), x, radius);
    taken[best_point] = 1;
    open.erase(open.begin() + best_slot);
  }
  for (size_t p = 0; p < count; p++) {
    if (taken[p] || !(own[p].overlap > 0.0)) continue;
    int s;
    if (unused.empty()) {
      s = new_slot(ball);
    } else {
      s = unused.front();
      unused.erase(unused.begin());
    }
    set(slots[s], own[p], x, radius);
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

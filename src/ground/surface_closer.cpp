// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_closer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

using namespace Slope;

// in ball radii

static constexpr double COVER = 1.85;       // wanted distance to the nearest ball, 2 lets one pass
static constexpr double PITCH = 0.1;        // between samples of the surface
static constexpr double SUBGRID = 0.25;     // between columns examined where the surface ends
static constexpr double LOW_SCARP = 0.5;    // no ball passes a gap no higher than this

static constexpr double LEVEL_SPARE = 1.05;    // lets ground with wide spacing be almost level
static constexpr int MAX_SUBGRID = 64;         // columns per cell side
static constexpr int RIM_STEPS = 8;            // halvings between two columns
static constexpr size_t BATCH = 5000;          // samples examined together
static constexpr size_t GLANCE = 100;          // the same where one that is not covered is enough
static constexpr double ROUND_OFF = PlanNodes::ROUND_OFF;

double Slope::cover_radius(double spacing, double radius)
{
  // Where the nodes of level ground are farther apart than that, be as dense as level ground.

  return std::max(COVER * radius, LEVEL_SPARE * spacing / std::sqrt(2.0));
}

double Slope::sampling_slack(double radius)
{
  return PITCH * radius / std::sqrt(2.0);    // half the diagonal between samples
}

double Slope::widest_spacing(double radius)
{
  return (2.0 * radius - sampling_slack(radius)) * std::sqrt(2.0) / LEVEL_SPARE;
}

typedef SurfaceCloser::Point Point;

static double distance2(const Point &a, const Point &b)
{
  const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
  return dx * dx + dy * dy + dz * dz;
}

static Point between(const Point &a, const Point &b, double t)
{
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
}

/* ---------------------------------------------------------------------- */

// a strip between the last nodes and the edge of the rectangle belongs to cells beyond

SurfaceCloser::SurfaceCloser(PlanNodes &n, double r) :
    ilo(n.x(0) - n.grid.xlo > PITCH * r ? -1 : 0),
    ihi(n.grid.xhi - n.x(n.nx - 1) > PITCH * r ? n.nx : n.nx - 1),
    jlo(n.y(0) - n.grid.ylo > PITCH * r ? -1 : 0),
    jhi(n.grid.yhi - n.y(n.ny - 1) > PITCH * r ? n.ny : n.ny - 1),
    reach(1 + static_cast<int>(cover_radius(n.grid.spacing, r) / n.grid.spacing + 1.0e-6)),
    nodes(n), radius(r), cover2(std::pow(cover_radius(n.grid.spacing, r), 2.0)), pitch(PITCH * r),
    here(0), look_only(false), leak(false)
{
}

void SurfaceCloser::start()
{
  added.clear();
  lying.clear();
}

/* ----------------------------------------------------------------------
 cell with balls on all corners: the surface is the bilinear patch between them

 A point p of the patch is the mean of the corners with the weights of the bilinear
 interpolation, so the mean square of its distances to them is the sum of the variances of
 their coordinates, at most S^2/4 + S^2/4 + dz^2/4: the nearest corner is no farther than
 the root of that. Only where this is too far are samples needed.
------------------------------------------------------------------------- */

SurfaceCloser::Kind SurfaceCloser::kind(int i, int j) const
{
  const PlanNodes::Look *corner[4] = {&nodes.at(i, j), &nodes.at(i + 1, j), &nodes.at(i, j + 1),
                                      &nodes.at(i + 1, j + 1)};
  int balls = 0;
  for (int c = 0; c < 4; c++) balls += corner[c]->ball;
  if (balls < 4) return balls > 0 ? RIM : DONE;
  double low = corner[0]->z, high = low;
  for (int c = 1; c < 4; c++) {
    low = std::min(low, corner[c]->z);
    high = std::max(high, corner[c]->z);
  }
  const double dz = high - low, spacing = nodes.grid.spacing;
  return 2.0 * spacing * spacing + dz * dz <= 4.0 * cover2 ? DONE : STEEP;
}

void SurfaceCloser::sample_patch(int i, int j)
{
  sample(node_point(i, j), node_point(i + 1, j), node_point(i, j + 1), node_point(i + 1, j + 1));
  cover_samples();
}

bool SurfaceCloser::leaks(int i, int j)
{
  look_only = true;
  leak = false;
  sample_patch(i, j);
  look_only = false;
  return leak;
}

void SurfaceCloser::close(int i, int j)
{
  here = nodes.cell(i, j);
  sample_patch(i, j);
}

/* ----------------------------------------------------------------------
 height of the surface within cell i,j: between its corners where all have one, so that it
 continues the patches of the neighbor cells
------------------------------------------------------------------------- */

bool SurfaceCloser::column_height(int i, int j, double x, double y, double &z) const
{
  const NodeGrid &grid = nodes.grid;
  const double spare = ROUND_OFF * grid.spacing;
  if (x < grid.xlo - spare || x > grid.xhi + spare) return false;
  if (y < grid.ylo - spare || y > grid.yhi + spare) return false;

  if (nodes.at(i, j).surface() && nodes.at(i + 1, j).surface() && nodes.at(i, j + 1).surface() &&
      nodes.at(i + 1, j + 1).surface()) {
    const double u = (x - nodes.x(i)) / (nodes.x(i + 1) - nodes.x(i));
    const double v = (y - nodes.y(j)) / (nodes.y(j + 1) - nodes.y(j));
    const Point low = between(node_point(i, j), node_point(i + 1, j), u);
    const Point high = between(node_point(i, j + 1), node_point(i + 1, j + 1), u);
    z = between(low, high, v).z;
    return true;
  }
  x = std::min(std::max(x, grid.xlo), grid.xhi);
  y = std::min(std::max(y, grid.ylo), grid.yhi);
  return nodes.surface.height(x, y, z) && std::isfinite(z);
}

bool SurfaceCloser::column_on(int i, int j, double x, double y, double &z) const
{
  return column_height(i, j, x, y, z) && (!nodes.surface.keep || nodes.surface.keep(x, y));
}

/* ----------------------------------------------------------------------
 where the kept surface ends between a column on it and one off it
------------------------------------------------------------------------- */

SurfaceCloser::Rim SurfaceCloser::find_rim(int i, int j, const Point &on, const Point &off,
                                           bool leaving) const
{
  Rim rim = {on, false, off, leaving};
  double t = 0.0, t_off = 1.0;
  for (int k = 0; k < RIM_STEPS; k++) {
    const double middle = 0.5 * (t + t_off);
    Point p = between(on, off, middle);
    if (column_on(i, j, p.x, p.y, p.z)) {
      t = middle;
      rim.p = p;
    } else {
      t_off = middle;
      rim.foot = p;
    }
  }

  // a scar is a cut into the ground: what hovers above the ground leaves none

  const GroundHeights &surface = nodes.surface;
  Point &foot = rim.foot;
  double z;
  if (surface.scar && column_height(i, j, foot.x, foot.y, z) && surface.height(foot.x, foot.y, z) &&
      surface.scar(foot.x, foot.y, foot.z) && foot.z <= z + pitch) {
    foot.x = rim.p.x;
    foot.y = rim.p.y;
    rim.scarp = std::fabs(rim.p.z - foot.z) > LOW_SCARP * radius;
  }
  return rim;
}

/* ----------------------------------------------------------------------
 cell in which the kept surface ends, on a finer grid
------------------------------------------------------------------------- */

Point SurfaceCloser::column(int i, int j, int n, size_t k) const
{
  const int a = static_cast<int>(k % (n + 1)), b = static_cast<int>(k / (n + 1));
  return {nodes.x(i) + (nodes.x(i + 1) - nodes.x(i)) * a / n,
          nodes.y(j) + (nodes.y(j + 1) - nodes.y(j)) * b / n, 0.0};
}

SurfaceCloser::Columns SurfaceCloser::columns_of(int i, int j) const
{
  const double wanted = std::ceil(nodes.grid.spacing / (SUBGRID * radius));
  Columns found;
  found.n = static_cast<int>(std::min(std::max(wanted, 2.0), MAX_SUBGRID + 0.0));
  found.z.assign(static_cast<size_t>(found.n + 1) * (found.n + 1),
                 std::numeric_limits<double>::quiet_NaN());
  for (size_t k = 0; k < found.z.size(); k++) {
    Point p = column(i, j, found.n, k);
    if (column_on(i, j, p.x, p.y, p.z)) found.z[k] = p.z;
  }
  return found;
}

std::vector<int64_t> SurfaceCloser::rim_goes_on(int i, int j, const Columns &c) const
{
  bool south = false, north = false, west = false, east = false;
  const size_t n = c.n, row = n + 1, last = row * n;
  for (size_t a = 1; a <= n; a++) {
    south |= c.on(a) != c.on(0);
    north |= c.on(last + a) != c.on(last);
    west |= c.on(row * a) != c.on(0);
    east |= c.on(row * a + n) != c.on(n);
  }
  std::vector<int64_t> found;
  if (south && in_range(i, j - 1)) found.push_back(nodes.cell(i, j - 1));
  if (west && in_range(i - 1, j)) found.push_back(nodes.cell(i - 1, j));
  if (east && in_range(i + 1, j)) found.push_back(nodes.cell(i + 1, j));
  if (north && in_range(i, j + 1)) found.push_back(nodes.cell(i, j + 1));
  return found;
}

/* ----------------------------------------------------------------------
 what there is of the surface, piece by piece of the finer grid, up to the rim; and the scarp
 below the rim
------------------------------------------------------------------------- */

void SurfaceCloser::refine(int i, int j, const Columns &columns)
{
  here = nodes.cell(i, j);
  const int n = columns.n;
  auto point = [&](size_t k) {
    Point p = column(i, j, n, k);
    if (columns.on(k)) p.z = columns.z[k];
    return p;
  };

  std::vector<Point> piece;
  std::vector<Rim> rims;
  for (int b = 0; b < n; b++)
    for (int a = 0; a < n; a++) {
      const size_t k = static_cast<size_t>(b) * (n + 1) + a;
      const size_t corner[5] = {k, k + 1, k + n + 2, k + n + 1, k};

      piece.clear();
      rims.clear();
      for (int c = 0; c < 4; c++) {
        const size_t at = corner[c], next = corner[c + 1];
        const bool on = columns.on(at);
        if (on) piece.push_back(point(at));
        if (on == columns.on(next)) continue;
        if (on)
          rims.push_back(find_rim(i, j, point(at), point(next), true));
        else
          rims.push_back(find_rim(i, j, point(next), point(at), false));
        piece.push_back(rims.back().p);
      }

      if (piece.size() == 4 && rims.empty())
        sample(piece[0], piece[1], piece[3], piece[2]);
      else
        for (size_t c = 2; c < piece.size(); c++)
          sample(piece[0], piece[0], piece[c - 1], piece[c]);
      sample_scarp(rims);
    }
  cover_samples();
}

void SurfaceCloser::sample_scarp(const std::vector<Rim> &rims)
{
  for (size_t r = 0; r < rims.size(); r++) {
    const Rim &from = rims[r], &to = rims[(r + 1) % rims.size()];
    if (!from.leaving) continue;
    if (from.scarp && to.scarp)
      sample(from.p, to.p, from.foot, to.foot);
    else if (from.scarp)
      sample(from.p, from.p, from.foot, from.foot);
    else if (to.scarp)
      sample(to.p, to.p, to.foot, to.foot);
  }
}

/* ----------------------------------------------------------------------
 samples of the bilinear patch between four points, a side a00-a10 may have no length
------------------------------------------------------------------------- */

void SurfaceCloser::sample(const Point &a00, const Point &a10, const Point &a01, const Point &a11)
{
  const double across = std::sqrt(std::max(distance2(a00, a10), distance2(a01, a11)));
  const double along = std::sqrt(std::max(distance2(a00, a01), distance2(a10, a11)));
  if (across > along) return sample(a00, a01, a10, a11);    // rows across the long direction

  const double nu = std::ceil(across / pitch), nv = std::max(1.0, std::ceil(along / pitch));
  for (double v = 0.0; v <= nv; v++) {
    const Point left = between(a00, a01, v / nv), right = between(a10, a11, v / nv);
    for (double u = 0.0; u <= nu; u++)
      samples.push_back(between(left, right, u / std::max(nu, 1.0)));
    if (samples.size() >= (look_only ? GLANCE : BATCH)) cover_samples();
    if (look_only && leak) return;
  }
}

/* ----------------------------------------------------------------------
 balls that may cover any of the samples between lo and hi, those close to their middle first:
 most samples need no more
------------------------------------------------------------------------- */

int SurfaceCloser::clamped(double index, int n) const
{
  return static_cast<int>(std::min(std::max(std::floor(index), -1.0), n - 1.0));
}

std::vector<Point> SurfaceCloser::balls_near(const Point &lo, const Point &hi) const
{
  const double cover = std::sqrt(cover2), spacing = nodes.grid.spacing;
  const int i0 = clamped((lo.x - cover - nodes.xfirst) / spacing, nodes.nx);
  const int i1 = clamped((hi.x + cover - nodes.xfirst) / spacing, nodes.nx);
  const int j0 = clamped((lo.y - cover - nodes.yfirst) / spacing, nodes.ny);
  const int j1 = clamped((hi.y + cover - nodes.yfirst) / spacing, nodes.ny);

  std::vector<Point> near;
  for (int j = j0; j <= j1; j++)
    for (int i = i0; i <= i1; i++) {
      if (nodes.has_ball(i, j)) near.push_back(node_point(i, j));
      if (look_only) continue;
      const auto found = lying.find(nodes.cell(i, j));
      if (found == lying.end()) continue;
      for (const Point &p : found->second)
        if (p.z > lo.z - cover && p.z < hi.z + cover) near.push_back(p);
    }

  const Point middle = between(lo, hi, 0.5);
  std::sort(near.begin(), near.end(), [&](const Point &a, const Point &b) {
    return distance2(a, middle) < distance2(b, middle);
  });
  return near;
}

/* ----------------------------------------------------------------------
 add balls until every sample is covered, each on the sample farthest from all balls so far
------------------------------------------------------------------------- */

void SurfaceCloser::cover_samples()
{
  if (samples.empty()) return;
  Point lo = samples[0], hi = samples[0];
  for (const Point &p : samples) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const std::vector<Point> near = balls_near(lo, hi);

  // samples that are not covered, and how far they are from the nearest ball

  std::vector<double> far2;
  size_t open = 0;
  for (const Point &p : samples) {
    double d2 = 4.0 * cover2;
    for (size_t b = 0; b < near.size() && d2 > cover2; b++)
      d2 = std::min(d2, distance2(near[b], p));
    if (d2 <= cover2) continue;
    samples[open++] = p;
    far2.push_back(d2);
  }
  leak |= open > 0;
  if (look_only) open = 0;

  while (open > 0) {
    size_t worst = 0;
    for (size_t k = 1; k < open; k++)
      if (far2[k] > far2[worst] * (1.0 + ROUND_OFF)) worst = k;    // the first of equals

    const Point ball = samples[worst];
    size_t left = 0;
    for (size_t k = 0; k < open; k++) {
      const double d2 = std::min(far2[k], distance2(ball, samples[k]));
      if (d2 <= cover2) continue;
      samples[left] = samples[k];
      far2[left++] = d2;
    }
    open = left;
    add(ball);
  }
  samples.clear();
}

void SurfaceCloser::add(const Point &ball)
{
  const int i = clamped((ball.x - nodes.xfirst) / nodes.grid.spacing, nodes.nx);
  const int j = clamped((ball.y - nodes.yfirst) / nodes.grid.spacing, nodes.ny);
  lying[nodes.cell(i, j)].push_back(ball);
  added[here].push_back(ball);
}

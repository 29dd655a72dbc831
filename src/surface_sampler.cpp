/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_sampler.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <unordered_map>

using namespace Slope;

// in ball radii

static constexpr double COVER = 1.85;       // wanted distance to the nearest ball, 2 lets one pass
static constexpr double PITCH = 0.1;        // between samples of the surface
static constexpr double SUBGRID = 0.25;     // between columns looked at where the surface ends
static constexpr double LOW_SCARP = 0.5;    // a gap no higher than this is no way through

static constexpr double LEVEL_SPARE = 1.05;    // lets ground with wide spacing be almost level
static constexpr int MAX_SUBGRID = 64;         // columns per cell side
static constexpr int RIM_STEPS = 8;            // halvings between two columns
static constexpr size_t BATCH = 5000;          // samples looked at together
static constexpr double ROUND_OFF = 1.0e-9;    // of the spacing

static constexpr double MAX_COUNT = 2147483647.0;

double Slope::cover_radius(double spacing, double radius)
{
  // Where the nodes of level ground are farther apart than that, be as dense as level ground.

  return std::max(COVER * radius, LEVEL_SPARE * spacing / std::sqrt(2.0));
}

double Slope::sampling_slack(double radius)
{
  return PITCH * radius / std::sqrt(2.0);    // half the diagonal between samples
}

// nodes first .. first+count-1 of one direction lie between lo and hi
static void node_range(double lo, double hi, double origin, double spacing, double &first,
                       double &count)
{
  first = std::ceil((lo - origin) / spacing - ROUND_OFF);
  count = std::max(0.0, std::floor((hi - origin) / spacing + ROUND_OFF) - first + 1.0);
}

double Slope::plan_nodes(const PlanGrid &g)
{
  double first, nx, ny;
  node_range(g.xlo, g.xhi, g.xorigin, g.spacing, first, nx);
  node_range(g.ylo, g.yhi, g.yorigin, g.spacing, first, ny);
  return nx * ny;
}

namespace {

struct Point {
  double x, y, z;
};

double distance2(const Point &a, const Point &b)
{
  const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
  return dx * dx + dy * dy + dz * dz;
}

Point between(const Point &a, const Point &b, double t)
{
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
}

// Cell i,j of the plan grid has its corners at the nodes i,j i+1,j i,j+1 i+1,j+1. Cells that
// reach over the edge of the rectangle have corners outside: i and j run from -1 to nx and ny.

class Sampler {
 public:
  Sampler(const PlanGrid &, double radius, const Surface &);
  SurfaceBalls run();

 private:
  const PlanGrid &grid;
  const Surface &surface;
  const double radius, cover2, pitch;
  double xfirst, yfirst;    // node 0,0
  int nx, ny;

  std::vector<double> node_z;                                // NaN: no surface
  std::vector<char> node_ball;                               // kept, so there is a ball
  std::vector<char> refined;                                 // by cell
  std::vector<int> to_refine;                                // cells
  std::unordered_map<int64_t, std::vector<Point>> extras;    // by cell
  std::vector<Point> samples;
  SurfaceBalls balls;

  // node and cell indices

  double node_x(int i) const;
  double node_y(int j) const;
  bool is_node(int i, int j) const { return i >= 0 && i < nx && j >= 0 && j < ny; }
  bool has_ball(int i, int j) const { return is_node(i, j) && node_ball[node(i, j)]; }
  bool has_surface(int i, int j) const
  {
    return is_node(i, j) && node_z[node(i, j)] == node_z[node(i, j)];
  }
  size_t node(int i, int j) const { return static_cast<size_t>(j) * nx + i; }
  int64_t cell(int i, int j) const { return static_cast<int64_t>(j + 1) * (nx + 1) + (i + 1); }
  Point node_point(int i, int j) const { return {node_x(i), node_y(j), node_z[node(i, j)]}; }

  // columns of cell i,j

  struct Rim {
    Point p;         // last point of the kept surface
    bool scarp;      // it falls (or rises) here,
    Point foot;      // to this point
    bool leaving;    // walking round the cell, the kept surface ends here (else it begins)
  };
  bool column_height(int i, int j, double x, double y, double &z) const;
  bool column_on(int i, int j, double x, double y, double &z) const;
  Rim find_rim(int i, int j, const Point &on, const Point &off, bool leaving) const;

  void place_on_nodes();
  void close_cell(int i, int j);
  void refine_cell(int i, int j);
  void sample(const Point &, const Point &, const Point &, const Point &);
  void cover_samples();
};

}    // namespace

/* ---------------------------------------------------------------------- */

Sampler::Sampler(const PlanGrid &g, double r, const Surface &s) :
    grid(g), surface(s), radius(r), cover2(std::pow(cover_radius(g.spacing, r), 2.0)),
    pitch(PITCH * r)
{
  double ifirst, jfirst, ni, nj;
  node_range(g.xlo, g.xhi, g.xorigin, g.spacing, ifirst, ni);
  node_range(g.ylo, g.yhi, g.yorigin, g.spacing, jfirst, nj);
  if ((ni + 2.0) * (nj + 2.0) > MAX_COUNT) throw std::length_error("plan grid of 2^31 nodes");
  xfirst = g.xorigin + ifirst * g.spacing;
  yfirst = g.yorigin + jfirst * g.spacing;
  nx = static_cast<int>(ni);
  ny = static_cast<int>(nj);
}

// a node on the edge of the rectangle must not fall out of it by round-off

double Sampler::node_x(int i) const
{
  const double x = xfirst + i * grid.spacing;
  return i < 0 || i >= nx ? x : std::min(std::max(x, grid.xlo), grid.xhi);
}

double Sampler::node_y(int j) const
{
  const double y = yfirst + j * grid.spacing;
  return j < 0 || j >= ny ? y : std::min(std::max(y, grid.ylo), grid.yhi);
}

/* ----------------------------------------------------------------------
 balls on the nodes, then extra ones cell by cell, row by row
------------------------------------------------------------------------- */

SurfaceBalls Sampler::run()
{
  place_on_nodes();
  if (balls.base == 0) return balls;

  // a strip between the last nodes and the edge of the rectangle belongs to cells beyond

  const int ilo = node_x(0) - grid.xlo > pitch ? -1 : 0;
  const int jlo = node_y(0) - grid.ylo > pitch ? -1 : 0;
  const int ihi = grid.xhi - node_x(nx - 1) > pitch ? nx : nx - 1;
  const int jhi = grid.yhi - node_y(ny - 1) > pitch ? ny : ny - 1;

  refined.assign(static_cast<size_t>(nx + 1) * (ny + 1), 0);
  for (int j = jlo; j < jhi; j++)
    for (int i = ilo; i < ihi; i++) {
      const int corners =
          has_ball(i, j) + has_ball(i + 1, j) + has_ball(i, j + 1) + has_ball(i + 1, j + 1);
      if (corners == 4)
        close_cell(i, j);
      else if (corners > 0)
        refine_cell(i, j);
    }

  // the rim may cut through cells whose corners do not show it

  for (size_t k = 0; k < to_refine.size(); k++) {
    const int i = to_refine[k] % (nx + 1) - 1, j = to_refine[k] / (nx + 1) - 1;
    if (i >= ilo && i < ihi && j >= jlo && j < jhi) refine_cell(i, j);
  }
  return std::move(balls);
}

/* ---------------------------------------------------------------------- */

void Sampler::place_on_nodes()
{
  balls.nodes = static_cast<int64_t>(nx) * ny;
  node_z.resize(balls.nodes);
  node_ball.assign(balls.nodes, 0);
  for (int j = 0; j < ny; j++)
    for (int i = 0; i < nx; i++) {
      const double x = node_x(i), y = node_y(j);
      double z;
      if (!surface.height(x, y, z) || !std::isfinite(z)) {
        node_z[node(i, j)] = std::numeric_limits<double>::quiet_NaN();
        balls.without_surface++;
        continue;
      }
      node_z[node(i, j)] = z;
      if (surface.keep && !surface.keep(x, y)) {
        balls.dropped++;
        continue;
      }
      node_ball[node(i, j)] = 1;
      balls.base++;
    }

  balls.xyz.reserve(3 * balls.base);
  for (int j = 0; j < ny; j++)
    for (int i = 0; i < nx; i++)
      if (node_ball[node(i, j)]) {
        const Point p = node_point(i, j);
        balls.xyz.insert(balls.xyz.end(), {p.x, p.y, p.z});
      }
}

/* ----------------------------------------------------------------------
 cell with balls on all corners: the surface is the bilinear patch between them

 A point p of the patch is the mean of the corners with the weights of the bilinear
 interpolation, so the mean square of its distances to them is the sum of the variances of
 their coordinates, at most S^2/4 + S^2/4 + dz^2/4: the nearest corner is no farther than
 the root of that. Only where this is too far are samples needed.
------------------------------------------------------------------------- */

void Sampler::close_cell(int i, int j)
{
  const double z[4] = {node_z[node(i, j)], node_z[node(i + 1, j)], node_z[node(i, j + 1)],
                       node_z[node(i + 1, j + 1)]};
  const double dz = *std::max_element(z, z + 4) - *std::min_element(z, z + 4);
  if (2.0 * grid.spacing * grid.spacing + dz * dz <= 4.0 * cover2) return;

  sample(node_point(i, j), node_point(i + 1, j), node_point(i, j + 1), node_point(i + 1, j + 1));
  cover_samples();
}

/* ----------------------------------------------------------------------
 height of the surface within cell i,j: between its corners where all have one, so that it
 continues the patches of the neighbor cells
------------------------------------------------------------------------- */

bool Sampler::column_height(int i, int j, double x, double y, double &z) const
{
  const double spare = ROUND_OFF * grid.spacing;
  if (x < grid.xlo - spare || x > grid.xhi + spare) return false;
  if (y < grid.ylo - spare || y > grid.yhi + spare) return false;

  if (has_surface(i, j) && has_surface(i + 1, j) && has_surface(i, j + 1) &&
      has_surface(i + 1, j + 1)) {
    const double u = (x - node_x(i)) / (node_x(i + 1) - node_x(i));
    const double v = (y - node_y(j)) / (node_y(j + 1) - node_y(j));
    const Point low = between(node_point(i, j), node_point(i + 1, j), u);
    const Point high = between(node_point(i, j + 1), node_point(i + 1, j + 1), u);
    z = between(low, high, v).z;
    return true;
  }
  x = std::min(std::max(x, grid.xlo), grid.xhi);
  y = std::min(std::max(y, grid.ylo), grid.yhi);
  return surface.height(x, y, z) && std::isfinite(z);
}

bool Sampler::column_on(int i, int j, double x, double y, double &z) const
{
  return column_height(i, j, x, y, z) && (!surface.keep || surface.keep(x, y));
}

/* ----------------------------------------------------------------------
 where the kept surface ends between a column on it and one off it
------------------------------------------------------------------------- */

Sampler::Rim Sampler::find_rim(int i, int j, const Point &on, const Point &off, bool leaving) const
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
 cell in which the kept surface ends: what there is of it, piece by piece of a finer grid,
 up to the rim; and the scarp below the rim
------------------------------------------------------------------------- */

void Sampler::refine_cell(int i, int j)
{
  if (refined[cell(i, j)]) return;
  refined[cell(i, j)] = 1;

  const double wanted = std::ceil(grid.spacing / (SUBGRID * radius));
  const int n = static_cast<int>(std::min(std::max(wanted, 2.0), MAX_SUBGRID + 0.0));
  std::vector<Point> p(static_cast<size_t>(n + 1) * (n + 1));
  std::vector<char> on(p.size());
  for (int b = 0; b <= n; b++)
    for (int a = 0; a <= n; a++) {
      const size_t k = static_cast<size_t>(b) * (n + 1) + a;
      p[k].x = node_x(i) + (node_x(i + 1) - node_x(i)) * a / n;
      p[k].y = node_y(j) + (node_y(j + 1) - node_y(j)) * b / n;
      p[k].z = 0.0;
      on[k] = column_on(i, j, p[k].x, p[k].y, p[k].z);
    }

  std::vector<Point> piece;
  std::vector<Rim> rims;
  for (int b = 0; b < n; b++)
    for (int a = 0; a < n; a++) {
      const size_t k = static_cast<size_t>(b) * (n + 1) + a;
      const size_t corner[5] = {k, k + 1, k + n + 2, k + n + 1, k};

      piece.clear();
      rims.clear();
      for (int c = 0; c < 4; c++) {
        const size_t here = corner[c], next = corner[c + 1];
        if (on[here]) piece.push_back(p[here]);
        if (on[here] == on[next]) continue;
        if (on[here])
          rims.push_back(find_rim(i, j, p[here], p[next], true));
        else
          rims.push_back(find_rim(i, j, p[next], p[here], false));
        piece.push_back(rims.back().p);
      }

      if (piece.size() == 4 && rims.empty())
        sample(piece[0], piece[1], piece[3], piece[2]);
      else
        for (size_t c = 2; c < piece.size(); c++)
          sample(piece[0], piece[0], piece[c - 1], piece[c]);

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
  cover_samples();

  // the rim leaves the cell through a side: look into the neighbor there

  bool south = false, north = false, west = false, east = false;
  for (int a = 1; a <= n; a++) {
    const size_t row = n + 1, last = row * n;
    south |= on[a] != on[0];
    north |= on[last + a] != on[last];
    west |= on[row * a] != on[0];
    east |= on[row * a + n] != on[n];
  }
  const int stride = nx + 1, here = static_cast<int>(cell(i, j));
  if (south && j >= 0) to_refine.push_back(here - stride);
  if (west && i >= 0) to_refine.push_back(here - 1);
  if (east && i < nx - 1) to_refine.push_back(here + 1);
  if (north && j < ny - 1) to_refine.push_back(here + stride);
}

/* ----------------------------------------------------------------------
 samples of the bilinear patch between four points, a side a00-a10 may have no length
------------------------------------------------------------------------- */

void Sampler::sample(const Point &a00, const Point &a10, const Point &a01, const Point &a11)
{
  const double across = std::sqrt(std::max(distance2(a00, a10), distance2(a01, a11)));
  const double along = std::sqrt(std::max(distance2(a00, a01), distance2(a10, a11)));
  if (across > along) return sample(a00, a01, a10, a11);    // rows across the long direction

  const double nu = std::ceil(across / pitch), nv = std::max(1.0, std::ceil(along / pitch));
  for (double v = 0.0; v <= nv; v++) {
    const Point left = between(a00, a01, v / nv), right = between(a10, a11, v / nv);
    for (double u = 0.0; u <= nu; u++)
      samples.push_back(between(left, right, u / std::max(nu, 1.0)));
    if (samples.size() >= BATCH) cover_samples();
  }
}

/* ----------------------------------------------------------------------
 add balls until every sample is covered, each on the sample farthest from all balls so far
------------------------------------------------------------------------- */

void Sampler::cover_samples()
{
  if (samples.empty()) return;

  // balls that may cover any of the samples

  Point lo = samples[0], hi = samples[0];
  for (const Point &p : samples) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const double cover = std::sqrt(cover2);
  auto clamped = [](double index, int n) {
    return static_cast<int>(std::min(std::max(std::floor(index), -1.0), n - 1.0));
  };
  const int ilo = clamped((lo.x - cover - xfirst) / grid.spacing, nx);
  const int ihi = clamped((hi.x + cover - xfirst) / grid.spacing, nx);
  const int jlo = clamped((lo.y - cover - yfirst) / grid.spacing, ny);
  const int jhi = clamped((hi.y + cover - yfirst) / grid.spacing, ny);

  std::vector<Point> near;
  for (int j = jlo; j <= jhi; j++)
    for (int i = ilo; i <= ihi; i++) {
      if (has_ball(i, j)) near.push_back(node_point(i, j));
      const auto found = extras.find(cell(i, j));
      if (found == extras.end()) continue;
      for (const Point &p : found->second)
        if (p.z > lo.z - cover && p.z < hi.z + cover) near.push_back(p);
    }

  const Point middle = between(lo, hi, 0.5);    // the next ones first: most samples need no more
  std::sort(near.begin(), near.end(), [&](const Point &a, const Point &b) {
    return distance2(a, middle) < distance2(b, middle);
  });

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

    const int i = clamped((ball.x - xfirst) / grid.spacing, nx);
    const int j = clamped((ball.y - yfirst) / grid.spacing, ny);
    extras[cell(i, j)].push_back(ball);
    balls.xyz.insert(balls.xyz.end(), {ball.x, ball.y, ball.z});
    balls.extra++;
    if (balls.base + balls.extra > MAX_COUNT) throw std::length_error("2^31 balls");
  }
  samples.clear();
}

/* ---------------------------------------------------------------------- */

SurfaceBalls Slope::sample_surface(const PlanGrid &grid, double radius, const Surface &surface)
{
  if (!(grid.spacing > 0.0) || !(radius > 0.0))
    throw std::invalid_argument("spacing and radius must be > 0");
  if (!(grid.xlo <= grid.xhi) || !(grid.ylo <= grid.yhi))
    throw std::invalid_argument("the plan rectangle must not be empty");
  return Sampler(grid, radius, surface).run();
}

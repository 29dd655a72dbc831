// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_search.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace Slope;

// Nelder and Mead's simplex for the least of value(point), which is infinite where there is none and
// keeps the best point itself. The first simplex is a point and one a step away along each variable,
// on the other side if there is no value. Ends where its values agree within a share of 1e-7.
template <typename Value>
static void nelder_mead(const std::vector<double> &first, const std::vector<double> &step,
                        int steps, Value value)
{
  typedef std::vector<double> Point;
  const size_t dim = first.size();
  std::vector<Point> simplex(dim + 1, first);
  std::vector<double> f(dim + 1);
  for (size_t k = 0; k <= dim; k++) {
    if (k > 0) simplex[k][k - 1] += step[k - 1];
    f[k] = value(simplex[k]);
    if (k > 0 && f[k] == HUGE_VAL) {
      simplex[k][k - 1] -= 2.0 * step[k - 1];
      f[k] = value(simplex[k]);
    }
  }
  for (int n = 0; n < steps; n++) {
    const size_t low = std::min_element(f.begin(), f.end()) - f.begin();
    const size_t high = std::max_element(f.begin(), f.end()) - f.begin();
    if (f[high] - f[low] < 1.0e-7 * f[low]) break;
    double second = f[low];
    for (size_t k = 0; k <= dim; k++)
      if (k != high) second = std::max(second, f[k]);
    const auto along = [&](double by) {
      Point p(dim);
      for (size_t d = 0; d < dim; d++) {
        double middle = 0.0;
        for (size_t k = 0; k <= dim; k++)
          if (k != high) middle += simplex[k][d] / dim;
        p[d] = middle + by * (simplex[high][d] - middle);
      }
      return p;
    };
    const auto take = [&](const Point &p, double fp) {
      simplex[high] = p;
      f[high] = fp;
    };
    const Point mirror = along(-1.0);
    const double fm = value(mirror);
    if (fm < f[low]) {
      const Point far = along(-2.0);
      const double ff = value(far);
      ff < fm ? take(far, ff) : take(mirror, fm);
    } else if (fm < second)
      take(mirror, fm);
    else {
      const Point near = along(fm < f[high] ? -0.5 : 0.5);
      const double fn = value(near);
      if (fn < std::min(fm, f[high]))
        take(near, fn);
      else
        for (size_t k = 0; k <= dim; k++) {
          if (k == low) continue;
          for (size_t d = 0; d < dim; d++) simplex[k][d] = 0.5 * (simplex[k][d] + simplex[low][d]);
          f[k] = value(simplex[k]);
        }
    }
  }
}

static constexpr double LOWEST = 0.4, HIGHEST = 4.0;    // centres above the ground / size of bodies
static constexpr double RAISE = 1.3;                    // from one height to the next
static constexpr int DEPTHS = 10;                       // radii for each centre
static constexpr int LEAST_PLACES = 12, MOST_PLACES = 64;    // of centres, along the longer side
static constexpr int ACROSS = 24;          // columns across a body, on the lattice
static constexpr double ROUGH = 1.0e-4;    // precision of a factor there
static constexpr double STARTS_OVERLAP = 0.8, OVERLAP = 0.5;    // of bodies on the way to one
static constexpr size_t TRIED = 4000;       // best of the lattice, to find starts among
static constexpr int AGAIN = 8;             // new simplices at most
static constexpr double GAIN = 1.0e-5;      // share of the factor that one must gain
static constexpr double SMALLEST = 10.0;    // body, in cells along its plan

// a cap whose depth is a sixth of its diameter has nearly this volume / diameter^3
static constexpr double CAP = 0.1;

/* ---------------------------------------------------------------------- */

SlipSearch::SlipSearch(const ElevationGrid &_ground, const SlipLimits &_limits,
                       const SlipRanks &_ranks, SlipBodyMaker &_maker) :
    ground(_ground),
    limits(_limits), ranks(_ranks), maker(_maker),
    map(_ground.nx, _ground.ny, _ground.xlo, _ground.ylo, _ground.cell, HUGE_VAL)
{
  lay_lattice();
}

/* ----------------------------------------------------------------------
   distances of the lattice follow from the size of the smallest body
------------------------------------------------------------------------- */

void SlipSearch::lay_lattice()
{
  const double width = ground.xhi() - ground.xlo, length = ground.yhi() - ground.ylo;
  const double whole = std::max(width, length);
  if (limits.volume_lo == 0.0) limits.volume_lo = CAP * std::pow(SMALLEST * ground.cell, 3);
  size_lo = std::cbrt(limits.volume_lo / CAP);
  size_hi = std::max(size_lo, std::min(std::cbrt(limits.volume_hi / CAP), whole));
  spacing = std::max(std::min(0.4 * size_lo, whole / LEAST_PLACES), whole / MOST_PLACES);
  const double middle[2] = {0.5 * (ground.xlo + ground.xhi()), 0.5 * (ground.ylo + ground.yhi())};
  const double extent[2] = {width, length};
  for (int d = 0; d < 2; d++) {    // beyond the terrain, too
    centres[d] = static_cast<int>(extent[d] / spacing) + 3;
    origin[d] = middle[d] - 0.5 * (centres[d] - 1) * spacing;
  }
  centre_on_allowed();
  heights = 1 +
      static_cast<int>(
                std::ceil(std::log(HIGHEST * size_hi / (LOWEST * size_lo)) / std::log(RAISE)));
}

/* ----------------------------------------------------------------------
   bodies in a narrow polygon have their centres on its middle
------------------------------------------------------------------------- */

void SlipSearch::centre_on_allowed()
{
  const std::vector<char> &allowed = maker.allowed;
  int lo[2] = {ground.nx, ground.ny}, hi[2] = {-1, -1};
  for (size_t k = 0; k < allowed.size(); k++) {
    if (!allowed[k]) continue;
    const int at[2] = {static_cast<int>(k % ground.nx), static_cast<int>(k / ground.nx)};
    for (int d = 0; d < 2; d++) {
      lo[d] = std::min(lo[d], at[d]);
      hi[d] = std::max(hi[d], at[d]);
    }
  }
  if (hi[0] < 0) return;
  const double begin[2] = {ground.xlo, ground.ylo};
  for (int d = 0; d < 2; d++) {
    const double middle = begin[d] + 0.5 * (lo[d] + hi[d] + 1) * ground.cell;
    origin[d] += std::remainder(middle - origin[d], spacing);
  }
}

/* ---------------------------------------------------------------------- */

size_t SlipSearch::per_place() const
{
  return static_cast<size_t>(heights) * DEPTHS;
}

/* ---------------------------------------------------------------------- */

double SlipSearch::ground_near(double x, double y) const
{
  const double i = (x - ground.xlo) / ground.cell, j = (y - ground.ylo) / ground.cell;
  return ground.at(static_cast<int>(std::max(0.0, std::min(i, ground.nx - 1.0))),
                   static_cast<int>(std::max(0.0, std::min(j, ground.ny - 1.0))));
}

// distance from a centre to the ground, at some of its cells
double SlipSearch::nearest(double x, double y, double z, double reach) const
{
  const int stride = std::max(1, static_cast<int>(reach / (20.0 * ground.cell)));
  const auto index = [&](double at, int n) {
    return static_cast<int>(std::max(0.0, std::min(at / ground.cell, n - 1.0)));
  };
  const int ihi = index(x + reach - ground.xlo, ground.nx);
  const int jhi = index(y + reach - ground.ylo, ground.ny);
  double least = reach * reach;
  for (int j = index(y - reach - ground.ylo, ground.ny); j <= jhi; j += stride)
    for (int i = index(x - reach - ground.xlo, ground.nx); i <= ihi; i += stride) {
      const double dx = ground.xlo + (i + 0.5) * ground.cell - x;
      const double dy = ground.ylo + (j + 0.5) * ground.cell - y, dz = ground.at(i, j) - z;
      const double square = dx * dx + dy * dy + dz * dz;
      if (square < least) least = square;    // not where there is no value
    }
  return std::sqrt(least);
}

/* ----------------------------------------------------------------------
   radii go below the nearest ground by the depths of caps on a plane between both volumes, and more
------------------------------------------------------------------------- */

SlipSurface SlipSearch::lattice_surface(size_t number) const
{
  const size_t place = number / per_place();
  const int height = static_cast<int>(number % per_place() / DEPTHS), depth = number % DEPTHS;
  const double x = origin[0] + (place % centres[0]) * spacing;
  const double y = origin[1] + (place / centres[0]) * spacing;
  const double above = LOWEST * size_lo * std::pow(RAISE, height);
  const double z = ground_near(x, y) + above;
  if (std::isnan(z)) return {x, y, z, z};
  const double distance = nearest(x, y, z, above);
  const double lo = 0.5 * std::sqrt(CAP * std::pow(size_lo, 3) / (PI * distance));
  const double hi = 2.0 * std::sqrt(CAP * std::pow(size_hi, 3) / (PI * distance));
  return {x, y, z, distance + lo * std::pow(hi / lo, depth / (DEPTHS - 1.0))};
}

/* ---------------------------------------------------------------------- */

int SlipSearch::stride_for(const SlipSurface &s) const
{
  const double above = nearest(s.x, s.y, s.z, s.radius);
  const double across = 2.0 * std::sqrt(std::max(0.0, s.radius * s.radius - above * above));
  return std::max(1, static_cast<int>(across / (ACROSS * ground.cell)));
}

bool SlipSearch::within(const SlipBody &b) const
{
  return b.volume >= limits.volume_lo && b.volume <= limits.volume_hi &&
      b.depth >= limits.depth_lo && b.depth <= limits.depth_hi && b.factor > 0.0 &&
      std::isfinite(b.factor);
}

// exact columns on so many lines, or, with 0, one in each block of cells
bool SlipSearch::compute(const SlipSurface &s, int lines, SlipBody &body)
{
  if (lines == 0) return maker.coarse(s, stride_for(s), body, ROUGH) && within(body);
  return maker.exact(s, body, lines).empty() && within(body);
}

/* ----------------------------------------------------------------------
   all surfaces with a centre above one place
------------------------------------------------------------------------- */

void SlipSearch::above_place(size_t place, double *factors)
{
  SlipBody body;
  for (size_t k = 0; k < per_place(); k++) {
    const SlipSurface s = lattice_surface(place * per_place() + k);
    if (!(s.radius > 0.0) || !maker.coarse(s, stride_for(s), body, ROUGH)) continue;
    if (std::isnan(body.factor)) {
      body.factor = maker.of_moments(ROUGH);
      if (within(body)) left_out = std::min(left_out, body.factor);
    } else if (within(body)) {
      factors[k] = body.factor;
      mark(body);
    }
  }
}

void SlipSearch::mark(const SlipBody &body)
{
  const int stride = stride_for(body.surface);
  const SlipColumns &c = maker.columns();
  for (size_t k = 0; k < c.size(); k++) {
    const double x = body.surface.x + c.dx[k] - ground.xlo,
                 y = body.surface.y + c.dy[k] - ground.ylo;
    const int ilo = static_cast<int>(x / ground.cell) / stride * stride;
    const int jlo = static_cast<int>(y / ground.cell) / stride * stride;
    for (int j = jlo; j < std::min(jlo + stride, ground.ny); j++)
      for (int i = ilo; i < std::min(ilo + stride, ground.nx); i++)
        map.at(i, j) = std::min(map.at(i, j), body.factor);
  }
}

/* ----------------------------------------------------------------------
   the best surfaces of the lattice, the least factor first
------------------------------------------------------------------------- */

SlipSearch::Best SlipSearch::lattice()
{
  std::vector<double> factors(surfaces(), HUGE_VAL);
  const size_t places = static_cast<size_t>(centres[0]) * centres[1];
  ranks.progress("lattice", 0.0);
  for (size_t place = ranks.me; place < places; place += ranks.all) {
    above_place(place, &factors[place * per_place()]);
    ranks.progress("lattice", (place + 1.0) / places);
  }
  ranks.least(factors.data(), factors.size());
  ranks.least(&left_out, 1);
  ranks.least(map.z.data(), map.z.size());
  for (double &f : map.z)
    if (f == HUGE_VAL) f = std::numeric_limits<double>::quiet_NaN();

  std::vector<size_t> order;
  for (size_t k = 0; k < factors.size(); k++)
    if (factors[k] < HUGE_VAL) order.push_back(k);
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return factors[a] != factors[b] ? factors[a] < factors[b] : a < b;
  });
  const auto body = [&](size_t k) {
    SlipBody b = SlipBody();
    b.surface = lattice_surface(k);
    b.factor = factors[k];
    return b;
  };
  Best best;
  for (size_t k = 0; k < std::min(order.size(), TRIED); k++) best.of_all.push_back(body(order[k]));
  std::vector<char> seen(places, 0);
  for (const size_t k : order) {
    char &there = seen[k / per_place()];
    if (!there) best.of_places.push_back(body(k));
    there = 1;
  }
  return best;
}

/* ----------------------------------------------------------------------
   which bodies differ
------------------------------------------------------------------------- */

SlipSearch::Plan SlipSearch::plan(const SlipSurface &s, int stride)
{
  Plan found;
  SlipBody body;
  found.stride = stride ? stride : stride_for(s);
  maker.coarse(s, found.stride, body, ROUGH);    // a body at the edge has a plan, too
  const double block = found.stride * ground.cell;
  const SlipColumns &c = maker.columns();
  for (size_t k = 0; k < c.size(); k++)
    found.blocks.push_back(static_cast<size_t>((s.y + c.dy[k] - ground.ylo) / block) * ground.nx +
                           static_cast<size_t>((s.x + c.dx[k] - ground.xlo) / block));
  std::sort(found.blocks.begin(), found.blocks.end());
  return found;
}

bool SlipSearch::overlap(const Plan &a, const Plan &b, double share) const
{
  const Plan &fine = a.stride <= b.stride ? a : b, &wide = a.stride <= b.stride ? b : a;
  const size_t n = ground.nx;
  size_t common = 0;
  for (const size_t block : fine.blocks) {
    const size_t i = (block % n * fine.stride + fine.stride / 2) / wide.stride;
    const size_t j = (block / n * fine.stride + fine.stride / 2) / wide.stride;
    common += std::binary_search(wide.blocks.begin(), wide.blocks.end(), j * n + i);
  }
  const double area = 1.0 * fine.stride * fine.stride;
  const double smaller =
      std::min(area * fine.blocks.size(), 1.0 * wide.stride * wide.stride * wide.blocks.size());
  return area * common > share * smaller;
}

std::vector<SlipBody> SlipSearch::distinct(std::vector<SlipBody> bodies, size_t most, double share,
                                           int stride)
{
  std::stable_sort(bodies.begin(), bodies.end(), [](const SlipBody &a, const SlipBody &b) {
    return a.factor < b.factor;
  });
  std::vector<SlipBody> kept;
  std::vector<Plan> plans;
  for (const SlipBody &body : bodies) {
    if (kept.size() == most || !(body.factor < HUGE_VAL)) break;
    Plan mine = plan(body.surface, stride);
    bool differs = true;
    for (const Plan &other : plans) differs = differs && !overlap(mine, other, share);
    if (!differs) continue;
    kept.push_back(body);
    plans.push_back(std::move(mine));
  }
  return kept;
}

/* ----------------------------------------------------------------------
   A body at a limit may be beyond it with other columns: then the nearest radius that is within all
   limits. False, with an infinite factor, if there is none.
------------------------------------------------------------------------- */

bool SlipSearch::enter(const SlipBody &start, int lines, SlipBody &body)
{
  static constexpr int TRIES = 40;
  static constexpr double STEP = 0.01;    // of the depth
  for (int k = 0; k < TRIES; k++) {
    SlipSurface s = start.surface;
    s.radius += (k % 2 ? -1 : 1) * ((k + 1) / 2) * STEP * start.depth;
    if (compute(s, lines, body)) return true;
  }
  body = start;
  body.factor = HUGE_VAL;
  return false;
}

/* ----------------------------------------------------------------------
   The variables are the centre, and how far below a pivot the surface passes: the pivot is at the base of
   the first body's thickest column, so that the radius follows the centre. If it is wide, the width's
   logarithm and the direction, too.
------------------------------------------------------------------------- */

SlipBody SlipSearch::improve(const SlipBody &start, bool wide, int lines, int steps)
{
  SlipBody best, body;
  if (!enter(start, lines, best)) return best;
  const SlipColumns &c = maker.columns();
  const size_t thickest = std::max_element(c.thick.begin(), c.thick.end()) - c.thick.begin();
  const SlipSurface first = best.surface;
  const double pivot[3] = {first.x + c.dx[thickest], first.y + c.dy[thickest],
                           first.z - c.depth[thickest]};
  const auto to_pivot = [&](const SlipSurface &s) {    // radius of the surface through it
    const double dx = pivot[0] - s.x, dy = pivot[1] - s.y, dz = pivot[2] - s.z;
    const double cosine = std::cos(s.direction), sine = std::sin(s.direction);
    const double u = dx * cosine + dy * sine, v = (dx * sine - dy * cosine) / s.across;
    return std::sqrt(u * u + v * v + dz * dz);
  };
  const auto value = [&](const std::vector<double> &p) {
    SlipSurface s(p[0], p[1], p[2], 0.0, wide ? p[5] : first.direction);
    s.across = wide ? std::exp(p[4]) : first.across;
    if (s.across > WIDEST || s.across * WIDEST < 1.0) return HUGE_VAL;
    s.radius = p[3] + to_pivot(s);
    if (!(s.radius > 0.0) || !compute(s, lines, body)) return HUGE_VAL;
    if (body.factor < best.factor) best = body;
    return body.factor;
  };
  const double away = 0.2 * std::sqrt(best.area);
  std::vector<double> from = {first.x, first.y, first.z, first.radius - to_pivot(first)};
  std::vector<double> step = {away, away, away, 0.1 * best.depth};
  if (wide) {
    from.insert(from.end(), {std::log(first.across), first.direction});
    step.insert(step.end(), {0.2, 0.1});
  }
  nelder_mead(from, step, steps, value);
  return best;
}

/* ----------------------------------------------------------------------
   shared by the ranks; a new simplex begins where the one before ended, as long as it gains
------------------------------------------------------------------------- */

std::vector<SlipBody> SlipSearch::improve_all(const char *stage,
                                              const std::vector<SlipBody> &starts, bool wide,
                                              int lines, int steps, int again)
{
  static constexpr size_t WIDTH = 10;
  std::vector<double> values(WIDTH * starts.size(), HUGE_VAL);
  ranks.progress(stage, 0.0);
  for (size_t k = ranks.me; k < starts.size(); k += ranks.all) {
    SlipBody b = improve(starts[k], wide, lines, steps);
    for (int n = 0; n < again; n++) {
      const double before = b.factor;
      b = improve(b, wide, lines, steps);
      if (!(before - b.factor > GAIN * before)) break;
    }
    const double of_body[WIDTH] = {
        b.surface.x, b.surface.y, b.surface.z, b.surface.radius, b.surface.direction,
        b.factor,    b.volume,    b.area,      b.depth,          b.surface.across};
    if (b.factor < HUGE_VAL) std::copy(of_body, of_body + WIDTH, &values[WIDTH * k]);
    ranks.progress(stage, (k + 1.0) / starts.size());
  }
  ranks.least(values.data(), values.size());
  std::vector<SlipBody> found;
  for (size_t k = 0; k < starts.size(); k++) {
    const double *v = &values[WIDTH * k];
    SlipSurface s = {v[0], v[1], v[2], v[3], v[4]};
    s.across = v[9];
    if (v[5] < HUGE_VAL) found.push_back({s, v[5], 0.0, v[6], v[7], v[8]});
  }
  return found;
}

/* ----------------------------------------------------------------------
   For one body the best of the lattice that differ, which may all be on one slope; for more also those
   that have a place of their own. On the way to the exact columns, again some of both.
------------------------------------------------------------------------- */

std::vector<SlipBody> SlipSearch::starts()
{
  static constexpr size_t OF_ONE = 12, OF_EACH = 2, MORE = 4;
  const Best best = lattice();
  std::vector<SlipBody> found = distinct(best.of_all, OF_ONE, STARTS_OVERLAP);
  if (limits.keep == 1) return found;
  const auto others = distinct(best.of_places, MORE + OF_EACH * limits.keep, SHARED);
  found.insert(found.end(), others.begin(), others.end());
  return found;
}

std::vector<SlipBody> SlipSearch::apart(const std::vector<SlipBody> &bodies)
{
  static constexpr size_t SPARE = 2;
  std::vector<SlipBody> found = distinct(bodies, 1 + SPARE, OVERLAP);
  if (limits.keep == 1) return found;
  for (const SlipBody &b : distinct(bodies, limits.keep + SPARE, SHARED)) {
    bool there = false;
    for (const SlipBody &other : found)
      there |= b.factor == other.factor && b.surface.x == other.surface.x &&
          b.surface.y == other.surface.y;
    if (!there) found.push_back(b);
  }
  return found;
}

/* ---------------------------------------------------------------------- */

std::vector<SlipBody> SlipSearch::run()
{
  static constexpr int LINES = 96;
  const std::vector<SlipBody> first = starts();
  const std::vector<SlipBody> found = apart(improve_all("simplex", first, false, 0, 100, 1));

  // one that slides into a better one's place is kept as it was on the way, or before

  std::vector<SlipBody> all;
  const auto add = [&all](const std::vector<SlipBody> &more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  const std::vector<SlipBody> way = improve_all("exact columns", found, false, LINES, 100, 0);
  add(improve_all("exact columns", way, false, LINES, 100, AGAIN));
  add(way);
  add(improve_all("exact columns", found, false, LINES, 0, 0));

  // coarse columns led to where exact ones leave no body, as in a narrow polygon

  if (all.empty()) add(improve_all("exact columns", first, false, LINES, 100, AGAIN));
  if (limits.ellipsoids) add(improve_all("ellipsoids", apart(all), true, LINES, 200, AGAIN));
  std::vector<SlipBody> kept = distinct(all, limits.keep, SHARED, 1);
  for (SlipBody &body : kept) {
    maker.exact(body.surface, body, LINES);
    body.yield = maker.yield();
  }
  return kept;
}

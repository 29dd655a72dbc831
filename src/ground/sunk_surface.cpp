// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "sunk_surface.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

using namespace Slope;

static constexpr double INFINITE = std::numeric_limits<double>::infinity();
static constexpr double UNKNOWN = std::numeric_limits<double>::quiet_NaN();

static constexpr double RISE = 0.2;     // beyond the rim the surface rises over the ground by this
static constexpr double REACH = 6.5;    // in sinks: so it has met the ground there
static constexpr double WALL = 2.0;    // in pitches: what ends so deep in the ground ends at a wall
static constexpr int STRIDE = 4;       // every so manyeth column is searched without a hint
static constexpr int AROUND = 4;       // columns around a rim that tell the slope there
static constexpr int RIM_STEPS = 8;    // halvings between two columns
static constexpr int CHAIN_STEPS = 8;
static constexpr int CONTACT_STEPS = 4;
static constexpr double MAX_OF_GROUND = 1.0e14;    // few of which are looked at

/* ---------------------------------------------------------------------- */

SunkSurface::SunkSurface(const Bed &bed_in, double sink_in, double pitch) :
    sink(sink_in), bed(bed_in)
{
  if (!(pitch > 0.0) || !(pitch <= 0.5 * sink))
    throw std::invalid_argument("the pitch must be > 0 and at most half the sink");
  if (!(bed.xlo <= bed.xhi) || !(bed.ylo <= bed.yhi))
    throw std::invalid_argument("the plan rectangle must not be empty");

  const double margin = bed.body ? (bed.ground ? REACH + 1.0 : 1.0) * sink + 2.0 * pitch : 0.0;
  const double wide = std::ceil((bed.xhi - bed.xlo + 2.0 * margin) / pitch + 4.0);
  const double high = std::ceil((bed.yhi - bed.ylo + 2.0 * margin) / pitch + 4.0);
  if (!(std::max(wide, high) < MOST_COUNTED &&
        wide * high < (bed.body ? MOST_COUNTED : MAX_OF_GROUND)))
    throw std::length_error(bed.body ? "2^31 columns" : "2^31 columns along a side, 1e14 in all");

  // columns on all edges of the rectangle

  const int cells_x = std::max(1, static_cast<int>(std::ceil((bed.xhi - bed.xlo) / pitch)));
  const int cells_y = std::max(1, static_cast<int>(std::ceil((bed.yhi - bed.ylo) / pitch)));
  px = bed.xhi > bed.xlo ? (bed.xhi - bed.xlo) / cells_x : pitch;
  py = bed.yhi > bed.ylo ? (bed.yhi - bed.ylo) / cells_y : pitch;
  mx = static_cast<int>(std::ceil(margin / px));
  my = static_cast<int>(std::ceil(margin / py));
  nx = cells_x + 1 + 2 * mx;
  ny = cells_y + 1 + 2 * my;
  xlo = bed.xlo - mx * px;
  ylo = bed.ylo - my * py;
  xhi = bed.xhi + mx * px;
  yhi = bed.yhi + my * py;
  z.reset(INFINITE);

  if (bed.body) {
    measure(bed);
    if (bed.ground) trim(bed);
    go_on(bed, edges());
    bed = Bed();
  }
  sort_rims();
}

/* ----------------------------------------------------------------------
   the squares of columns that a ball around x,y may touch, of a surface that is no body
------------------------------------------------------------------------- */

void SunkSurface::look_around(double x, double y) const
{
  const int side = z.SIDE;
  const auto square = [side](double from, double pitch, int n) {
    return std::min(std::max(static_cast<int>(from / pitch), 0), n - 1) / side;
  };
  const int ihi = square(x + sink - xlo + px, px, nx), jhi = square(y + sink - ylo + py, py, ny);
  for (int b = square(y - sink - ylo, py, ny); b <= jhi; b++)
    for (int a = square(x - sink - xlo, px, nx); a <= ihi; a++) {
      if (z.has_square(a * side, b * side)) continue;
      z.at(a * side, b * side) = INFINITE;
      for (int j = b * side; j < std::min((b + 1) * side, ny); j++)
        for (int i = a * side; i < std::min((a + 1) * side, nx); i++) {
          double height;
          if (bed.height(std::min(column_x(i), bed.xhi), std::min(column_y(j), bed.yhi), UNKNOWN,
                         height) &&
              std::isfinite(height))
            z.at(i, j) = height;
        }
    }
}

double SunkSurface::lowest() const
{
  double found = INFINITE;
  z.each([&](int, int, double height) {
    found = std::min(found, height);
  });
  return found - sink;
}

bool SunkSurface::has(int i, int j) const
{
  return i >= 0 && i < nx && j >= 0 && j < ny && z.get(i, j) < INFINITE;
}

/* ----------------------------------------------------------------------
   the surface in its columns: every few are searched from scratch, those between near the heights
   of the neighbors and of the four around; where none of these has the surface, there is none between
------------------------------------------------------------------------- */

bool SunkSurface::look_at(const Bed &bed, int i, int j, double near)
{
  const double x = std::min(column_x(i), bed.xhi), y = std::min(column_y(j), bed.yhi);
  double height;
  const bool there = bed.height(x, y, near, height) && std::isfinite(height);
  if (there) z.at(i, j) = height;
  return there;
}

void SunkSurface::measure(const Bed &bed)
{
  const int iend = nx - 1 - mx, jend = ny - 1 - my;
  for (int j = my;; j = std::min(j + STRIDE, jend)) {
    for (int i = mx;; i = std::min(i + STRIDE, iend)) {
      look_at(bed, i, j, UNKNOWN);
      if (i == iend) break;
    }
    if (j == jend) break;
  }

  for (int j = my; j <= jend; j++)
    for (int i = mx; i <= iend; i++) {
      const int west = i - (i - mx) % STRIDE, east = std::min(west + STRIDE, iend);
      const int south = j - (j - my) % STRIDE, north = std::min(south + STRIDE, jend);
      if ((i == west || i == iend) && (j == south || j == jend)) continue;
      const int close[6][2] = {{i - 1, j},    {i, j - 1},    {west, south},
                               {east, south}, {west, north}, {east, north}};
      bool there = false;
      for (int k = 0; k < 6 && !there; k++)
        if (has(close[k][0], close[k][1]))
          there = look_at(bed, i, j, z.get(close[k][0], close[k][1]));
    }
}

/* ----------------------------------------------------------------------
   towards its rim a body may be thinner than what the search for it sees in every column
------------------------------------------------------------------------- */

void SunkSurface::trim(const Bed &bed)
{
  const double thin = std::max(px, py);
  std::vector<std::pair<int, int>> todo;
  auto look_around = [&](int i, int j) {
    for (int b = -1; b <= 1; b++)
      for (int a = -1; a <= 1; a++)
        if (has(i + a, j + b)) todo.push_back({i + a, j + b});
  };
  z.each([&](int i, int j, double height) {
    if (height < INFINITE && !(has(i - 1, j) && has(i + 1, j) && has(i, j - 1) && has(i, j + 1)))
      todo.push_back({i, j});
  });

  while (!todo.empty()) {
    const int i = todo.back().first, j = todo.back().second;
    todo.pop_back();
    double top;
    if (!has(i, j) || !bed.ground(column_x(i), column_y(j), UNKNOWN, top)) continue;
    if (top - z.get(i, j) >= thin) continue;
    z.at(i, j) = INFINITE;
    look_around(i, j);
  }
}

std::vector<SunkSurface::Edge> SunkSurface::edges() const
{
  std::vector<Edge> found;
  z.each([&](int i, int j, double height) {
    if (!(height < INFINITE) || i < 1 || i > nx - 2 || j < 1 || j > ny - 2) return;
    if (!has(i - 1, j)) found.push_back({i, j, -1, 0});
    if (!has(i + 1, j)) found.push_back({i, j, 1, 0});
    if (!has(i, j - 1)) found.push_back({i, j, 0, -1});
    if (!has(i, j + 1)) found.push_back({i, j, 0, 1});
  });
  return found;
}

/* ----------------------------------------------------------------------
   slope of the plane through the columns around one, by least squares; false if they lie in a line
------------------------------------------------------------------------- */

bool SunkSurface::plane(int i, int j, double &gx, double &gy) const
{
  double n = 0.0, sx = 0.0, sy = 0.0, sz = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, xz = 0.0, yz = 0.0;
  for (int b = -AROUND; b <= AROUND; b++)
    for (int a = -AROUND; a <= AROUND; a++) {
      if (a * a + b * b > AROUND * AROUND || !has(i + a, j + b)) continue;
      const double dz = z.get(i + a, j + b) - z.get(i, j);
      n += 1.0;
      sx += a;
      sy += b;
      sz += dz;
      xx += a * a;
      xy += a * b;
      yy += b * b;
      xz += a * dz;
      yz += b * dz;
    }
  xx -= sx * sx / n;
  xy -= sx * sy / n;
  yy -= sy * sy / n;
  xz -= sx * sz / n;
  yz -= sy * sz / n;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1.0e-6 * n * n)) return false;
  gx = (xz * yy - yz * xy) / (determinant * px);
  gy = (yz * xx - xz * xy) / (determinant * py);
  return true;
}

/* ----------------------------------------------------------------------
   the surface ends at a wall between two columns: its points up to there
------------------------------------------------------------------------- */

void SunkSurface::end_at(const Bed &bed, const Edge &edge)
{
  const Point on = {column_x(edge.i), column_y(edge.j), z.get(edge.i, edge.j)};
  const double xoff = column_x(edge.i + edge.di), yoff = column_y(edge.j + edge.dj);
  Point rim = on;
  double t = 0.0, t_off = 1.0;
  for (int k = 0; k < RIM_STEPS; k++) {
    const double middle = 0.5 * (t + t_off);
    Point p = {on.x + middle * (xoff - on.x), on.y + middle * (yoff - on.y), 0.0};
    if (bed.height(p.x, p.y, rim.z, p.z)) {
      t = middle;
      rim = p;
    } else {
      t_off = middle;
    }
  }
  rims.push_back(rim);
  add_rim(bed, on, rim);
}

// points between two of them, until they lie close enough on a steep surface

void SunkSurface::add_rim(const Bed &bed, const Point &from, const Point &to)
{
  const double pitch = std::max(px, py);
  const double length = std::max(std::fabs(to.x - from.x), std::fabs(to.y - from.y));
  if (std::fabs(to.z - from.z) < pitch || length * (1 << CHAIN_STEPS) < pitch) return;
  Point middle = {0.5 * (from.x + to.x), 0.5 * (from.y + to.y), 0.0};
  if (!bed.height(middle.x, middle.y, to.z, middle.z) &&
      !bed.height(middle.x, middle.y, from.z, middle.z))
    return;
  rims.push_back(middle);
  add_rim(bed, from, middle);
  add_rim(bed, middle, to);
}

/* ----------------------------------------------------------------------
   Beyond its rim. A surface that comes out of the ground there goes on in its plane, above the
   ground. One that ends deep in the ground ends at a wall, which the filter or another side of the
   body makes.
------------------------------------------------------------------------- */

void SunkSurface::go_on(const Bed &bed, const std::vector<Edge> &found)
{
  struct Ramp {
    int i, j;
    double gx, gy, under;    // slope; depth below the ground
  };
  std::vector<Ramp> ramps(1);    // the first stands for walls
  struct Nearest {
    int ramp;
    float distance2;
  };
  SparsePlane<Nearest> nearest;
  nearest.reset({-1, HUGE_VALF});
  const double pitch = std::max(px, py), reach = bed.ground ? REACH * sink : 0.0;
  const int wide = static_cast<int>(reach / px), high = static_cast<int>(reach / py);

  for (size_t e = 0, next; e < found.size(); e = next) {
    const int i = found[e].i, j = found[e].j;
    Ramp ramp = {i, j, 0.0, 0.0, 0.0};
    double top;
    const bool sloped = bed.ground && plane(i, j, ramp.gx, ramp.gy) &&
        bed.ground(column_x(i), column_y(j), UNKNOWN, top);
    if (sloped) ramp.under = top - z.get(i, j);
    bool rises = false;
    for (next = e; next < found.size() && found[next].i == i && found[next].j == j; next++) {
      const Edge &edge = found[next];
      const double on = z.get(i, j) + edge.di * px * ramp.gx + edge.dj * py * ramp.gy;
      if (sloped && bed.ground(column_x(i + edge.di), column_y(j + edge.dj), UNKNOWN, top) &&
          on > top - WALL * pitch)
        rises = true;
      else
        end_at(bed, edge);
    }
    if (rises) ramps.push_back(ramp);
    const int mine = rises ? static_cast<int>(ramps.size()) - 1 : 0;
    for (int b = std::max(j - high, 0); b <= std::min(j + high, ny - 1); b++)
      for (int a = std::max(i - wide, 0); a <= std::min(i + wide, nx - 1); a++) {
        const double dx = (a - i) * px, dy = (b - j) * py, d2 = dx * dx + dy * dy;
        if (d2 > reach * reach || d2 >= nearest.get(a, b).distance2 * (1.0 - 1.0e-6)) continue;
        if (z.get(a, b) < INFINITE) continue;
        nearest.at(a, b) = {mine, static_cast<float>(d2)};
      }
  }

  nearest.each([&](int i, int j, const Nearest &n) {
    double top;
    if (n.ramp <= 0 || !bed.ground(column_x(i), column_y(j), UNKNOWN, top)) return;
    const Ramp &ramp = ramps[n.ramp];
    const double dx = (i - ramp.i) * px, dy = (j - ramp.j) * py;
    const double away = std::max(0.0, std::sqrt(dx * dx + dy * dy) - 2.0 * pitch);
    z.at(i, j) = std::max(z.get(ramp.i, ramp.j) + dx * ramp.gx + dy * ramp.gy,
                          top - ramp.under + RISE * away);
  });
}

void SunkSurface::sort_rims()
{
  bins_x = bins_y = 0;
  if (rims.empty()) return;
  bins_x = static_cast<int>((xhi - xlo) / sink) + 1;
  bins_y = static_cast<int>((yhi - ylo) / sink) + 1;
  auto bin = [this](const Point &p) {
    return static_cast<size_t>((p.y - ylo) / sink) * bins_x +
        static_cast<size_t>((p.x - xlo) / sink);
  };
  first.assign(static_cast<size_t>(bins_x) * bins_y + 1, 0);
  for (const Point &p : rims) first[bin(p) + 1]++;
  for (size_t b = 1; b < first.size(); b++) first[b] += first[b - 1];
  std::vector<int> next(first.begin(), first.end() - 1);
  std::vector<Point> sorted(rims.size());
  for (const Point &p : rims) sorted[next[bin(p)]++] = p;
  rims.swap(sorted);
}

/* ----------------------------------------------------------------------
   the surface between four columns: height and slope
------------------------------------------------------------------------- */

bool SunkSurface::patch(double x, double y, double &height, double &gx, double &gy) const
{
  if (!(x >= xlo && x <= xhi && y >= ylo && y <= yhi)) return false;
  const int i = std::min(static_cast<int>((x - xlo) / px), nx - 2);
  const int j = std::min(static_cast<int>((y - ylo) / py), ny - 2);
  const double low[2] = {z.get(i, j), z.get(i + 1, j)};
  const double high[2] = {z.get(i, j + 1), z.get(i + 1, j + 1)};
  if (!(low[0] < INFINITE && low[1] < INFINITE && high[0] < INFINITE && high[1] < INFINITE))
    return false;
  const double u = (x - column_x(i)) / px, v = (y - column_y(j)) / py;
  const double east = low[1] - low[0], north = high[0] - low[0];
  const double both = high[1] - high[0] - east;
  height = low[0] + u * east + v * north + u * v * both;
  gx = (east + v * both) / px;
  gy = (north + u * both) / py;
  return true;
}

/* ----------------------------------------------------------------------
   Lowest z of a ball that touches a point of the surface. First over the columns within reach, then
   from the best of them by steps to the point c of the patches between them where the ball around
   x,y touches: there x - c is the slope's plan part of the ball's radius.
------------------------------------------------------------------------- */

bool SunkSurface::height(double x, double y, double &lowest) const
{
  if (!(x >= xlo && x <= xhi && y >= ylo && y <= yhi)) return false;
  if (bed.height) look_around(x, y);
  const double sink2 = sink * sink;
  lowest = INFINITE;
  double cx = x, cy = y;
  auto touch = [&](double px_, double py_, double pz) {
    const double dx = px_ - x, dy = py_ - y, d2 = sink2 - dx * dx - dy * dy;
    const double above = pz - lowest;
    if (d2 < 0.0 || (above >= 0.0 && above * above >= d2)) return;    // most need no root
    lowest = pz - std::sqrt(d2);
    cx = px_;
    cy = py_;
  };

  // the column below is close to the best, and leaves few that may be better

  const int inear = static_cast<int>((x - xlo) / px), jnear = static_cast<int>((y - ylo) / py);
  if (has(inear, jnear)) touch(column_x(inear), column_y(jnear), z.get(inear, jnear));

  const int jlo = std::max(0, static_cast<int>(std::ceil((y - sink - ylo) / py)));
  const int jhi = std::min(ny - 1, static_cast<int>((y + sink - ylo) / py));
  for (int j = jlo; j <= jhi; j++) {
    const double dy = column_y(j) - y, half = std::sqrt(std::max(0.0, sink2 - dy * dy));
    const int ilo = std::max(0, static_cast<int>(std::ceil((x - half - xlo) / px)));
    const int ihi = std::min(nx - 1, static_cast<int>((x + half - xlo) / px));
    for (int i = ilo, next; i <= ihi; i = next) {
      const double *height = z.run(i, j, ihi + 1, next);
      if (!height) continue;
      for (int k = i; k < next; k++)
        if (height[k - i] - half < lowest) touch(column_x(k), column_y(j), height[k - i]);
    }
  }
  const int bx = static_cast<int>((x - xlo) / sink), by = static_cast<int>((y - ylo) / sink);
  for (int b = std::max(by - 1, 0); b <= std::min(by + 1, bins_y - 1); b++)
    for (int a = std::max(bx - 1, 0); a <= std::min(bx + 1, bins_x - 1); a++) {
      const size_t bin = static_cast<size_t>(b) * bins_x + a;
      for (int k = first[bin]; k < first[bin + 1]; k++) touch(rims[k].x, rims[k].y, rims[k].z);
    }
  if (!(lowest < INFINITE)) return false;

  const double vx = cx, vy = cy;
  for (int side = 0; side < 4; side++) {
    double top, gx, gy, ax = vx + (side % 2 - 0.5) * px, ay = vy + (side / 2 - 0.5) * py;
    for (int step = 0; step < CONTACT_STEPS && patch(ax, ay, top, gx, gy); step++) {
      touch(ax, ay, top);
      const double length = std::sqrt(1.0 + gx * gx + gy * gy);
      ax = x - sink * gx / length;
      ay = y - sink * gy / length;
    }
  }
  return true;
}

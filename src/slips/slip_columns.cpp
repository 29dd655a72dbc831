// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace Slope;

static constexpr double GAUSS = 0.28867513459481287;    // from the middle, of an interval
static constexpr double TOUCH = 1.0e-9;                 // of a cell: ends of runs that are one
static constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

/* ---------------------------------------------------------------------- */

void SlipColumns::clear()
{
  rocky = true;    // the bedrock's, too
  resize(0);
  volume = plan_area = greatest_depth = 0.0;
  at_edge = overhang = outside = rocky = false;
}

std::vector<std::vector<double> *> SlipColumns::arrays()
{
  std::vector<std::vector<double> *> all = {&dx,     &dy,  &depth,    &area,     &thick,
                                            &weight, &arm, &cohesion, &friction, &pore};
  if (rocky) all.insert(all.end(), {&slope_x, &slope_y});
  return all;
}

void SlipColumns::resize(size_t n)
{
  for (std::vector<double> *v : arrays()) v->resize(n);
}

void SlipColumns::keep(size_t first, size_t last, size_t to)
{
  if (first == to) return;
  for (std::vector<double> *v : arrays())
    std::copy(v->begin() + first, v->begin() + last, v->begin() + to);
}

/* ---------------------------------------------------------------------- */

SlipColumnMaker::SlipColumnMaker(const ElevationGrid &_ground, const SlipSoil &_soil,
                                 const std::vector<char> &_allowed) :
    ground(_ground),
    soil(_soil), allowed(_allowed), cosine(1.0), sine(0.0), rocky(_soil.has_bedrock())
{
  if (rocky) rock = soil.bedrock_below(ground);
}

/* ---------------------------------------------------------------------- */

void SlipColumnMaker::begin(const SlipSurface &s, SlipColumns &columns)
{
  surface = s;
  cosine = std::cos(s.direction);
  sine = std::sin(s.direction);
  columns.clear();
  columns.rocky = rocky;
  runs.clear();
  outside.clear();
}

// of the surface below the centre; 0 beside it
double SlipColumnMaker::depth(double dx, double dy) const
{
  const double u = (dx * cosine + dy * sine) / surface.along;
  const double v = surface.beyond(dx * sine - dy * cosine) / surface.across;
  const double square = surface.radius * surface.radius - u * u - v * v;
  return square > 0.0 ? std::sqrt(square) : 0.0;
}

// the ground above the base, which is the surface, or the bedrock where that is higher
bool SlipColumnMaker::is_above(double zground, double deep, const Rock &r) const
{
  return deep > 0.0 && zground > surface.z - deep && !(zground <= r.z);
}

void SlipColumnMaker::add(SlipColumns &c, double dx, double dy, double deep, const Rock &r,
                          double zground, double area)
{
  const bool on_rock = rocky && r.z > surface.z - deep;
  const double depth = on_rock ? surface.z - r.z : deep;
  if (rocky) {
    c.slope_x.push_back(on_rock ? r.slope_x : NONE);
    c.slope_y.push_back(on_rock ? r.slope_y : NONE);
  }
  const double x = surface.x + dx, y = surface.y + dy, zbase = surface.z - depth;
  const SlipSoil::State state = soil.state(x, y, zbase, zground);
  c.dx.push_back(dx);
  c.dy.push_back(dy);
  c.depth.push_back(depth);
  c.area.push_back(area);
  c.weight.push_back(state.weight * area);
  c.arm.push_back(surface.z - state.height);
  c.cohesion.push_back(state.cohesion);
  c.friction.push_back(state.friction);
  c.pore.push_back(state.pore);

  c.thick.push_back(zground - zbase);
  runs.back().volume += c.thick.back() * area;
  runs.back().last = c.size();
  bool out = false;
  if (!allowed.empty()) {
    const int i = static_cast<int>((x - ground.xlo) / ground.cell);
    const int j = static_cast<int>((y - ground.ylo) / ground.cell);
    out = !allowed[static_cast<size_t>(std::min(j, ground.ny - 1)) * ground.nx +
                   std::min(i, ground.nx - 1)];
  }
  outside.push_back(out);
}

// the run that ends here on this line, or a new one
SlipColumnMaker::Run &SlipColumnMaker::run_from(int line, double lo, const SlipColumns &c)
{
  const bool goes_on = !runs.empty() && runs.back().line == line && !runs.back().unknown &&
      std::fabs(runs.back().hi - lo) <= TOUCH * ground.cell;
  if (!goes_on)
    runs.push_back({line, runs.size(), lo, lo, c.size(), c.size(), 0.0, false, false, false});
  return runs.back();
}

/* ---------------------------------------------------------------------- */

bool SlipColumnMaker::coarse(const SlipSurface &s, int stride, SlipColumns &c)
{
  begin(s, c);
  const double half = s.half_y(), step = stride * ground.cell;
  const int jlo = std::max(0.0, std::floor((s.y - half - ground.ylo) / step));
  const int jhi = std::min((ground.ny - 1.0) / stride, (s.y + half - ground.ylo) / step);
  for (int j = jlo; j <= jhi; j++) coarse_row(c, j, stride);
  return finish(c);
}

void SlipColumnMaker::coarse_row(SlipColumns &c, int j, int stride)
{
  const double half = surface.half_x(), step = stride * ground.cell;
  const int row = std::min(j * stride + stride / 2, ground.ny - 1);
  const double dy = ground.ylo + (row + 0.5) * ground.cell - surface.y;
  const int ilo = std::floor((surface.x - half - ground.xlo) / step) - 1;
  const int ihi = std::floor((surface.x + half - ground.xlo) / step) + 1;
  const int last = (ground.nx - 1) / stride;
  const bool edge_row = j == 0 || j == (ground.ny - 1) / stride;
  bool was_inside = false, was_wall = false;
  for (int i = std::max(ilo, 0); i <= std::min(ihi, last); i++) {
    const int column = std::min(i * stride + stride / 2, ground.nx - 1);
    const double dx = ground.xlo + (column + 0.5) * ground.cell - surface.x;
    const double z = ground.at(column, row), deep = depth(dx, dy);
    const Rock below = rock_in_cell(column, row);
    const double lo = ground.xlo + i * step;
    if (std::isnan(z) && deep > 0.0)
      runs.push_back({j, runs.size(), lo, lo + step, c.size(), c.size(), 0.0, true, false, false});
    const bool inside = is_above(z, deep, below);
    const bool wall = deep <= 0.0 && z > std::fmax(surface.z, below.z);
    if (inside) {
      Run &run = run_from(j, lo, c);
      run.hi = lo + step;
      run.overhang |= was_wall;
      run.at_edge |= edge_row || i == 0 || i == last;
      add(c, dx, dy, deep, below, z, step * step);
    } else if (was_inside && wall)
      runs.back().overhang = true;
    was_inside = inside;
    was_wall = wall;
  }
}

// slopes between the neighbouring cells that have a value
SlipColumnMaker::Rock SlipColumnMaker::rock_in_cell(int i, int j) const
{
  if (!rocky) return {NONE, NONE, NONE};
  const double z = rock.at(i, j);
  const auto slope = [&](double before, double after) {
    const double lo = std::isnan(before) ? z : before, hi = std::isnan(after) ? z : after;
    const int cells = !std::isnan(before) + !std::isnan(after);
    return cells ? (hi - lo) / (cells * ground.cell) : 0.0;
  };
  const auto at = [&](int column, int row) {
    const bool beside = column < 0 || row < 0 || column == ground.nx || row == ground.ny;
    return beside ? NONE : rock.at(column, row);
  };
  return {z, slope(at(i - 1, j), at(i + 1, j)), slope(at(i, j - 1), at(i, j + 1))};
}

/* ----------------------------------------------------------------------
   the ground along a line in x
------------------------------------------------------------------------- */

void SlipColumnMaker::row_of(double y, int &j, double &t) const
{
  const double at = (y - ground.ylo) / ground.cell - 0.5;
  j = std::max(0.0, std::min(std::floor(at), ground.ny - 2.0));
  t = ground.ny > 1 ? at - j : 0.0;
}

double SlipColumnMaker::between_rows(const ElevationGrid &grid, int i, int j, double t)
{
  const double a = grid.at(i, j);
  if (t == 0.0) return a;
  const double b = grid.at(i, j + 1);
  return t == 1.0 ? b : a + t * (b - a);
}

SlipColumnMaker::Node SlipColumnMaker::node(int i, int j, double t) const
{
  Node n = {ground.xlo + (i + 0.5) * ground.cell, between_rows(ground, i, j, t), NONE, NONE};
  if (!rocky) return n;
  n.rock = between_rows(rock, i, j, t);
  n.rock_slope_y = ground.ny > 1 ? (rock.at(i, j + 1) - rock.at(i, j)) / ground.cell : 0.0;
  return n;
}

// work(from, to) for all straight pieces of the ground above the surface's plan
template <typename Work> void SlipColumnMaker::along(double y, Work work) const
{
  int j;
  double t;
  row_of(y, j, t);
  const double half = surface.half_x(), h = ground.cell, xhi = ground.xhi();
  const double lo = std::max(surface.x - half, ground.xlo), hi = std::min(surface.x + half, xhi);
  if (!(lo < hi)) return;
  const int pieces = std::max(ground.nx - 1, 1);
  const int first = std::max(0.0, std::min(std::floor((lo - ground.xlo) / h - 0.5), pieces - 1.0));
  for (int i = first; i < pieces; i++) {
    const Node p = node(i, j, t);
    Node q = ground.nx > 1 ? node(i + 1, j, t) : p;
    q.x = p.x + h;
    const double from = i == 0 ? ground.xlo : p.x, to = i == pieces - 1 ? xhi : q.x;
    if (from >= hi) return;
    const auto at = [&](double x) {
      const Rock r = p.rock_at(q, x);
      return Node{x, p.ground_at(q, x), r.z, r.slope_y};
    };
    if (from == p.x && to == q.x)
      work(p, q);
    else
      work(at(from), at(to));
  }
}

/* ----------------------------------------------------------------------
   places on a straight piece of the ground where the surface may begin or end, with both ends: a piece
   beside the surface has only these. On a line the surface's plan is (u/A)^2 + (v/B)^2 <= R^2, u and
   v linear in x but for the bends at the ends of a straight part.
------------------------------------------------------------------------- */

void SlipColumnMaker::find_cuts(double y, const Node &p, const Node &q)
{
  cuts.assign({p.x, q.x});
  const double dy = y - surface.y, length = q.x - p.x;
  const double slope = (q.z - p.z) / length, h = 0.5 * surface.straight;

  // v = v0 + v1 dx and u = u0 + u1 dx, from the centre

  const double u0 = -dy * sine, u1 = -cosine, v0 = -dy * cosine, v1 = sine;
  const double a2 = surface.along * surface.along, b2 = surface.across * surface.across;
  const auto keep = [&](double dx) {
    const double x = surface.x + dx;
    if (x > p.x && x < q.x) cuts.push_back(x);
  };
  const auto roots = [&](double a, double b, double c) {    // a x^2 + 2 b x + c = 0
    const double square = b * b - a * c;
    if (!(square >= 0.0)) return;
    const double r = -(b + std::copysign(std::sqrt(square), b));
    if (a != 0.0) keep(r / a);
    if (r != 0.0) keep(c / r);
  };

  const double z0 = p.z + slope * (surface.x - p.x) - surface.z;    // ground at dx = 0
  const double rise = (q.rock - p.rock) / length;    // of the bedrock: no number if there is none
  const double r0 = p.rock + rise * (surface.x - p.x) - surface.z;
  for (int part = h > 0.0 ? -1 : 0; part <= (h > 0.0 ? 1 : 0); part++) {
    const double w0 = h > 0.0 && part == 0 ? 0.0 : v0 - part * h,
                 w1 = h > 0.0 && part == 0 ? 0.0 : v1;
    const double a = u1 * u1 / a2 + w1 * w1 / b2, b = u0 * u1 / a2 + w0 * w1 / b2;
    const double c = u0 * u0 / a2 + w0 * w0 / b2 - surface.radius * surface.radius;
    roots(a, b, c);                                                   // the rim of the plan
    roots(a + slope * slope, b + z0 * slope, c + z0 * z0);            // the ground
    if (rocky) roots(a + rise * rise, b + r0 * rise, c + r0 * r0);    // the bedrock
    if (part != 0 && v1 != 0.0) keep((part * h - v0) / v1);
  }
  if (rocky && rise != slope) keep((z0 - r0) / (rise - slope));    // where the bedrock crops out
  std::sort(cuts.begin(), cuts.end());
}

bool SlipColumnMaker::is_cut(double y)
{
  bool found = false;
  along(y, [&](const Node &p, const Node &q) {
    if (found || !std::isfinite(p.z + q.z)) return;
    find_cuts(y, p, q);
    for (size_t k = 0; k + 1 < cuts.size() && !found; k++) {
      const double x = 0.5 * (cuts[k] + cuts[k + 1]);
      const double deep = depth(x - surface.x, y - surface.y);
      found = cuts[k + 1] > cuts[k] && is_above(p.ground_at(q, x), deep, p.rock_at(q, x));
    }
  });
  return found;
}

/* ----------------------------------------------------------------------
   where the body begins and ends in y, by lines and then by bisection
------------------------------------------------------------------------- */

bool SlipColumnMaker::extent_in_y(int lines, double &lo, double &hi)
{
  const double half = surface.half_y();
  const double ylo = std::max(surface.y - half, ground.ylo);
  const double yhi = std::min(surface.y + half, ground.yhi());
  if (!(ylo < yhi)) return false;
  const double step = (yhi - ylo) / lines;
  int first = -1, last = -1;
  for (int k = 0; k < lines; k++)
    if (is_cut(ylo + (k + 0.5) * step)) {
      if (first < 0) first = k;
      last = k;
    }
  if (first < 0) return false;
  const auto end = [&](double out, double in) {
    if (is_cut(out)) return out;
    for (int k = 0; k < 30; k++) {
      const double middle = 0.5 * (out + in);
      (is_cut(middle) ? in : out) = middle;
    }
    return in;
  };
  lo = end(first == 0 ? ylo : ylo + (first - 0.5) * step, ylo + (first + 0.5) * step);
  hi = end(last == lines - 1 ? yhi : ylo + (last + 1.5) * step, ylo + (last + 0.5) * step);
  return hi > lo;
}

/* ---------------------------------------------------------------------- */

bool SlipColumnMaker::exact(const SlipSurface &s, SlipColumns &c, int lines)
{
  begin(s, c);
  double lo, hi;
  if (!extent_in_y(lines, lo, hi)) return false;

  // pieces in y end at the rows of the cells' centres, where the ground has its bends

  const double h = ground.cell, widest = 2.0 * (hi - lo) / lines;
  const int parts = std::ceil(std::min(0.25 * lines * h / s.half_x(), 1.0 * lines));
  int number = 0;
  for (double y = lo; y < hi;) {
    const double row = std::floor((y - ground.ylo) / h + 0.5 + TOUCH) + 0.5;
    const double next = std::min(hi, std::max(ground.ylo + row * h, y + TOUCH * h));
    const int pieces = std::ceil((next - y) / widest);
    const double width = (next - y) / pieces;
    for (int k = 0; k < pieces; k++) {
      const double middle = y + (k + 0.5) * width;
      line(c, number++, middle - GAUSS * width, 0.5 * width, parts);
      line(c, number++, middle + GAUSS * width, 0.5 * width, parts);
    }
    y = next;
  }
  for (Run &run : runs)    // nearest to an edge of the terrain that is inside of the surface's plan
    run.at_edge |= (run.line == 0 && lo <= ground.ylo) ||
        (run.line == number - 1 && hi >= ground.yhi());
  return finish(c);
}

void SlipColumnMaker::line(SlipColumns &c, int number, double y, double width, int parts)
{
  along(y, [&](const Node &p, const Node &q) {
    piece(c, number, y, width, parts, p, q);
  });
}

void SlipColumnMaker::piece(SlipColumns &c, int number, double y, double width, int parts,
                            const Node &p, const Node &q)
{
  const double dy = y - surface.y;
  if (!std::isfinite(p.z + q.z)) {
    if (depth(0.5 * (p.x + q.x) - surface.x, dy) > 0.0)
      runs.push_back({number, runs.size(), p.x, q.x, c.size(), c.size(), 0.0, true, false, false});
    return;
  }

  find_cuts(y, p, q);
  const std::vector<double> &at = cuts;
  const auto wall_at = [&](double x) {    // the surface is vertical there, and the ground higher
    return p.ground_at(q, x) > std::fmax(surface.z, p.rock_at(q, x).z) + TOUCH * surface.radius &&
        depth(x - surface.x, dy) < 1.0e-4 * surface.radius;
  };
  for (size_t k = 0; k + 1 < at.size(); k++) {
    const double lo = at[k], hi = at[k + 1], middle = 0.5 * (lo + hi);
    if (!(hi > lo)) continue;
    const double deep = depth(middle - surface.x, dy);
    if (!is_above(p.ground_at(q, middle), deep, p.rock_at(q, middle))) continue;
    Run &run = run_from(number, lo, c);
    run.hi = hi;
    run.overhang |= wall_at(lo) || wall_at(hi);
    run.at_edge |= lo <= ground.xlo || hi >= ground.xhi();
    const int n = std::max(1.0, std::ceil(parts * (hi - lo) / ground.cell));
    const double step = (hi - lo) / n;
    for (int m = 0; m < 2 * n; m++) {
      const double x = lo + (m / 2 + 0.5) * step + (m % 2 ? GAUSS : -GAUSS) * step;
      const double below = depth(x - surface.x, dy);
      if (!(below > 0.0)) continue;    // of a sliver at a vertical rim, by rounding: it has no dip
      add(c, x - surface.x, dy, below, p.rock_at(q, x), p.ground_at(q, x), 0.5 * step * width);
    }
  }
}

/* ----------------------------------------------------------------------
   the largest connected part is the body; columns of others are taken out
------------------------------------------------------------------------- */

size_t SlipColumnMaker::root(size_t k)
{
  while (runs[k].parent != k) k = runs[k].parent = runs[runs[k].parent].parent;
  return k;
}

// runs on one line or on lines side by side that touch; what is unknown makes an edge of the others
void SlipColumnMaker::connect()
{
  size_t before = 0;    // of the line before
  for (size_t k = 0; k < runs.size(); k++) {
    while (runs[before].line < runs[k].line - 1) before++;
    for (size_t m = before; m < k; m++) {
      Run &a = runs[m], &b = runs[k];
      const double slack = TOUCH * ground.cell;
      if (a.hi < b.lo - slack || b.hi < a.lo - slack) continue;
      if (a.unknown || b.unknown) {
        a.at_edge |= b.unknown;
        b.at_edge |= a.unknown;
      } else {
        const size_t from = root(k), to = root(m);
        runs[std::max(from, to)].parent = std::min(from, to);
      }
    }
  }
}

bool SlipColumnMaker::finish(SlipColumns &c)
{
  if (c.size() == 0) return false;
  connect();
  std::vector<double> volumes(runs.size(), 0.0);
  for (size_t k = 0; k < runs.size(); k++) volumes[root(k)] += runs[k].volume;
  const size_t body = std::max_element(volumes.begin(), volumes.end()) - volumes.begin();

  size_t kept = 0;
  for (size_t k = 0; k < runs.size(); k++) {
    if (root(k) != body) continue;
    c.at_edge |= runs[k].at_edge;
    c.overhang |= runs[k].overhang;
    const size_t first = runs[k].first, last = runs[k].last;
    c.keep(first, last, kept);
    for (size_t i = first; i < last; i++) c.outside |= outside[i] != 0;
    kept += last - first;
  }
  c.resize(kept);
  c.volume = volumes[body];
  for (size_t i = 0; i < kept; i++) {
    c.plan_area += c.area[i];
    c.greatest_depth = std::max(c.greatest_depth, c.thick[i]);
  }
  return true;
}

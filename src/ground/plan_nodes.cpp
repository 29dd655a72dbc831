// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "plan_nodes.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

using namespace Slope;

static constexpr double ASIDE = 1.0e-6;    // of the spacing: farther than rounding
static const double NaN = std::numeric_limits<double>::quiet_NaN();

constexpr int PlanNodes::TILE;
constexpr double PlanNodes::ROUND_OFF;

// nodes first .. first+count-1 of one direction lie between lo and hi
static void node_range(double lo, double hi, double origin, double spacing, double &first,
                       double &count)
{
  first = std::ceil((lo - origin) / spacing - PlanNodes::ROUND_OFF);
  count = std::max(0.0, std::floor((hi - origin) / spacing + PlanNodes::ROUND_OFF) - first + 1.0);
}

double Slope::count_nodes(const NodeGrid &g)
{
  double first, nx, ny;
  node_range(g.xlo, g.xhi, g.xorigin, g.spacing, first, nx);
  node_range(g.ylo, g.yhi, g.yorigin, g.spacing, first, ny);
  return nx * ny;
}

static int exponent(int tile)
{
  int n = 0;
  while (n < 30 && 1 << n < tile) n++;
  if (1 << n != tile) throw std::invalid_argument("a tile must be a power of two");
  return n;
}

/* ---------------------------------------------------------------------- */

PlanNodes::PlanNodes(const NodeGrid &g, const GroundHeights &s, int tile_in) :
    grid(g), surface(s), tile(tile_in), shift(exponent(tile_in)), known(0), nothing{NaN, false}
{
  if (!(g.spacing > 0.0)) throw std::invalid_argument("the spacing must be > 0");
  if (!(g.xlo <= g.xhi) || !(g.ylo <= g.yhi))
    throw std::invalid_argument("the plan rectangle must not be empty");
  double ifirst, jfirst, ni, nj;
  node_range(g.xlo, g.xhi, g.xorigin, g.spacing, ifirst, ni);
  node_range(g.ylo, g.yhi, g.yorigin, g.spacing, jfirst, nj);
  if ((ni + 2.0) * (nj + 2.0) > MOST_COUNTED) throw std::length_error("plan grid of 2^31 nodes");
  xfirst = g.xorigin + ifirst * g.spacing;
  yfirst = g.yorigin + jfirst * g.spacing;
  nx = static_cast<int>(ni);
  ny = static_cast<int>(nj);
  tiles_x = (nx + tile - 1) >> shift;
  tiles_y = (ny + tile - 1) >> shift;
  tiles.resize(static_cast<size_t>(tiles_x) * tiles_y);
}

double PlanNodes::x(int i) const
{
  const double at = xfirst + i * grid.spacing;
  return i < 0 || i >= nx ? at : std::min(std::max(at, grid.xlo), grid.xhi);
}

double PlanNodes::y(int j) const
{
  const double at = yfirst + j * grid.spacing;
  return j < 0 || j >= ny ? at : std::min(std::max(at, grid.ylo), grid.yhi);
}

/* ---------------------------------------------------------------------- */

const PlanNodes::Look &PlanNodes::at(int i, int j)
{
  if (i < 0 || i >= nx || j < 0 || j >= ny) return nothing;
  const int number = (j >> shift) * tiles_x + (i >> shift);
  const Tile &found = tiles[number] ? *tiles[number] : make_tile(number);
  return found.nodes[static_cast<size_t>(j & (tile - 1)) * std::min(tile, nx) + (i & (tile - 1))];
}

const PlanNodes::Tile &PlanNodes::make_tile(int number)
{
  const int ilo = (number % tiles_x) * tile, jlo = (number / tiles_x) * tile;
  const int wide = std::min(tile, nx), high = std::min(tile, ny);
  std::unique_ptr<Tile> looks(new Tile);
  looks->nodes.assign(static_cast<size_t>(wide) * high, nothing);
  looks->balls = 0;
  looks->inside = (std::min(ilo + tile, nx) - ilo) * (std::min(jlo + tile, ny) - jlo);
  for (int j = jlo; j < std::min(jlo + tile, ny); j++)
    for (int i = ilo; i < std::min(ilo + tile, nx); i++) {
      Look &here = looks->nodes[static_cast<size_t>(j - jlo) * wide + (i - ilo)];
      double z;
      if (!surface.height(x(i), y(j), z) || !std::isfinite(z)) continue;
      here.z = z;
      here.ball = !surface.keep || surface.keep(x(i), y(j));
      looks->balls += here.ball;
    }
  tiles[number] = std::move(looks);
  known++;
  return *tiles[number];
}

double PlanNodes::probe(int i, int j) const
{
  const double px = x(i), py = y(j), off = ASIDE * grid.spacing;
  const double at[5][2] = {
      {px, py}, {px - off, py}, {px + off, py}, {px, py - off}, {px, py + off}};
  double height = 0.0, z;
  int balls = 0;
  for (int k = 0; k < 5; k++) {
    const double kx = std::min(std::max(at[k][0], grid.xlo), grid.xhi);
    const double ky = std::min(std::max(at[k][1], grid.ylo), grid.yhi);
    const bool there = surface.height(kx, ky, z) && std::isfinite(z);
    balls += there && (!surface.keep || surface.keep(kx, ky));
    if (k == 0) height = z;
  }
  if (balls == 5) return height;
  return balls == 0 ? NaN : -HUGE_VAL;
}

PlanNodes::Balls PlanNodes::around(int i, int j)
{
  bool all = true, none = true;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, tiles_y - 1); b++)
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, tiles_x - 1); a++) {
      const int number = b * tiles_x + a;
      const Tile &found = tiles[number] ? *tiles[number] : make_tile(number);
      all &= found.balls == found.inside;
      none &= found.balls == 0;
      if (!all && !none) return SOME;
    }
  return all ? ALL : NONE;
}

void PlanNodes::forget(int jlo, int jhi)
{
  for (size_t k = 0; k < tiles.size(); k++) {
    const int row = static_cast<int>(k / tiles_x);
    if (!tiles[k] || (row >= jlo && row <= jhi)) continue;
    tiles[k].reset();
    known--;
  }
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_sampler.h"

#include <algorithm>
#include <climits>
#include <cstddef>
#include <stdexcept>

using namespace Slope;

static constexpr int MOST_HIDDEN =
    24;                             // cells that a rim is followed without corners that show it
static constexpr int BLOCK = 32;    // cells: more than a rim and the reach of a cell
static constexpr int NOT_REFINED = INT_MAX;    // a steep cell that no rim runs through
static constexpr int64_t OF_CELL = PlacedBall::OF_CELL;
static constexpr size_t LEAST_KNOWN = 1024;    // tiles whose nodes are remembered

/* ---------------------------------------------------------------------- */

SurfaceSampler::SurfaceSampler(const NodeGrid &grid, double radius, const GroundHeights &surface,
                               int tile) :
    nodes(grid, surface, tile),
    closer(nodes, radius)
{
  if (!(radius > 0.0)) throw std::invalid_argument("radius must be > 0");
}

void SurfaceSampler::forget()
{
  nodes.forget();
  leaky.clear();
}

void SurfaceSampler::remember_less(int tile_j)
{
  if (nodes.looked_at() < std::max(LEAST_KNOWN, static_cast<size_t>(5 * nodes.tiles_x))) return;
  nodes.forget(tile_j - 1, tile_j + 1);
  leaky.clear();
}

/* ---------------------------------------------------------------------- */

TilePlan SurfaceSampler::tiles() const
{
  return {nodes.xfirst, nodes.yfirst, nodes.tile * nodes.grid.spacing, nodes.tiles_x,
          nodes.tiles_y};
}

bool SurfaceSampler::has_balls(int tile)
{
  const int i0 = tile % nodes.tiles_x * nodes.tile, j0 = tile / nodes.tiles_x * nodes.tile;
  remember_less(tile / nodes.tiles_x);
  for (int j = j0; j < std::min(j0 + nodes.tile, nodes.ny); j++)
    for (int i = i0; i < std::min(i0 + nodes.tile, nodes.nx); i++)
      if (nodes.has_ball(i, j)) return true;
  return false;
}

/* ----------------------------------------------------------------------
   the balls on the nodes of a tile, and the extra ones of its cells
------------------------------------------------------------------------- */

void SurfaceSampler::sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts)
{
  const int ti = tile % nodes.tiles_x, tj = tile / nodes.tiles_x, size = nodes.tile;
  const int i1 = std::min((ti + 1) * size, nodes.nx), j1 = std::min((tj + 1) * size, nodes.ny);
  remember_less(tj);
  for (int j = tj * size; j < j1; j++)
    for (int i = ti * size; i < i1; i++) {
      const PlanNodes::Look &look = nodes.at(i, j);
      if (look.ball)
        balls.push_back({nodes.x(i), nodes.y(j), look.z, nodes.cell(i, j) * OF_CELL, 0});
      counts.base += look.ball;
      counts.dropped += look.surface() && !look.ball;
      counts.without_surface += !look.surface();
    }

  close_rims_around(ti, tj);
  for (int j = tj == 0 ? -1 : tj * size; j < j1; j++)
    for (int i = ti == 0 ? -1 : ti * size; i < i1; i++) {
      if (!closer.in_range(i, j)) continue;
      const int64_t cell = nodes.cell(i, j);
      if (closer.kind(i, j) == SurfaceCloser::STEEP && !closed.count(cell) && belongs(cell))
        close_patch(cell);
      const auto found = closed.find(cell);
      if (found == closed.end()) continue;
      int64_t number = cell * OF_CELL;
      for (const SurfaceCloser::Point &p : found->second)
        balls.push_back({p.x, p.y, p.z, ++number, 0});
      counts.extra += found->second.size();
    }
}

// whether the cells of a tile and of those around it have all corners with a ball, or none

bool SurfaceSampler::uniform(int ti, int tj)
{
  const PlanNodes::Balls around = nodes.around(ti, tj);
  const bool strip = (ti <= 1 && closer.ilo < 0) || (tj <= 1 && closer.jlo < 0) ||
      (ti >= nodes.tiles_x - 2 && closer.ihi == nodes.nx) ||
      (tj >= nodes.tiles_y - 2 && closer.jhi == nodes.ny);
  return around == PlanNodes::NONE || (around == PlanNodes::ALL && !strip);
}

// A rim may come into the tile from cells beyond it, without a corner here that shows it

void SurfaceSampler::close_rims_around(int ti, int tj)
{
  const int size = nodes.tile;
  if (size > MOST_HIDDEN && uniform(ti, tj)) return;
  const int i0 = std::max(ti * size - MOST_HIDDEN - 1, closer.ilo);
  const int j0 = std::max(tj * size - MOST_HIDDEN - 1, closer.jlo);
  const int i1 = std::min((ti + 1) * size + MOST_HIDDEN, closer.ihi);
  const int j1 = std::min((tj + 1) * size + MOST_HIDDEN, closer.jhi);
  for (int j = j0; j < j1; j++)
    for (int i = i0; i < i1; i++) {
      const int64_t cell = nodes.cell(i, j);
      if (closer.kind(i, j) == SurfaceCloser::RIM && !closed.count(cell)) close_patch(cell);
    }
}

/* ----------------------------------------------------------------------
   Patches of cells that decide on one another's balls
------------------------------------------------------------------------- */

bool SurfaceSampler::belongs(int64_t cell)
{
  const int i = nodes.cell_i(cell), j = nodes.cell_j(cell);
  const SurfaceCloser::Kind kind = closer.kind(i, j);
  if (kind != SurfaceCloser::STEEP) return kind == SurfaceCloser::RIM;
  const auto known = leaky.find(cell);
  if (known != leaky.end()) return known->second;
  return leaky[cell] = closer.leaks(i, j);
}

// The cells of a patch: those that belong by themselves, and those that a rim runs through. How far a
// rim has come without showing may be known better later: then it goes on from there again.

void SurfaceSampler::collect(int64_t seed)
{
  Steps todo = {{seed, NOT_REFINED}};
  std::unordered_set<int64_t> blocks;
  patch.clear();
  while (!todo.empty()) {
    const int64_t cell = todo.back().first;
    const int i = nodes.cell_i(cell), j = nodes.cell_j(cell);
    const int hidden = closer.kind(i, j) == SurfaceCloser::RIM ? 0 : todo.back().second;
    todo.pop_back();
    const auto known = patch.find(cell);
    if (known != patch.end() && known->second.hidden <= hidden) continue;
    if (known == patch.end()) {
      patch[cell].hidden = NOT_REFINED;
      const int reach = closer.reach;
      for (int b = j - reach; b <= j + reach; b++)
        for (int a = i - reach; a <= i + reach; a++)
          if (closer.in_range(a, b) && !patch.count(nodes.cell(a, b)) && belongs(nodes.cell(a, b)))
            todo.push_back({nodes.cell(a, b), NOT_REFINED});
      join_rims(i, j, blocks, todo);
    }
    if (hidden != NOT_REFINED) follow_rim(cell, hidden, todo);
  }
}

void SurfaceSampler::join_rims(int i, int j, std::unordered_set<int64_t> &blocks, Steps &todo)
{
  const int bi = (i + BLOCK) / BLOCK, bj = (j + BLOCK) / BLOCK;    // i, j >= -1
  if (!blocks.insert(nodes.cell(bi, bj)).second) return;
  if (nodes.tile == BLOCK && i >= 0 && j >= 0 && i < nodes.nx && j < nodes.ny &&
      uniform(i / BLOCK, j / BLOCK))
    return;
  const int i0 = std::max((bi - 2) * BLOCK, closer.ilo),
            i1 = std::min((bi + 1) * BLOCK, closer.ihi);
  const int j0 = std::max((bj - 2) * BLOCK, closer.jlo),
            j1 = std::min((bj + 1) * BLOCK, closer.jhi);
  for (int b = j0; b < j1; b++)
    for (int a = i0; a < i1; a++) {
      const int64_t cell = nodes.cell(a, b);
      if (closer.kind(a, b) == SurfaceCloser::RIM && !closed.count(cell) && !patch.count(cell))
        todo.push_back({cell, 0});
    }
}

void SurfaceSampler::follow_rim(int64_t cell, int hidden, Steps &todo)
{
  const int i = nodes.cell_i(cell), j = nodes.cell_j(cell);
  Member &member = patch[cell];
  member.hidden = hidden;
  if (member.columns.z.empty()) member.columns = closer.columns_of(i, j);
  if (hidden == MOST_HIDDEN) return;
  for (const int64_t next : closer.rim_goes_on(i, j, member.columns))
    todo.push_back({next, hidden + 1});
}

// In the order in which all cells of the ground would be closed: row by row, then the cells that only
// the rim leads to

void SurfaceSampler::close_patch(int64_t seed)
{
  collect(seed);
  std::vector<int64_t> cells;
  for (const auto &member : patch) cells.push_back(member.first);
  std::sort(cells.begin(), cells.end());

  closer.start();
  std::unordered_map<int64_t, bool> refined;
  Steps rim;
  auto refine = [&](int64_t cell, int hidden) {
    if (hidden > MOST_HIDDEN || refined[cell]) return;
    refined[cell] = true;
    const int i = nodes.cell_i(cell), j = nodes.cell_j(cell);
    const SurfaceCloser::Columns &columns = patch.at(cell).columns;
    closer.refine(i, j, columns);
    for (const int64_t next : closer.rim_goes_on(i, j, columns)) rim.push_back({next, hidden + 1});
  };
  for (const int64_t cell : cells) {
    const int i = nodes.cell_i(cell), j = nodes.cell_j(cell);
    const SurfaceCloser::Kind kind = closer.kind(i, j);
    if (kind == SurfaceCloser::STEEP) closer.close(i, j);
    if (kind == SurfaceCloser::RIM) refine(cell, 0);
  }
  for (size_t k = 0; k < rim.size(); k++) refine(rim[k].first, rim[k].second);

  for (const int64_t cell : cells) {
    Points &balls = closed[cell];
    balls = closer.take(cell);
    if (balls.size() >= OF_CELL - 1)
      throw std::length_error("a cell of the plan grid needs 2^20 balls");
  }
  patch.clear();
}

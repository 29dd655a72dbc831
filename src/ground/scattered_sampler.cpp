// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "scattered_sampler.h"

#include <algorithm>
#include <cmath>

using namespace Slope;

constexpr double ScatteredSampler::WIDEST;

static constexpr double NEAREST = 0.795;    // of the spacing: gives one ball per spacing^2
static constexpr size_t MOST = 1 << 18;     // candidates of 48 bytes that are remembered

/* ---------------------------------------------------------------------- */

ScatteredSampler::ScatteredSampler(const NodeGrid &g, const GroundHeights &s, uint64_t seed_in,
                                   int tile) :
    grid(g),
    seed(seed_in), side(tile * ScatteredLattice::FINER), plan(0.0, 0.0, tile * g.spacing, 0, 0)
{
  lattices.emplace_back(g, s, seed);
  const ScatteredLattice &all = lattices[0];
  plan.xlo = g.xorigin + all.first[0] * all.cell;
  plan.ylo = g.yorigin + all.first[1] * all.cell;
  plan.nx = static_cast<int>((all.n[0] + tile - 1) / tile);
  plan.ny = static_cast<int>((all.n[1] + tile - 1) / tile);
}

void ScatteredSampler::add(double spacing, const GroundHeights &s)
{
  NodeGrid other = grid;
  other.spacing = spacing;
  lattices.emplace_back(other, s, seed, lattices.back().end());
  for (ScatteredLattice &lattice : lattices) lattice.glance = 1;    // a zone may be narrow
}

void ScatteredSampler::forget()
{
  for (ScatteredLattice &lattice : lattices) lattice.forget();
}

/* ----------------------------------------------------------------------
   which of the candidates are balls
------------------------------------------------------------------------- */

// those nearer to a candidate than two balls may be, of all lattices: visit(other, its lattice)

template <typename Visit>
bool ScatteredSampler::any_near(const Candidate &c, size_t lattice, Visit visit)
{
  for (size_t k = 0; k < lattices.size(); k++) {
    const double spacing = std::min(lattices[lattice].spacing, lattices[k].spacing);
    if (lattices[k].any_near(c, NEAREST * spacing, [&](Candidate &other) {
          return visit(other, k);
        }))
      return true;
  }
  return false;
}

// a ball settles all candidates around it; two lattices may have the same rank

void ScatteredSampler::decide(Candidate &c, size_t lattice)
{
  const bool near_ball = any_near(c, lattice, [&](Candidate &other, size_t its) {
    if (other.rank > c.rank || (other.rank == c.rank && its >= lattice)) return false;
    if (other.state == ScatteredLattice::UNKNOWN) decide(other, its);
    return other.state == ScatteredLattice::BALL;
  });
  const bool is_ball = !near_ball && lattices[lattice].kept(c.x, c.y);
  c.state = is_ball ? ScatteredLattice::BALL : ScatteredLattice::NONE;
  if (!is_ball) return;
  any_near(c, lattice, [](Candidate &other, size_t) {
    if (other.state == ScatteredLattice::UNKNOWN) other.state = ScatteredLattice::NONE;
    return false;
  });
}

/* ----------------------------------------------------------------------
   the balls that lie in a tile, some of which belong to cells before it
------------------------------------------------------------------------- */

// cells of a lattice that lie in a tile

ScatteredSampler::Cells ScatteredSampler::cells_of(int tile, const ScatteredLattice &lattice) const
{
  const double scale = lattices[0].cell / lattice.cell;
  const int64_t i0 = lattices[0].first[0] + static_cast<int64_t>(tile % plan.nx) * side;
  const int64_t j0 = lattices[0].first[1] + static_cast<int64_t>(tile / plan.nx) * side;
  return {static_cast<int64_t>(std::floor(i0 * scale)),
          static_cast<int64_t>(std::ceil((i0 + side) * scale)) - 1,
          static_cast<int64_t>(std::floor(j0 * scale)),
          static_cast<int64_t>(std::ceil((j0 + side) * scale)) - 1};
}

void ScatteredSampler::sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts)
{
  const Cells own = cells_of(tile, lattices[0]);
  const double cell = lattices[0].cell;
  size_t known = 0;
  for (const ScatteredLattice &lattice : lattices) known += lattice.remembered();
  if (known > MOST) forget();
  const size_t before = balls.size();
  for (size_t k = 0; k < lattices.size(); k++) {
    const Cells in = cells_of(tile, lattices[k]);
    lattices[k].any_of(in.ilo - 1, in.ihi, in.jlo - 1, in.jhi, [&](Candidate &c) {
      const double x = (c.x - grid.xorigin) / cell, y = (c.y - grid.yorigin) / cell;
      if (x < own.ilo || x >= own.ihi + 1 || y < own.jlo || y >= own.jhi + 1) return false;
      if (c.state == ScatteredLattice::UNKNOWN) decide(c, k);
      if (c.state == ScatteredLattice::BALL) balls.push_back({c.x, c.y, c.z, c.number, 0});
      return false;
    });
  }
  counts.base += balls.size() - before;
}

bool ScatteredSampler::has_balls(int tile)
{
  for (const ScatteredLattice &lattice : lattices) {
    const Cells in = cells_of(tile, lattice);
    if (lattice.any_place(in.ilo, in.ihi, in.jlo, in.jhi)) return true;
  }
  return false;
}

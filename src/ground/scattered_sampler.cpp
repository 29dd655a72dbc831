// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "scattered_sampler.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace Slope;

constexpr int ScatteredLattice::FINER;
constexpr double ScatteredSampler::WIDEST;

static constexpr int RIM_STEPS = 8;        // halvings between a place on the surface and one off it
static constexpr int OF_EDGE = 1 << 13;    // candidates between two neighbors, at most
static constexpr double NEAREST = 0.795;    // of the spacing: gives one ball per spacing^2
static constexpr size_t MOST = 1 << 18;     // candidates of 48 bytes that are remembered

// mixes all bits of a number (the finalizer of the SplitMix64 generator, Steele et al. 2014)

static uint64_t mix(uint64_t x)
{
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/* ---------------------------------------------------------------------- */

ScatteredLattice::ScatteredLattice(const NodeGrid &g, const GroundHeights &s, uint64_t seed_in,
                                   int64_t before_in) :
    spacing(g.spacing),
    cell(g.spacing / FINER), glance(GLANCE), grid(g), surface(s), seed(mix(seed_in)),
    before(before_in)
{
  if (!(g.spacing > 0.0)) throw std::invalid_argument("the spacing must be > 0");
  if (!(g.xlo <= g.xhi) || !(g.ylo <= g.yhi))
    throw std::invalid_argument("the plan rectangle must not be empty");

  // a spacing more on each side: a cell may have candidates between it and the next one

  const double lo[2] = {g.xlo - g.xorigin, g.ylo - g.yorigin};
  const double hi[2] = {g.xhi - g.xorigin, g.yhi - g.yorigin};
  for (int d = 0; d < 2; d++) {
    const int64_t from = whole(lo[d] / g.spacing) - 1;
    n[d] = whole(hi[d] / g.spacing) + 2 - from;
    first[d] = from * FINER;
  }
  if (before + static_cast<double>(n[0]) * n[1] > MOST_COUNTED)
    throw std::length_error("plan grid of 2^31 nodes");
}

/* ----------------------------------------------------------------------
   candidates
------------------------------------------------------------------------- */

bool ScatteredLattice::on_surface(double x, double y, double &z) const
{
  if (x < grid.xlo || x > grid.xhi || y < grid.ylo || y > grid.yhi) return false;
  return surface.height(x, y, z) && std::isfinite(z);
}

// where a hash puts it: half of its bits for x, half for y

ScatteredLattice::Place ScatteredLattice::place(int64_t i, int64_t j) const
{
  static constexpr double OF_BITS = 1.0 / 4294967296.0;
  Place p;
  p.hash = mix(mix(seed ^ static_cast<uint64_t>(i)) ^ static_cast<uint64_t>(j));
  p.x = grid.xorigin + (i + OF_BITS * static_cast<uint32_t>(p.hash)) * cell;
  p.y = grid.yorigin + (j + OF_BITS * (p.hash >> 32)) * cell;
  p.z = 0.0;
  // where zones divide the ground, whether it is kept is found out faster than its height
  p.on = (!of_zones() || kept(p.x, p.y)) && on_surface(p.x, p.y, p.z);
  return p;
}

void ScatteredLattice::make(Block &made, int64_t bi, int64_t bj) const
{
  // What is kept takes long to find out. Where none of some places of a block is, none is; where all are, the
  // others are asked when they would be balls; only a block that a rim runs through must know all of them.

  const int wide = BLOCK + 1;
  std::vector<Place> places(static_cast<size_t>(wide) * wide);
  int on = 0, off = 0;
  for (int b = 0; b < wide; b += glance)
    for (int a = 0; a < wide; a += glance) {
      const Place &p = places[b * wide + a] = place(bi * BLOCK + a, bj * BLOCK + b);
      if (of_zones() || p.on) ((of_zones() ? p.on : kept(p.x, p.y)) ? on : off)++;
    }
  std::fill_n(made.first, BLOCK * BLOCK + 1, 0);
  if (on == 0 && off > 0) return;
  for (int b = 0; b < wide; b++)
    for (int a = 0; a < wide; a++) {
      Place &p = places[b * wide + a];
      if (a % glance || b % glance) p = place(bi * BLOCK + a, bj * BLOCK + b);
      if (off > 0 && !of_zones()) p.on = p.on && kept(p.x, p.y);
    }

  for (int b = 0; b < BLOCK; b++)
    for (int a = 0; a < BLOCK; a++) {
      const int64_t i = bi * BLOCK + a - first[0], j = bj * BLOCK + b - first[1];
      const int64_t number = (before + j / FINER * n[0] + i / FINER) * PlacedBall::OF_CELL +
          (j % FINER * FINER + i % FINER) * (2 * OF_EDGE);
      const Place &here = places[b * wide + a];
      made.first[b * BLOCK + a] = static_cast<int>(made.candidates.size());
      if (here.on)
        made.candidates.push_back({here.x, here.y, here.z, mix(here.hash), number, UNKNOWN});
      add_between(made, here, places[b * wide + a + 1], mix(here.hash + 1), number + 1);
      add_between(made, here, places[(b + 1) * wide + a], mix(here.hash + 2), number + 1 + OF_EDGE);
    }
  made.first[BLOCK * BLOCK] = static_cast<int>(made.candidates.size());
}

/* ----------------------------------------------------------------------
   candidates between two neighbors: on the chord where they differ in height; where one of them has no
   surface, at the rim, and from there down to what is below
------------------------------------------------------------------------- */

void ScatteredLattice::add_between(Block &made, const Place &a, const Place &b, uint64_t hash,
                                   int64_t number) const
{
  if (a.on && b.on)
    add_chord(made, a, b, hash, number);
  else if (a.on || b.on)
    add_rim(made, a.on ? a : b, a.on ? b : a, hash, number);
}

void ScatteredLattice::add_chord(Block &made, const Place &a, const Place &b, uint64_t hash,
                                 int64_t number) const
{
  const double steps = std::fabs(b.z - a.z) / cell;
  if (!(steps < OF_EDGE - 2.0))
    throw std::length_error("the surface steps by more than a thousand spacings");
  const int between = static_cast<int>(steps);
  for (int k = 1; k <= between; k++) {
    const double w = k / (between + 1.0);
    made.candidates.push_back({a.x + w * (b.x - a.x), a.y + w * (b.y - a.y), a.z + w * (b.z - a.z),
                               mix(hash + k), number + k, UNKNOWN});
  }
}

void ScatteredLattice::add_rim(Block &made, const Place &on, const Place &off, uint64_t hash,
                               int64_t number) const
{
  Place rim = on, foot = off;
  for (int k = 0; k < RIM_STEPS; k++) {
    Place middle = {0.5 * (rim.x + foot.x), 0.5 * (rim.y + foot.y), 0.0, 0, true};
    const bool in = on_surface(middle.x, middle.y, middle.z) && kept(middle.x, middle.y);
    (in ? rim : foot) = middle;
  }
  made.candidates.push_back({rim.x, rim.y, rim.z, mix(hash), number, UNKNOWN});

  // a scar is a cut into the ground: what hovers above the ground leaves none

  double z;
  if (!surface.scar || foot.x < grid.xlo || foot.x > grid.xhi || foot.y < grid.ylo ||
      foot.y > grid.yhi || !surface.height(foot.x, foot.y, z) ||
      !surface.scar(foot.x, foot.y, foot.z) || foot.z > z + cell)
    return;
  foot.x = rim.x;
  foot.y = rim.y;
  add_chord(made, rim, foot, hash, number);
}

/* ---------------------------------------------------------------------- */

ScatteredLattice::Block &ScatteredLattice::block(int64_t bi, int64_t bj)
{
  std::unique_ptr<Block> &found = blocks[bj * (int64_t(1) << 32) + bi];
  if (!found) {
    found.reset(new Block);
    make(*found, bi, bj);
    found->candidates.shrink_to_fit();
    known += found->candidates.size();
  }
  return *found;
}

bool ScatteredLattice::any_place(int64_t ilo, int64_t ihi, int64_t jlo, int64_t jhi) const
{
  for (int64_t j = jlo; j <= jhi; j += FINER)
    for (int64_t i = ilo; i <= ihi; i += FINER) {
      const Place p = place(i, j);
      if (p.on && (of_zones() || kept(p.x, p.y))) return true;
    }
  return false;
}

/* ---------------------------------------------------------------------- */

template <typename Visit>
bool ScatteredLattice::any_of(int64_t ilo, int64_t ihi, int64_t jlo, int64_t jhi, Visit visit)
{
  for (int64_t bj = jlo >> BLOCK_BITS; bj <= jhi >> BLOCK_BITS; bj++)
    for (int64_t bi = ilo >> BLOCK_BITS; bi <= ihi >> BLOCK_BITS; bi++) {
      Block &its = block(bi, bj);
      const int64_t i0 = bi * BLOCK, j0 = bj * BLOCK;
      const int a0 = static_cast<int>(std::max(ilo, i0) - i0);
      const int a1 = static_cast<int>(std::min(ihi, i0 + BLOCK - 1) - i0) + 1;
      const int b0 = static_cast<int>(std::max(jlo, j0) - j0);
      const int b1 = static_cast<int>(std::min(jhi, j0 + BLOCK - 1) - j0) + 1;
      for (int b = b0; b < b1; b++)
        for (int k = its.first[b * BLOCK + a0]; k < its.first[b * BLOCK + a1]; k++)
          if (visit(its.candidates[k])) return true;
    }
  return false;
}

template <typename Visit>
bool ScatteredLattice::any_near(const Candidate &c, double distance, Visit visit)
{
  const double x = (c.x - grid.xorigin) / cell, y = (c.y - grid.yorigin) / cell;
  const double reach = distance / cell, near2 = std::pow(distance, 2.0);
  return any_of(whole(x - reach) - 1, whole(x + reach), whole(y - reach) - 1, whole(y + reach),
                [&](Candidate &other) {
                  const double dx = other.x - c.x, dy = other.y - c.y, dz = other.z - c.z;
                  return dx * dx + dy * dy + dz * dz < near2 && visit(other);
                });
}

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

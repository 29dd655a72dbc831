// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "scattered_lattice.h"

#include <stdexcept>

using namespace Slope;

constexpr int ScatteredLattice::FINER;

static constexpr int RIM_STEPS = 8;        // halvings between a place on the surface and one off it
static constexpr int OF_EDGE = 1 << 13;    // candidates between two neighbors, at most

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
  if (before + static_cast<double>(n[0]) * n[1] > 2147483647.0)
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
  // where zones divide the ground, whether it is kept is found out faster than its height
  static constexpr double OF_BITS = 1.0 / 4294967296.0;
  Place p;
  p.hash = mix(mix(seed ^ static_cast<uint64_t>(i)) ^ static_cast<uint64_t>(j));
  p.x = grid.xorigin + (i + OF_BITS * static_cast<uint32_t>(p.hash)) * cell;
  p.y = grid.yorigin + (j + OF_BITS * (p.hash >> 32)) * cell;
  p.z = 0.0;
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

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Where scattered balls of one spacing may be: points of the surface, one in each cell of a plan lattice that
   is finer than the spacing, where a hash of the cell puts it; where two neighbors differ in height, or the
   surface ends between them, more of them in between. */

#ifndef SLOPE_SCATTERED_LATTICE_H
#define SLOPE_SCATTERED_LATTICE_H

#include "ball_sampler.h"
#include "plan_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace Slope {

class ScatteredLattice {
 public:
  static constexpr int FINER = 6;    // cells along a spacing

  enum State { UNKNOWN, BALL, NONE };
  struct Candidate {
    double x, y, z;
    uint64_t rank;     // of two that are near the lower one is a ball
    int64_t number;    // of the ball
    State state;
  };

  // As PlanNodes, of whose grid the spacing and the origin of the lattice are taken. Numbers of balls begin
  // with those of the cell before.
  ScatteredLattice(const NodeGrid &grid, const GroundHeights &surface, uint64_t seed,
                   int64_t before = 0);

  const double spacing, cell;
  int64_t first[2];    // cell of the corner of the plan
  int64_t n[2];        // spacings along x, y
  // the number of the next lattice's first cell
  int64_t end() const { return before + n[0] * n[1]; }

  int glance;    // cells between places at which a block is looked for a rim; 1: it is one of several zones
  bool kept(double x, double y) const { return !surface.keep || surface.keep(x, y); }

  // whether a ball may be in any of the cells, asked at each spacing
  bool any_place(int64_t ilo, int64_t ihi, int64_t jlo, int64_t jhi) const;

  // visit(candidate) of cells ilo to ihi, jlo to jhi, until it returns true
  template <typename Visit>
  bool any_of(int64_t ilo, int64_t ihi, int64_t jlo, int64_t jhi, Visit visit);

  // the same of those nearer to a place than a distance
  template <typename Visit> bool any_near(const Candidate &, double distance, Visit visit);

  void forget()
  {
    blocks.clear();
    known = 0;
  }
  size_t remembered() const { return known; }    // candidates

 private:
  static constexpr int BLOCK_BITS =
      4;    // 2^that cells along a block: its candidates are made together
  static constexpr int BLOCK = 1 << BLOCK_BITS;
  static constexpr int GLANCE = 4;

  const NodeGrid grid;
  const GroundHeights surface;
  const uint64_t seed;
  const int64_t before;

  struct Block {
    std::vector<Candidate> candidates;
    int first[BLOCK * BLOCK + 1];    // of each cell, row by row
  };
  std::unordered_map<int64_t, std::unique_ptr<Block>> blocks;
  size_t known = 0;

  struct Place {
    double x, y, z;
    uint64_t hash;
    bool on;
  };
  bool of_zones() const { return glance == 1; }
  static int64_t whole(double x) { return static_cast<int64_t>(std::floor(x)); }
  bool on_surface(double x, double y, double &z) const;
  Place place(int64_t i, int64_t j) const;
  void make(Block &, int64_t bi, int64_t bj) const;
  void add_between(Block &, const Place &, const Place &, uint64_t hash, int64_t number) const;
  void add_chord(Block &, const Place &, const Place &, uint64_t hash, int64_t number) const;
  void add_rim(Block &, const Place &on, const Place &off, uint64_t hash, int64_t number) const;
  Block &block(int64_t bi, int64_t bj);
};

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

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Fixed balls without a direction: irregular points of a surface, one for each spacing^2 of it.

   Of the candidates of a lattice each has a rank, a hash: it is a ball unless a ball of lower rank is nearer
   than NEAREST spacings in space. What a candidate is depends on few others around it, so that any tile can
   be asked for alone. Zones of another spacing have a lattice of their own; between candidates of two
   spacings the smaller one counts, so that at a seam no two balls are nearer, and no gap is larger, than in
   the zones. Derivation and measurements: doc/src/surface_sampling.rst. */

#ifndef SLOPE_SCATTERED_SAMPLER_H
#define SLOPE_SCATTERED_SAMPLER_H

#include "ball_sampler.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <unordered_map>
#include <vector>

namespace Slope {

// Where scattered balls of one spacing may be: points of the surface, one in each cell of a plan lattice that
// is finer than the spacing, where a hash of the cell puts it; where two neighbors differ in height, or the
// surface ends between them, more of them in between.
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

class ScatteredSampler : public BallSampler {
 public:
  // Spacing, over the distance of the centres at contact, up to which no ball passes: on level ground each
  // point is nearer than (NEAREST + sqrt(2) / FINER) spacings to a ball.
  static constexpr double WIDEST = 0.95;

  // As ScatteredLattice. The size of tiles, in spacings, is for tests.
  ScatteredSampler(const NodeGrid &grid, const GroundHeights &surface, uint64_t seed,
                   int tile = 32);

  // balls of another spacing, before any are made: no place may be kept by two surfaces
  void add(double spacing, const GroundHeights &surface);

  TilePlan tiles() const override { return plan; }
  void sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts) override;
  bool has_balls(int tile) override;
  void forget() override;

 private:
  typedef ScatteredLattice::Candidate Candidate;

  const NodeGrid grid;
  const uint64_t seed;
  const int side;    // of a tile, in cells of the first lattice
  std::deque<ScatteredLattice> lattices;
  TilePlan plan;

  struct Cells {
    int64_t ilo, ihi, jlo, jhi;
  };
  Cells cells_of(int tile, const ScatteredLattice &) const;
  template <typename Visit> bool any_near(const Candidate &, size_t lattice, Visit visit);
  void decide(Candidate &, size_t lattice);
};

}    // namespace Slope

#endif

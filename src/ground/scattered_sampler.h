// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Fixed balls without a direction: irregular points of a surface, one for each spacing^2 of it.

   Candidates are points of the surface, one in each cell of a plan lattice that is finer than the
   spacing, where a hash of the cell puts it; where two neighbors differ in height, or the surface ends
   between them, more of them in between. A hash is also a candidate's rank: it is a ball unless a
   ball of lower rank is nearer than NEAREST spacings in space. What a candidate is depends on few
   others around it, so that any tile can be asked for alone. Derivation and measurements:
   doc/src/surface_sampling.rst. */

#ifndef SLOPE_SCATTERED_SAMPLER_H
#define SLOPE_SCATTERED_SAMPLER_H

#include "ball_sampler.h"
#include "plan_nodes.h"

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace Slope {

class ScatteredSampler : public BallSampler {
 public:
  // Spacing, over the distance of the centres at contact, up to which no ball passes: on level ground each
  // point is nearer than (NEAREST + sqrt(2) / FINER) spacings to a ball.
  static constexpr double WIDEST = 0.95;

  // As PlanNodes, of whose grid the spacing and the origin of the lattice are taken. The size of tiles,
  // in spacings, is for tests.
  ScatteredSampler(const NodeGrid &grid, const Surface &surface, uint64_t seed, int tile = 32);

  TilePlan tiles() const override { return plan; }
  void sample(int tile, std::vector<PlacedBall> &balls, SurfaceCounts &counts) override;
  bool has_balls(int tile) override;
  void forget() override { blocks.clear(); }

 private:
  static constexpr int FINER = 6;    // cells of the lattice along a spacing
  static constexpr int BLOCK_BITS =
      4;    // 2^that cells along a block: its candidates are made together
  static constexpr int BLOCK = 1 << BLOCK_BITS;

  const NodeGrid grid;
  const Surface surface;
  const uint64_t seed;
  const int side;    // of a tile, in cells
  const double cell, near2;
  int64_t first[2];    // lattice cell of the corner of the plan
  int64_t across;      // spacings along x
  TilePlan plan;

  enum State { UNKNOWN, BALL, NONE };
  struct Candidate {
    double x, y, z;
    uint64_t rank;
    int64_t number;    // of the ball
    State state;
  };
  struct Block {
    std::vector<Candidate> candidates;
    int first[BLOCK * BLOCK + 1];    // of each cell, row by row
  };
  std::unordered_map<int64_t, std::unique_ptr<Block>> blocks;

  struct Place {
    double x, y, z;
    uint64_t hash;
    bool on;
  };
  bool on_surface(double x, double y, double &z) const;
  bool kept(double x, double y) const;
  Place place(int64_t i, int64_t j) const;
  void make(Block &, int64_t bi, int64_t bj) const;
  void add_between(Block &, const Place &, const Place &, uint64_t hash, int64_t number) const;
  void add_chord(Block &, const Place &, const Place &, uint64_t hash, int64_t number) const;
  void add_rim(Block &, const Place &on, const Place &off, uint64_t hash, int64_t number) const;

  Block &block(int64_t bi, int64_t bj);
  template <typename Visit>
  bool any_of(int64_t ilo, int64_t ihi, int64_t jlo, int64_t jhi, Visit visit);
  template <typename Visit> bool any_near(const Candidate &, Visit visit);
  void decide(Candidate &);
};

}    // namespace Slope

#endif

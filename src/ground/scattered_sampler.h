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
#include "scattered_lattice.h"

#include <cstdint>
#include <deque>
#include <vector>

namespace Slope {

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

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BALL_PLACEMENT_H
#define SLOPE_BALL_PLACEMENT_H

#include "pointers.h"

#include "ball_sampler.h"
#include "placement_arguments.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// The fixed balls that placement_arguments.h describes. Those on a surface are made tile by tile, by
// the rank that asks and only then; the regions must stay as they are as long as this does. Those of
// a file are one tile, read once, which every rank holds.
//
// The constructor checks the arguments, reports (rank 0), and writes the file that write asks for.
// Errors end the run on all ranks; messages start with caller.
class BallPlacement : protected Pointers {
 public:
  BallPlacement(class LAMMPS *, const std::string &caller, double diameter, double smallest,
                int narg, char **arg, bool of_wall = false);
  ~BallPlacement() override;

  // any rank alone: the tiles, and the balls of one of them, appended
  Slope::TilePlan tiles() const;
  void make(int tile, std::vector<Slope::PlacedBall> &balls);
  void forget();    // what was only needed to make them

  // all ranks, each makes its share
  bigint count();
  std::vector<Slope::PlacedBall> all();    // on all ranks, in order; once for a file

  // numbers that tell this ground from another one, also in another build: for restart files;
  // on all ranks: how it is not the ground of these numbers, empty if it is
  const std::vector<double> &fingerprint();
  std::string unlike(const std::vector<double> &fingerprint);

  // all ranks: the regions must be those of the constructor
  void check_regions() const;

  const class BallGround &on() const { return *ground; }    // what they lie on

  // diameter of the smallest ball that finds no way through, 0 if that is not known
  double smallest() const { return arguments.smallest; }

  // atom types of the zones; of a ball by its zone
  std::vector<int> zone_types() const;

  // diameter of the smallest ball of a group, 0 if it has none; all ranks
  static double smallest_ball(class LAMMPS *, int groupbit);

 private:
  const std::string caller;
  const PlacementArguments arguments;
  std::unique_ptr<BallGround> ground;
  std::unique_ptr<Slope::BallSampler> sampler;    // empty: a file, or no column at all
  std::vector<Slope::PlacedBall> from_file;
  double sums[3];               // of these
  bigint dropped;               // lines of the file
  bigint counted;               // balls, -1: unknown
  std::vector<double> marks;    // the fingerprint

  void place_file();
  void place_surface();
  void warn_of_spacing() const;
  bool any() const;
  template <typename Use>
  Slope::SurfaceCounts make_share(std::vector<Slope::PlacedBall> &, Use after_tile) const;
  Slope::SurfaceCounts
  count_all(std::vector<std::string> *text) const;    // text: lines, of nodes, extra
  void report(const Slope::SurfaceCounts &, bool known) const;
  void write_file(std::vector<std::string> &text, bigint n) const;
  void read_file();
  void find_sums();
  double spacing_around(double x, double y) const;
};

}    // namespace LAMMPS_NS

#endif

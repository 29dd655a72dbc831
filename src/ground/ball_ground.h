/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BALL_GROUND_H
#define SLOPE_BALL_GROUND_H

#include "pointers.h"

#include "ball_sampler.h"
#include "placement_arguments.h"
#include "region_surface.h"

#include <memory>
#include <string>
#include <vector>

namespace Slope {
class SunkSurface;
}

namespace LAMMPS_NS {

// The boundary of a region sunk along its normal, doc/src/surface_sampling.rst. The lower boundary is
// that of a body: it continues beyond the body's rim, up to the ground, which is the region whose upper
// boundary is that of the body, too, the widest of these in plan.
class SunkRegion : protected Pointers {
 public:
  // diameter: of the balls, which tells how closely the boundary is looked at. All ranks; errors end
  // the run and start with caller.
  SunkRegion(class LAMMPS *, const std::string &caller, const std::string &region, int side,
             double sink, double diameter);
  ~SunkRegion() override;

  const std::string region;
  const int side;
  const double sink, diameter;
  std::string ground;    // ID, empty: none

  // Look at the boundary, once; may throw. Needs the region; the others need this.
  void build();
  void plan(double &xlo, double &xhi, double &ylo, double &yhi) const;    // of height()
  bool height(double x, double y, double &z) const;    // of ball centres, below the ground only
  bool centre(double x, double y, double &z) const;    // of a body: above it, too

  double lowest() const;    // of the centres, about
  double floor() const;     // what they must lie above

  // whether the regions are those of the constructor; if not, which one is not
  bool stands(std::string &changed) const;

  // whether all of the body lies in columns of another region
  bool lies_in(const RegionSurface &columns) const;

 private:
  std::unique_ptr<RegionSurface> boundary, top;    // top: of the ground
  std::unique_ptr<Slope::SunkSurface> surface;
  std::vector<double> columns;    // x y of some of the body's columns
  bool flush;                     // all of them end at the ground

  void find_columns();
  void find_ground(const std::string &caller);
};

// What placement_arguments.h says of each column of the ground: the region whose boundary it is, sunk
// or not, where balls are wanted, the bodies of sunk balls outside of which they are, the zones.
class BallGround : protected Pointers {
 public:
  BallGround(class LAMMPS *, const PlacementArguments &);    // all ranks
  ~BallGround() override;

  typedef std::shared_ptr<SunkRegion> Sunk;
  Sunk sunk;                   // below which the balls are, nullptr: not sunk
  std::vector<Sunk> bodies;    // sunk ones outside of which the balls are
  std::string outside;         // region, empty if the arguments say how it is sunk

  // All ranks: find the sunk surfaces. false if the plan is empty. May throw.
  bool build();

  // which balls there are; any rank alone. sample(): those of a tile, appended
  std::unique_ptr<Slope::BallSampler> new_sampler() const;
  void sample(Slope::BallSampler &, int tile, std::vector<Slope::PlacedBall> &,
              Slope::SurfaceCounts &) const;

  // columns of ball centres; any rank alone
  bool keep(double x, double y) const;
  int zone(double x, double y) const;    // from 1, 0: in none

  // The plan grid, and for marks the surface as it sees it, an upper boundary before it is sunk: where the grid
  // is turned, in coordinates that turn with it
  Slope::NodeGrid grid() const;
  Slope::GroundHeights looked_at() const;

  // spacings of the balls, first that of what is in no zone
  std::vector<double> spacings() const;
  double spacing(double x, double y) const;

  // whether the regions are those of the constructor; if not, which one is not
  bool stands(std::string &changed) const;

 private:
  const PlacementArguments &arguments;
  // within: of what they are inside of, columns: of what they are outside of
  std::unique_ptr<RegionSurface> boundary, within, columns;
  struct Zone {
    std::unique_ptr<RegionSurface> columns;
    double xlo, xhi, ylo, yhi;
  };
  std::vector<Zone> zones;
  const double cosine, sine;    // of the angle of the grid
  Slope::NodeGrid plan;

  void find_bodies();
  void turn(double &x, double &y, double direction = 1.0) const;    // -1: to those of the grid
  Slope::GroundHeights surface() const;
  Slope::GroundHeights surface_of(double spacing) const;    // where it is this one
  bool height(double x, double y, double &z) const;
  bool scar(double x, double y, double &z) const;
  void check_floor() const;
};

// What has balls on a ground, and shows it to those that are placed later: a fix, whose header includes this one.
class OnBallGround {
 public:
  virtual const BallGround &ground() const = 0;

 protected:
  ~OnBallGround() = default;
};

}    // namespace LAMMPS_NS

#endif

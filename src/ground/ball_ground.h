/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BALL_GROUND_H
#define SLOPE_BALL_GROUND_H

#include "pointers.h"

#include "placement_arguments.h"
#include "plan_nodes.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// What placement_arguments.h says of each column of the ground: the region whose boundary it is, sunk
// or not, the filter, the bodies of sunk balls that the filter leaves out.
class BallGround : protected Pointers {
 public:
  BallGround(class LAMMPS *, const PlacementArguments &);    // all ranks
  ~BallGround() override;

  typedef std::shared_ptr<class SunkRegion> Sunk;
  Sunk sunk;                   // below which the balls are, nullptr: not sunk
  std::vector<Sunk> bodies;    // sunk ones that the filter leaves out
  std::string outside;         // region, empty if the arguments say how it is sunk

  // All ranks: find the sunk surfaces. false if the plan is empty. May throw.
  bool build();

  // The plan grid and the surface as it sees it: where the grid is turned, in coordinates that turn with it,
  // to be turned back.
  Slope::NodeGrid grid() const;
  void turn(double &x, double &y, double direction = 1.0) const;    // -1: to those of the grid

  // columns of ball centres; any rank alone
  bool keep(double x, double y) const;
  Slope::Surface surface() const;

  // whether the regions are those of the constructor; if not, which one is not
  bool stands(std::string &changed) const;

 private:
  const PlacementArguments &arguments;
  std::unique_ptr<class RegionSurface> boundary, columns;    // columns: of the filter
  const double cosine, sine;                                 // of the angle of the grid
  Slope::NodeGrid plan;

  void find_bodies();
  bool height(double x, double y, double &z) const;
  bool of_rim() const;
  bool scar(double x, double y, double &z) const;
  void check_floor() const;
};

}    // namespace LAMMPS_NS

#endif

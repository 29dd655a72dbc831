/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BALL_BODY_H
#define SLOPE_BALL_BODY_H

#include <memory>
#include <string>

namespace LAMMPS_NS {

// What fixed balls tell those that are placed later of the bodies above them; both are fixes of one class, whose header
// includes the placement.
class BallBody {
 public:
  // the body that the balls lie sunk below, nullptr if they do not
  virtual std::shared_ptr<class SunkRegion> body() const = 0;

  // the region outside of which the balls are, without knowing whether it is sunk; or empty
  virtual const std::string &left_out() const = 0;

 protected:
  ~BallBody() = default;
};

}    // namespace LAMMPS_NS

#endif

/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(create_balls,CreateBalls);
// clang-format on
#else

#ifndef LMP_CREATE_BALLS_H
#define LMP_CREATE_BALLS_H

#include "command.h"

#include <vector>

namespace LAMMPS_NS {

class CreateBalls : public Command {
 public:
  explicit CreateBalls(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;

 private:
  void check_box() const;
  bigint place(double diameter, int narg, char **arg, std::vector<double> &xyz) const;
  bigint fill(double diameter, int narg, char **arg, std::vector<double> &xyz) const;
  void bounds(const class Region *, double lo[3], double hi[3]) const;
  void half_a_ball(double diameter, double share[3]) const;
  void into_box(std::vector<double> &) const;
  bool mine(const double *) const;
};

}    // namespace LAMMPS_NS

#endif
#endif

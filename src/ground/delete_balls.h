/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(delete_balls,DeleteBalls);
// clang-format on
#else

#ifndef LMP_DELETE_BALLS_H
#define LMP_DELETE_BALLS_H

#include "command.h"

namespace LAMMPS_NS {

class DeleteBalls : public Command {
 public:
  explicit DeleteBalls(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;
};

}    // namespace LAMMPS_NS

#endif
#endif

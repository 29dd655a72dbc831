/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_BALL_PLACEMENT_H
#define SLOPE_BALL_PLACEMENT_H

#include "pointers.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Where the fixed balls go, from the arguments that fix wall/gran/balls and create_balls share:
//
//   surface REGION upper|lower spacing S [inside REGION | outside REGION] [origin x y]
//   file FILE [inside REGION | outside REGION]
//   write FILE     in addition, if may_write
//
// The constructor does it all: reads the arguments, places the balls, reports how many (rank 0)
// and writes the file. Errors end the run on all ranks; messages start with caller.
class BallPlacement : protected Pointers {
 public:
  BallPlacement(class LAMMPS *, const std::string &caller, double diameter, int narg, char **arg,
                bool may_write = false);
  ~BallPlacement() override;

  std::vector<double> xyz;    // x,y,z of each ball, the same on all ranks

 private:
  std::string caller;
  double diameter;

  // arguments

  std::string region, file, write;    // region or file is empty
  int side;
  double spacing, origin[2];
  std::string filter;
  bool filter_inside;

  std::unique_ptr<class RegionSurface> surface, columns;    // columns: of the filter
  std::string summary;                                      // rank 0

  void parse(int, char **, bool);
  bool keep(double x, double y) const;
  void place_on_surface();
  void read_file();
  void write_file();
  void share();
};

}    // namespace LAMMPS_NS

#endif

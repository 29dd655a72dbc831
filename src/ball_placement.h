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
//   surface REGION upper|lower spacing S [inside REGION | outside REGION [sunk H]] [origin x y]
//     [sink H] [smallest D]
//   file FILE [inside REGION | outside REGION]
//   write FILE     in addition, if may_write
//
// The constructor does it all: reads the arguments, places the balls, reports how many (rank 0)
// and writes the file. Errors end the run on all ranks; messages start with caller.
// smallest: diameter of the smallest moving ball, the fixed balls' own where it is not known or larger.
class BallPlacement : protected Pointers {
 public:
  BallPlacement(class LAMMPS *, const std::string &caller, double diameter, double smallest,
                int narg, char **arg, bool may_write = false);
  ~BallPlacement() override;

  std::vector<double> xyz;    // x,y,z of each ball, the same on all ranks

  // what others need to know of a placement: the body that these balls lie below, nullptr if they are
  // not sunk; the region outside of which they are, empty if sunk says that it is sunk; the diameter
  // of the smallest ball that finds no way through, 0 if that is not known
  typedef std::shared_ptr<class SunkRegion> Sunk;
  Sunk sunk;
  std::string outside;
  double smallest;

  // diameter of the smallest ball of a group, 0 if it has none; all ranks
  static double smallest_ball(class LAMMPS *, int groupbit);

 private:
  std::string caller;
  double diameter;

  // arguments

  std::string region, file, write;    // region or file is empty
  int side;
  double spacing, origin[2];
  std::string filter;
  bool filter_inside;
  double sink, filter_sink;    // < 0: the sink of the fix that has sunk the filter's region

  std::unique_ptr<class RegionSurface> surface, columns;    // columns: of the filter
  std::vector<Sunk> bodies;                                 // sunk ones that the filter leaves out
  std::string summary;                                      // rank 0

  void need(int n, const char *values, int, char **) const;
  double number(const char *what, int, char **) const;
  void parse(int, char **, bool);
  int parse_surface(int, char **);
  int parse_any(int, char **, bool);
  void check_sink(double, char **) const;

  void find_bodies();
  bool height(double x, double y, double &z) const;
  bool keep(double x, double y) const;
  bool scar(double x, double y, double &z) const;
  void check_floor() const;
  void place_on_surface();
  void read_file();
  void write_file();
  void share();
};

}    // namespace LAMMPS_NS

#endif

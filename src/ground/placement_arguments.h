/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_PLACEMENT_ARGUMENTS_H
#define SLOPE_PLACEMENT_ARGUMENTS_H

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// The arguments that say where fixed balls go, which fix wall/gran/balls and create_balls share:
//
//   surface REGION upper|lower spacing S [inside REGION] [outside REGION [sunk H]] [origin x y]
//     [sink H] [smallest D] [pattern grid | pattern scattered [SEED]] [angle DEG]
//   file FILE [inside REGION] [outside REGION]
//   write FILE, zone REGION TYPE [S] ...     in addition, of a wall
//
// Errors end the run on all ranks; messages start with caller.
class PlacementArguments : protected Pointers {
 public:
  PlacementArguments(class LAMMPS *, const std::string &caller, double diameter, double smallest,
                     int narg, char **arg, bool of_wall);

  const std::string caller;
  const double diameter;

  std::string region, file, write;    // region or file is empty
  int side;                           // of RegionSurface
  double spacing, origin[2];
  bool scattered;
  int seed;                       // of the scattered pattern
  double angle;                   // of the plan grid, counterclockwise, radians
  std::string inside, outside;    // regions, or empty
  double sink,
      outside_sink;    // < 0: the sink of the fix that has sunk the region outside of which they are

  // parts of the ground with a type, and perhaps a spacing, of their own: the last one counts where they overlap
  struct Zone {
    std::string region;
    int type;
    double spacing;    // of all, if it is not the zone's own
  };
  std::vector<Zone> zones;

  // diameter of the smallest moving ball, at most that of the fixed ones; 0: unknown (file)
  double smallest;

 private:
  void parse(int, char **, bool);
  bool parse_surface(class KeywordReader &);
  bool parse_filter(KeywordReader &);
  bool parse_of_wall(KeywordReader &);
  void check_zones();
  void check_pattern() const;
};

}    // namespace LAMMPS_NS

#endif

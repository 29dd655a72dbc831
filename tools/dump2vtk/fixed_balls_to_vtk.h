/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_FIXED_BALLS_TO_VTK_H
#define SLOPE_FIXED_BALLS_TO_VTK_H

#include <string>

namespace Slope {
class OutputFiles;
class Progress;
struct Options;

// The fixed balls of all files as OUT.balls.vtp. A line on them is added to the report.
void fixed_balls_to_vtk(const Options &options, OutputFiles &output, Progress &progress,
                        std::string &report);

}    // namespace Slope

#endif

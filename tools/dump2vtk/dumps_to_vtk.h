/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DUMPS_TO_VTK_H
#define SLOPE_DUMPS_TO_VTK_H

#include <string>

namespace Slope {
class OutputFiles;
class Progress;
struct Options;

// Each snapshot of the dumps as OUT/OUT_STEP.vtp, and OUT.pvd, which lists them with their times.
// A line on them is added to the report.
void dumps_to_vtk(const Options &options, OutputFiles &output, Progress &progress,
                  std::string &report);

}    // namespace Slope

#endif

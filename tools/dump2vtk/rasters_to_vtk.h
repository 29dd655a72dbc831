/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_RASTERS_TO_VTK_H
#define SLOPE_RASTERS_TO_VTK_H

#include <string>

namespace Slope {
class OutputFiles;
class Progress;
struct Options;

// The terrain as OUT.terrain.vts, and each raster, laid on the ground, as OUT.NAME.vts. A line on
// each file is added to the report.
void rasters_to_vtk(const Options &options, OutputFiles &output, Progress &progress,
                    std::string &report);

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SNAPSHOT_TO_VTK_H
#define SLOPE_SNAPSHOT_TO_VTK_H

#include <string>

namespace Slope {
class LineReader;
struct Options;
struct Snapshot;

// The balls of one snapshot as the file path (.vtp), with the dump's columns as point arrays; file
// is where the snapshot was read, for messages
void snapshot_to_vtk(const Snapshot &snapshot, const LineReader &file, const Options &options,
                     double time, const std::string &path);

}    // namespace Slope

#endif

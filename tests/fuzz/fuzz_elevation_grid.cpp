/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Any file is an ESRI ASCII grid, which then comes back from its own file bit by bit, or an error
// of one line

#include "atomic_file.h"
#include "elevation_grid.h"
#include "fuzz_file.h"

#include <cmath>

using Slope::AtomicFile;
using Slope::ElevationGrid;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static FuzzFile file;
  static const std::string copy = "/dev/shm/fuzz_elevation_grid." + std::to_string(getpid());
  const std::string &path = file.of(data, size);
  try {
    const ElevationGrid grid = ElevationGrid::read(path);
    must(grid.nx >= 1 && grid.ny >= 1 && grid.z.size() == (size_t) grid.nx * grid.ny, "size");
    must(grid.zmin() <= grid.zmax() && grid.count_nodata() < grid.nx * grid.ny, "a height");
    for (const double f : {-0.1, 0.0, 0.3, 0.5, 1.0, 1.1}) {
      const double x = grid.xlo + f * grid.cell * grid.nx, y = grid.ylo + f * grid.cell * grid.ny;
      grid.height(x, y);
      if (grid.z.size() < 1000) grid.nodata_within(x, y, f * grid.cell);
    }
    grid.height(NAN, INFINITY);
    grid.nodata_within(1e300, -1e300, grid.cell);

    // a height of -9999 in a file with another NODATA value has no way back
    for (const double height : grid.z)
      if (height == -9999.0) return 0;
    AtomicFile written(copy);
    grid.write(written, 17);
    written.commit();
    const ElevationGrid again = ElevationGrid::read(copy);
    unlink(copy.c_str());
    must(again.nx == grid.nx && again.ny == grid.ny && again.xlo == grid.xlo &&
             again.ylo == grid.ylo && again.cell == grid.cell, "the header comes back");
    for (size_t k = 0; k < grid.z.size(); k++)
      must(again.z[k] == grid.z[k] || (std::isnan(again.z[k]) && std::isnan(grid.z[k])),
           "the heights come back");
  } catch (std::runtime_error &e) {
    must_be_one_line(e, path);
  }
  return 0;
}

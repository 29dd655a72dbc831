// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_STL_FILE_H
#define SLOPE_STL_FILE_H

#include "triangle.h"

#include <string>
#include <vector>

namespace Slope {

// The triangles of an STL file, text or binary. Normals and attributes in the file are not used.
//
// What the file is: binary where its length is that of the number of triangles after the header, 84 +
// 50 n bytes (binary files may begin with "solid"); text where it begins with "solid" otherwise. A
// text file may hold several solids.
//
// Errors are std::runtime_error with one line: file, line or triangle in it, rule, value. They are: a
// file that is cut short, text that is no STL, an elevation grid, a coordinate that is not finite, no
// triangle with an area.
struct StlFile {
  std::vector<Triangle> triangles;    // those that have an area
  int skipped;                        // those without: two corners, or all three on a line
  double surplus;    // bytes after the last triangle of a binary file, which are not read
  double
      rounding;    // half a last digit of a binary file's largest coordinate, times scale; text: 0

  // coordinates times scale, then moved
  static StlFile read(const std::string &path, double scale = 1.0,
                      const Vector &move = {0.0, 0.0, 0.0});
};

}    // namespace Slope

#endif

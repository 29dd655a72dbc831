// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_ELEVATION_GRID_H
#define SLOPE_ELEVATION_GRID_H

#include "constants.h"

#include <cstddef>
#include <string>
#include <vector>

namespace Slope {

class AtomicFile;

// A raster of square cells with one value at each cell's centre: heights of the ground (m), or
// any other quantity. The only C++ code that reads and writes the ESRI ASCII grid format.
//
// Rows run from south to north and columns from west to east, so that cell (i,j) covers
// x = xlo + i*cell ... xlo + (i+1)*cell and y likewise. The file has its rows from north to south.
// NODATA is NaN in memory.
//
// Errors are std::runtime_error with one line: file, line in it, rule, value.
class ElevationGrid {
 public:
  static constexpr double MAXCELLS = MOST_COUNTED;

  ElevationGrid() : nx(0), ny(0), xlo(0.0), ylo(0.0), cell(1.0), elsewhere(nullptr) {}

  // nx by ny cells of one value; the memory is allocated here (std::bad_alloc)
  ElevationGrid(int nx, int ny, double xlo, double ylo, double cell, double value);

  // Read an ESRI ASCII grid. Header keys in any order, upper or lower case: ncols, nrows,
  // xllcorner or xllcenter, yllcorner or yllcenter, cellsize, and NODATA_value (default -9999).
  static ElevationGrid read(const std::string &path);

  // Write an ESRI ASCII grid: xllcorner form, NODATA -9999, values with so many significant
  // digits (17 keep every bit). The file appears under its name only when it is complete; an
  // error leaves nothing behind.
  void write(AtomicFile &, int digits = 9) const;    // which the caller commits

  // the text of such a file in parts, for callers that keep the rows elsewhere: header, then the rows
  // from north to south, each appended to the text
  static std::string header(int nx, int ny, double xlo, double ylo, double cell);
  static void append_row(std::string &text, const double *row, int nx, int digits);

  // Height at a point, bilinear between the four cell centres around it; in the half cell along
  // the raster's edge the surface is extrapolated, so that a plane is exact up to the edge. NaN outside
  // of the raster, and where a centre that has a weight is NODATA.
  double height(double x, double y) const;

  // whether height() is NaN anywhere inside the raster and nearer than r to the point
  bool nodata_within(double x, double y, double r) const;

  double xhi() const { return xlo + nx * cell; }
  double yhi() const { return ylo + ny * cell; }
  double zmin() const;    // of the cells that have a value; NaN if there are none
  double zmax() const;
  int count_nodata() const;

  double &at(int i, int j) { return z[(size_t) j * nx + i]; }
  double at(int i, int j) const { return values()[(size_t) j * nx + i]; }

  // use nx * ny values of the caller, which must exist as long as this grid and its
  // copies: for reading only
  void refer_to(const double *values);
  const double *values() const { return elsewhere ? elsewhere : z.data(); }

  int nx, ny;               // columns, rows
  double xlo, ylo, cell;    // south-west corner of the raster, size of a cell
  std::vector<double> z;    // own values, row by row from the south; public for sending

 private:
  const double *elsewhere;
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SURFACE_LOADS_H
#define SLOPE_SURFACE_LOADS_H

#include "touched_surface.h"

#include <map>
#include <string>
#include <vector>

namespace Slope {

// What balls did to a surface: as a whole against time, and to each of its triangles. Of a contact on an
// edge or a corner one of the triangles there has all.
class SurfaceLoads {
 public:
  // of one step, on one triangle, of one rank's balls; numbers only, so that ranks can send them.
  // Steps are counted such that no number comes again.
  struct Record {
    double step, triangle;
    double force, impulse;    // along the normal of the contact, N, N s
  };
  static constexpr int NUMBERS = sizeof(Record) / sizeof(double);

  struct Row {
    double step, time;
    double force[3], moment[3], impulse[3], contacts;
    double largest[2];    // sizes of force and moment, in any step since the row before
  };

  // of all ranks, whole steps, in any order; is sorted
  void take(std::vector<Record> &records);

  void add_row(const Row &row) { rows.push_back(row); }

  // text of the files; the last pressure is that of a step
  std::string series(const Row *end = nullptr) const;    // CSV; end: a row more
  std::string triangles(const TouchedSurface &surface, double step) const;    // CSV, loaded ones
  std::string polydata(const TouchedSurface &surface, double step) const;    // VTK XML; loaded ones
                                                                             // of a sparse surface
  // for restart files
  std::vector<double> pack() const;
  void unpack(const double *numbers, size_t size,
              double triangles);    // may throw: of a damaged file

 private:
  struct Load {
    double step, last;    // force in this step, the last one with a contact
    double largest, impulse;
  };
  struct Values {
    double last, largest, impulse, area;    // Pa, Pa, N s/m2, m2
  };

  std::map<int, Load> loads;    // by triangle
  std::vector<Row> rows;

  static Values values_of(const Load &load, const Triangle &triangle, double step);
};

}    // namespace Slope

#endif

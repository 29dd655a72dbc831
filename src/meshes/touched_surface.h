// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A surface of triangles that balls can touch, from both sides. No LAMMPS. */

#ifndef SLOPE_TOUCHED_SURFACE_H
#define SLOPE_TOUCHED_SURFACE_H

#include "triangle.h"

#include <vector>

namespace Slope {

class TouchedSurface {
 public:
  virtual ~TouchedSurface() = default;

  // adds the numbers of all triangles whose boxes come closer to x than reach (m), perhaps some more
  virtual void find_near(const Vector &x, double reach, std::vector<int> &numbers) const = 0;

  virtual Triangle triangle(int number) const = 0;
  virtual int count() const = 0;            // triangles; numbers are below it
  virtual bool sparse() const = 0;          // too many to be written all
  virtual const Vector &low() const = 0;    // corners of a box around it, m
  virtual const Vector &high() const = 0;
  virtual bool closed() const { return false; }                    // has an inside; takes time
  virtual bool encloses(const Vector &) const { return false; }    // of a closed one: x is inside
  virtual double checksum() const = 0;        // another surface has another one
  virtual double memory_usage() const = 0;    // bytes

  double rounding = 0.0;    // by how much its file may have rounded coordinates, m
  double lower = 0.0;       // it lies so much lower than what it stands for
};

// A contact of a ball with a surface
struct SurfaceContact {
  SurfacePoint at;
  double overlap;    // that gives its force, m
  double spring;     // compression of its spring in the energy, m
  bool joined;       // of several points of one surface
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_MOTION_RECORD_H
#define SLOPE_MOTION_RECORD_H

#include <string>
#include <vector>

namespace Slope {

// Acceleration of the ground against time: linear between points, zero before the first and after
// the last; two points of the same time are a jump. Velocity and displacement are its integrals
// from rest, exact for that curve (to rounding), whatever the times that are asked for.
class MotionRecord {
 public:
  struct Point {
    double t, a[3];    // s, m/s2
  };

  MotionRecord() : scale(1.0) {}

  // points that read() would take, without any check; scale: factor on all accelerations
  MotionRecord(const std::vector<Point> &points, double scale);

  // Read lines "t ax ay az", # starts a comment. Times must not fall, at most two may be equal, and there must
  // be at least two points. si: a head must have s and m/s2 (number_rows.h). Errors are std::runtime_error with
  // one line: file, line in it, rule, value.
  static MotionRecord read(const std::string &path, double scale, bool si = true);

  // At a time t of the record (s). At a jump the acceleration is the one after it.
  void acceleration(double t, double *a) const;    // m/s2
  void velocity(double t, double *v) const;        // m/s
  void displacement(double t, double *d) const;    // m

  double peak() const;    // largest size of the acceleration, m/s2
  double begin() const { return points.front().t; }
  double end() const { return points.back().t; }

  // of points and scale, to tell one record from another
  double checksum() const;

  const std::vector<Point> &list() const { return points; }    // as read, without the scale

 private:
  std::vector<Point> points;
  std::vector<Point> v, d;    // integrals at the points; their a is velocity, displacement
  double scale;

  // last point that is not after t, and the share of the interval to the next one that has passed;
  // -1 before the first point; share 0 after the last
  int find(double t, double &passed, double &share) const;
};

}    // namespace Slope

#endif

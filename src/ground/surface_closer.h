// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Balls that close a surface between the nodes of a plan grid, where it is so steep, or ends, that
   a ball of the same size could pass. The rule and its derivation: doc/src/surface_sampling.rst.
   No LAMMPS. */

#ifndef SLOPE_SURFACE_CLOSER_H
#define SLOPE_SURFACE_CLOSER_H

#include "plan_nodes.h"

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace Slope {

// every point of the surface lies within this distance of a ball centre (and within that plus
// sampling_slack, since the surface is looked at in samples)
double cover_radius(double spacing, double radius);
double sampling_slack(double radius);

// from which on that is two radii or more, so that a ball may pass where the ground is steep
double widest_spacing(double radius);

class SurfaceCloser {
 public:
  struct Point {
    double x, y, z;
  };

  SurfaceCloser(PlanNodes &nodes, double radius);

  // cells from -1 on that may need balls: within ilo <= i < ihi, jlo <= j < jhi
  const int ilo, ihi, jlo, jhi;
  bool in_range(int i, int j) const { return i >= ilo && i < ihi && j >= jlo && j < jhi; }

  // balls of one cell decide on those of others that are at most so many cells away
  const int reach;

  // by its corners alone a cell is done, or is to be looked at, or the kept surface ends in it
  enum Kind { DONE, STEEP, RIM };
  Kind kind(int i, int j) const;

  // whether the nodes alone leave a way through a steep cell
  bool leaks(int i, int j);

  // columns of a cell on a finer grid, n + 1 in a row: heights of the kept surface, NaN without
  struct Columns {
    int n;
    std::vector<double> z;
    bool on(size_t k) const { return z[k] == z[k]; }
  };
  Columns columns_of(int i, int j) const;

  // cells in range next to this one into which the rim continues
  std::vector<int64_t> rim_goes_on(int i, int j, const Columns &) const;

  // add what these need beyond the nodes and the balls added since start()
  void start();
  void close(int i, int j);                      // a steep cell
  void refine(int i, int j, const Columns &);    // one in which the kept surface ends

  // the balls that a cell has asked for, in their order; once
  std::vector<Point> take(int64_t cell) { return std::move(added[cell]); }

 private:
  PlanNodes &nodes;
  const double radius, cover2, pitch;
  // balls added by the cell that asked for them, and by the one that they lie in
  std::unordered_map<int64_t, std::vector<Point>> added, lying;
  std::vector<Point> samples;
  int64_t here;            // cell that asks
  bool look_only, leak;    // whether a sample is not covered, instead of adding balls

  struct Rim {
    Point p;         // last point of the kept surface
    bool scarp;      // it falls (or rises) here,
    Point foot;      // to this point
    bool leaving;    // walking round the cell, the kept surface ends here (else it begins)
  };

  Point node_point(int i, int j) const { return {nodes.x(i), nodes.y(j), nodes.at(i, j).z}; }
  Point column(int i, int j, int n, size_t k) const;
  bool column_height(int i, int j, double x, double y, double &z) const;
  bool column_on(int i, int j, double x, double y, double &z) const;
  Rim find_rim(int i, int j, const Point &on, const Point &off, bool leaving) const;
  void sample_patch(int i, int j);
  void sample_scarp(const std::vector<Rim> &rims);
  void sample(const Point &, const Point &, const Point &, const Point &);
  std::vector<Point> balls_near(const Point &lo, const Point &hi) const;
  void cover_samples();
  void add(const Point &ball);
  int clamped(double index, int n) const;
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_BODY_H
#define SLOPE_SLIP_BODY_H

#include "elevation_grid.h"
#include "slip_columns.h"
#include "slip_factor.h"
#include "slip_soil.h"

#include <string>
#include <vector>

namespace Slope {

// A surface and what was computed of the body above it.
struct SlipBody {
  SlipSurface surface;
  double factor, yield;
  double volume, area, depth;    // area in plan, greatest depth
};

// How bodies below one terrain are computed.
struct SlipTask {
  SlipFactor::Method method = SlipFactor::BISHOP;
  SlipFactor::Seismic seismic = {0.0, 0.0};
  bool any_direction =
      true;    // of sliding: where the weight's moment is largest, or the surface's own
  double direction = 0.0;    // otherwise, radians
};

class SlipBodyMaker {
 public:
  // all of them must outlive this
  SlipBodyMaker(const ElevationGrid &ground, const SlipSoil &soil, const std::vector<char> &allowed,
                const SlipTask &task);

  // With exact columns; empty, or why there is no such body, in words. Without the yield coefficient.
  std::string exact(const SlipSurface &, SlipBody &, int lines = 96);

  // with a column in the middle of each stride-th cell; false if there is no such body
  bool coarse(const SlipSurface &, int stride, SlipBody &, double precision);

  // of the last body
  double yield() const { return factor.yield(task.seismic.vertical); }
  double of_moments(double precision) const { return factor.of_moments(task.seismic, precision); }
  double share_bounded() const { return factor.share_bounded(); }
  double share_pulled() const { return factor.share_pulled(); }
  const SlipColumns &columns() const { return found; }

  const std::vector<char> &allowed;    // cells, or empty for all of them

  // heights of the surface in the cells whose middle is in the body; no value elsewhere
  ElevationGrid base(const SlipSurface &);

 private:
  const ElevationGrid &ground;
  const SlipTask &task;
  SlipColumnMaker maker;
  SlipColumns found;
  SlipFactor factor;

  SlipSurface directed(const SlipSurface &) const;
  void fill(const SlipSurface &, SlipBody &, double precision);
};

// The files of bodies, all of them or none: PREFIX.slips.csv, PREFIX.factor.asc, PREFIX.N.base.asc,
// PREFIX.N.columns.csv.
// Errors are std::runtime_error with one line.
class SlipWriter {
 public:
  static void probe(const std::string &prefix, int bodies);    // whether they could be written

  // least: factor of the surfaces through each cell, to which those of the bodies are added
  static void write(const std::string &prefix, ElevationGrid least, const std::vector<SlipBody> &,
                    SlipBodyMaker &);

  static std::string table(const std::vector<SlipBody> &);

 private:
  static void columns(AtomicFile &, const SlipSurface &, const SlipColumns &);
};

}    // namespace Slope

#endif

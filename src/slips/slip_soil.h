// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SLIP_SOIL_H
#define SLOPE_SLIP_SOIL_H

#include "constants.h"
#include "elevation_grid.h"

#include <cmath>
#include <string>
#include <vector>

namespace Slope {

// Strength, weight and water of the ground below a raster, and the bedrock that no surface cuts, in SI
// units.
class SlipSoil {
 public:
  static constexpr double WATER = 1000.0;    // kg/m3

  struct Strength {
    double cohesion, friction, density;    // Pa, tangent of the friction angle, kg/m3
  };

  // of a column from the base to the ground, per area in plan
  struct State {
    double weight;      // Pa
    double height;      // of the centre of gravity, m
    double cohesion;    // at the base, Pa
    double friction;    // at the base, tangent
    double pore;        // water pressure at the base, Pa
  };

  explicit SlipSoil(const Strength &top) :
      strengths(1, top), ru(0.0), has_table(false), rocky(false)
  {
  }

  // Below this raster, and below the layers before, another strength begins. Where the raster has
  // no value, the layer is not there.
  void add_layer(const ElevationGrid &top, const Strength &);

  // One of them: pore pressure = ratio x vertical stress at the base; or hydrostatic below a
  // raster, and 0 where that has no value.
  void set_ratio(double ratio) { ru = ratio; }
  void set_table(const ElevationGrid &heights);

  // The base of a body is nowhere below this raster; where that has no value there is no bedrock.
  void set_bedrock(const ElevationGrid &heights);
  bool has_bedrock() const { return rocky; }
  ElevationGrid bedrock_below(const ElevationGrid &ground) const;    // in the centres of its cells

  // What contradicts itself somewhere below the ground, in one line with item, rule, value and
  // place: a layer above the one over it, a water table above the ground, or a bedrock that is nowhere below
  // it; empty if nothing.
  std::string contradiction(const ElevationGrid &ground) const;

  // base below the ground
  State state(double x, double y, double base, double ground) const
  {
    const Strength *at = strengths.data();
    double top = ground, moment = 0.0;    // of the weight, about height 0
    State s = {0.0, 0.0, 0.0, 0.0, 0.0};
    const auto add = [&](double bottom) {
      const double weight = GRAVITY * at->density * (top - bottom);
      s.weight += weight;
      moment += weight * 0.5 * (top + bottom);
      top = bottom;
    };
    for (size_t k = 0; k < layers.size(); k++) {
      const double begins = layers[k].height(x, y);
      if (!std::isfinite(begins)) continue;
      if (begins <= base || (rocky && begins <= bedrock.height(x, y))) break;    // not in the rock
      add(std::fmin(begins, top));
      at = &strengths[k + 1];
    }
    add(base);
    s.height = s.weight > 0.0 ? moment / s.weight : base;
    s.cohesion = at->cohesion;
    s.friction = at->friction;
    s.pore = ru * s.weight;
    if (has_table) {
      const double level = table.height(x, y);
      if (level > base) s.pore += GRAVITY * WATER * (level - base);
    }
    return s;
  }

 private:
  std::vector<Strength> strengths;      // from the top
  std::vector<ElevationGrid> layers;    // where the next one begins
  double ru;
  bool has_table, rocky;
  ElevationGrid table, bedrock;
};

}    // namespace Slope

#endif

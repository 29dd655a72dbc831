// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_soil.h"

#include <cstdio>

using namespace Slope;

static constexpr double ROUNDING = 1.0e-6;    // m: heights in files have so many digits

/* ---------------------------------------------------------------------- */

void SlipSoil::add_layer(const ElevationGrid &top, const Strength &strength)
{
  layers.push_back(top);
  strengths.push_back(strength);
}

/* ---------------------------------------------------------------------- */

void SlipSoil::set_table(const ElevationGrid &heights)
{
  table = heights;
  has_table = true;
}

/* ---------------------------------------------------------------------- */

void SlipSoil::set_bedrock(const ElevationGrid &heights)
{
  bedrock = heights;
  rocky = true;
}

ElevationGrid SlipSoil::bedrock_below(const ElevationGrid &ground) const
{
  ElevationGrid below(ground.nx, ground.ny, ground.xlo, ground.ylo, ground.cell, 0.0);
  for (int j = 0; j < ground.ny; j++)
    for (int i = 0; i < ground.nx; i++)
      below.at(i, j) = bedrock.height(ground.xlo + (i + 0.5) * ground.cell,
                                      ground.ylo + (j + 0.5) * ground.cell);
  return below;
}

/* ----------------------------------------------------------------------
   in the centres of the ground's cells
------------------------------------------------------------------------- */

std::string SlipSoil::contradiction(const ElevationGrid &ground) const
{
  char text[200];
  bool above_rock = !rocky;
  for (int j = 0; j < ground.ny; j++)
    for (int i = 0; i < ground.nx; i++) {
      const double x = ground.xlo + (i + 0.5) * ground.cell;
      const double y = ground.ylo + (j + 0.5) * ground.cell, z = ground.at(i, j);
      if (!std::isfinite(z)) continue;
      above_rock = above_rock || !(bedrock.height(x, y) >= z);
      const double level = has_table ? table.height(x, y) : z;
      if (level > z + ROUNDING) {
        snprintf(text, sizeof(text),
                 "water table must not be above the ground, got %.8g above %.8g at %.8g %.8g",
                 level, z, x, y);
        return text;
      }
      double above = HUGE_VAL;
      for (size_t k = 0; k < layers.size(); k++) {
        const double begins = layers[k].height(x, y);
        if (!std::isfinite(begins)) continue;
        if (begins > above + ROUNDING) {
          snprintf(text, sizeof(text),
                   "layer %d must not be above the layer before it, got %.8g above %.8g at %.8g "
                   "%.8g",
                   static_cast<int>(k + 1), begins, above, x, y);
          return text;
        }
        above = begins;
      }
    }
  return above_rock ? "" : "bedrock must be below the ground somewhere, got none of it";
}

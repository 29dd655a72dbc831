// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_writer.h"

#include "constants.h"
#include "file_set.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace Slope;

static std::string base_path(const std::string &prefix, size_t rank)
{
  return prefix + "." + std::to_string(rank) + ".base.asc";
}

/* ---------------------------------------------------------------------- */

void SlipWriter::probe(const std::string &prefix, int bodies)
{
  std::vector<std::string> paths = {prefix + ".slips.csv", prefix + ".factor.asc"};
  for (int k = 1; k <= bodies; k++) paths.push_back(base_path(prefix, k));
  FileSet::probe(paths);
}

/* ---------------------------------------------------------------------- */

std::string SlipWriter::table(const std::vector<SlipBody> &bodies)
{
  std::string text =
      "rank,x,y,z,radius,direction,factor,yield,volume,area,depth,along,across,straight\n";
  char line[400];
  for (size_t k = 0; k < bodies.size(); k++) {
    const SlipBody &b = bodies[k];
    const SlipSurface &s = b.surface;
    const double degrees = std::fmod(s.direction * 180.0 / PI + 360.0, 360.0);
    snprintf(line, sizeof(line),
             "%d,%.10g,%.10g,%.10g,%.10g,%.8g,%.8g,%.8g,%.10g,%.10g,%.8g,"
             "%.8g,%.8g,%.8g\n",
             static_cast<int>(k + 1), s.x, s.y, s.z, s.radius, degrees, b.factor, b.yield, b.volume,
             b.area, b.depth, s.along, s.across, s.straight);
    text += line;
  }
  return text;
}

/* ---------------------------------------------------------------------- */

void SlipWriter::write(const std::string &prefix, ElevationGrid least,
                       const std::vector<SlipBody> &bodies, SlipBodyMaker &maker)
{
  FileSet files;
  files.add(prefix + ".slips.csv").write(table(bodies));
  for (size_t k = 0; k < bodies.size(); k++) {
    const ElevationGrid base = maker.base(bodies[k].surface);
    base.write(files.add(base_path(prefix, k + 1)));
    for (size_t n = 0; n < base.z.size(); n++)
      if (!std::isnan(base.z[n])) least.z[n] = std::fmin(least.z[n], bodies[k].factor);
  }
  least.write(files.add(prefix + ".factor.asc"));
  files.commit();
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "slip_body.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "atomic_file.h"
#include "constants.h"

using namespace Slope;

static constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

/* ---------------------------------------------------------------------- */

SlipBodyMaker::SlipBodyMaker(const ElevationGrid &_ground, const SlipSoil &soil,
                             const std::vector<char> &_allowed, const SlipTask &_task) :
    allowed(_allowed),
    ground(_ground), task(_task), maker(_ground, soil, _allowed), found(), factor(_task.method)
{
}

/* ---------------------------------------------------------------------- */

std::string SlipBodyMaker::exact(const SlipSurface &s, SlipBody &body, int lines)
{
  const SlipSurface d = directed(s);
  if (!maker.exact(d, found, lines)) return "no ground is above it";
  if (found.at_edge) return "the body reaches the edge of the terrain or cells without a value";
  if (found.overhang) return "the ground at the rim of the body is above the centre";
  if (found.outside) return "the body reaches beyond the region within";
  fill(d, body, SlipFactor::PRECISION);
  return "";
}

/* ---------------------------------------------------------------------- */

bool SlipBodyMaker::coarse(const SlipSurface &s, int stride, SlipBody &body, double precision)
{
  const SlipSurface d = directed(s);
  if (!maker.coarse(d, stride, found)) return false;
  if (found.at_edge || found.overhang || found.outside) return false;
  fill(d, body, precision);
  return true;
}

SlipSurface SlipBodyMaker::directed(const SlipSurface &s) const
{
  SlipSurface d = s;
  if (!task.any_direction) d.direction = task.direction;
  return d;
}

/* ----------------------------------------------------------------------
   the columns of a round surface are the same for all directions of sliding
------------------------------------------------------------------------- */

void SlipBodyMaker::fill(const SlipSurface &s, SlipBody &body, double precision)
{
  body.surface = s;
  if (task.any_direction && s.round()) body.surface.direction = SlipFactor::steepest(found);
  factor.take(found, body.surface);
  body.factor = factor.factor(task.seismic, precision);
  body.yield = NONE;
  body.volume = found.volume;
  body.area = found.plan_area;
  body.depth = found.greatest_depth;
}

/* ---------------------------------------------------------------------- */

ElevationGrid SlipBodyMaker::base(const SlipSurface &s)
{
  ElevationGrid heights(ground.nx, ground.ny, ground.xlo, ground.ylo, ground.cell, NONE);
  if (!maker.coarse(s, 1, found)) return heights;
  for (size_t k = 0; k < found.size(); k++) {
    const int i = static_cast<int>((s.x + found.dx[k] - ground.xlo) / ground.cell);
    const int j = static_cast<int>((s.y + found.dy[k] - ground.ylo) / ground.cell);
    heights.at(i, j) = s.z - found.depth[k];
  }
  return heights;
}

static std::string path_of(const std::string &prefix, size_t rank, const char *end)
{
  return prefix + "." + std::to_string(rank) + end;
}

static constexpr char BASE[] = ".base.asc", COLUMNS[] = ".columns.csv";

/* ---------------------------------------------------------------------- */

void SlipWriter::probe(const std::string &prefix, int bodies)
{
  std::vector<std::string> paths = {prefix + ".slips.csv", prefix + ".factor.asc"};
  for (int k = 1; k <= bodies; k++)
    for (const char *end : {BASE, COLUMNS}) paths.push_back(path_of(prefix, k, end));
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

/* ----------------------------------------------------------------------
   Digits that leave the factor as it is in the table: its rounding is that of one number over the root of
   their count. A body has thousands of columns, a large one four for each cell of its plan.
------------------------------------------------------------------------- */

void SlipWriter::columns(AtomicFile &file, const SlipSurface &s, const SlipColumns &c)
{
  file.write("dx_m,dy_m,depth_m,area_m2,slope_x,slope_y,weight_n,weight_depth_m,pressure_pa\n");
  char line[200];
  for (size_t i = 0; i < c.size(); i++) {
    SlipSurface::Slope slope = s.slope(c.dx[i], c.dy[i], c.depth[i]);
    if (c.rocky && !std::isnan(c.slope_x[i])) slope = {c.slope_x[i], c.slope_y[i]};
    const int length = snprintf(
        line, sizeof(line), "%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g,%.8g\n", c.dx[i], c.dy[i],
        c.depth[i], c.area[i], slope.x, slope.y, c.weight[i], c.arm[i], c.pore[i]);
    file.write(line, length);
  }
}

/* ---------------------------------------------------------------------- */

void SlipWriter::write(const std::string &prefix, ElevationGrid least,
                       const std::vector<SlipBody> &bodies, SlipBodyMaker &maker)
{
  FileSet files;
  files.add(prefix + ".slips.csv").write(table(bodies));
  for (size_t k = 0; k < bodies.size(); k++) {
    SlipBody body;
    maker.exact(bodies[k].surface, body);
    columns(files.add(path_of(prefix, k + 1, COLUMNS)), body.surface, maker.columns());
    const ElevationGrid base = maker.base(bodies[k].surface);
    base.write(files.add(path_of(prefix, k + 1, BASE)));
    for (size_t n = 0; n < base.z.size(); n++)
      if (!std::isnan(base.z[n])) least.z[n] = std::fmin(least.z[n], bodies[k].factor);
  }
  least.write(files.add(prefix + ".factor.asc"));
  files.commit();
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_rasters.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace Slope;

static const double NaN = std::numeric_limits<double>::quiet_NaN();

enum { X, Y };

/* ---------------------------------------------------------------------- */

AtomicFile &FileSet::add(const std::string &path)
{
  files.emplace_back(new AtomicFile(path));
  paths.push_back(path);
  return *files.back();
}

/* ---------------------------------------------------------------------- */

std::vector<std::string> FileSet::names() const
{
  std::vector<std::string> found;
  for (const std::string &path : paths) found.push_back(path.substr(path.rfind('/') + 1));
  return found;
}

/* ---------------------------------------------------------------------- */

void FileSet::commit()
{
  for (auto &file : files) file->close();
  for (auto &file : files) file->commit();
}

/* ---------------------------------------------------------------------- */

void DepositRasters::create(const PlanGrid &grid_in)
{
  grid = grid_in;
  const ElevationGrid zero(grid.n[X], grid.n[Y], grid.lo[X], grid.lo[Y], grid.cell, 0.0);
  thickness = snapshot = max_thickness = max_speed = max_energy = zero;
  base = arrival = last_motion =
      ElevationGrid(grid.n[X], grid.n[Y], grid.lo[X], grid.lo[Y], grid.cell, NaN);
}

/* ---------------------------------------------------------------------- */

void DepositRasters::start()
{
  for (int j = filled.first[Y]; j < filled.first[Y] + filled.size[Y]; j++)
    std::fill_n(&thickness.at(filled.first[X], j), filled.size[X], 0.0);
  filled.size[X] = filled.size[Y] = 0;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::add(DepositWindow &from, bool record, double time, double motion)
{
  if (from.values.empty()) return;
  const double area = grid.cell * grid.cell;
  for (int j = 0; j < from.size[Y]; j++)
    for (int i = 0; i < from.size[X]; i++) {
      const int gi = from.first[X] + i, gj = from.first[Y] + j;
      thickness.at(gi, gj) += from.volume(i, j) / area;
      const double speed = from.speed(i, j);
      if (!record || speed < 0.0) continue;
      max_speed.at(gi, gj) = std::max(max_speed.at(gi, gj), speed);
      max_energy.at(gi, gj) = std::max(max_energy.at(gi, gj), from.energy(i, j));
      if (std::isnan(arrival.at(gi, gj))) arrival.at(gi, gj) = time;
      if (speed > motion) last_motion.at(gi, gj) = time;
    }
  filled.cover(from);
}

/* ----------------------------------------------------------------------
   the volume is taken from what the raster holds, so that the balance checks the raster
------------------------------------------------------------------------- */

double DepositRasters::finish(bool record)
{
  double sum = 0.0;
  for (int j = filled.first[Y]; j < filled.first[Y] + filled.size[Y]; j++) {
    double row = 0.0;
    for (int i = filled.first[X]; i < filled.first[X] + filled.size[X]; i++) {
      const double h = thickness.at(i, j);
      row += h;
      if (record && h > max_thickness.at(i, j)) max_thickness.at(i, j) = h;
    }
    sum += row;
  }
  return sum * grid.cell * grid.cell;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::take_snapshot(int64_t step, int window, double time, double released)
{
  if (snapshot_step >= 0 && snapshot_step + window == step) {
    double sum = 0.0;
    for (size_t k = 0; k < thickness.z.size(); k++)
      sum += std::fabs(thickness.z[k] - snapshot.z[k]);
    change = 0.5 * sum * grid.cell * grid.cell / (released * (time - snapshot_time));
  }
  snapshot.z = thickness.z;
  snapshot_step = step;
  snapshot_time = time;
}

/* ----------------------------------------------------------------------
   the sum of the thickness as written is the volume on the grid to 1e-9
------------------------------------------------------------------------- */

void DepositRasters::write(FileSet &files, const std::string &prefix,
                           const std::string &number) const
{
  ElevationGrid surface = base;
  for (size_t k = 0; k < surface.z.size(); k++) surface.z[k] += thickness.z[k];

  if (!number.empty()) thickness.write(files.add(prefix + "." + number + ".thickness.asc"), 12);
  thickness.write(files.add(prefix + ".thickness.asc"), 12);
  surface.write(files.add(prefix + ".surface.asc"), 9);
  base.write(files.add(prefix + ".base.asc"), 9);
  max_thickness.write(files.add(prefix + ".max_thickness.asc"), 9);
  max_speed.write(files.add(prefix + ".max_speed.asc"), 9);
  max_energy.write(files.add(prefix + ".max_energy.asc"), 9);
  arrival.write(files.add(prefix + ".arrival.asc"), 9);
  last_motion.write(files.add(prefix + ".last_motion.asc"), 9);
}

/* ---------------------------------------------------------------------- */

std::vector<double> DepositRasters::touched() const
{
  std::vector<double> values;
  for (size_t k = 0; k < ncells(); k++) {
    if (max_thickness.z[k] == 0.0 && std::isnan(arrival.z[k])) continue;
    const double cell[PER_CELL] = {(double) k,      max_thickness.z[k], max_speed.z[k],
                                   max_energy.z[k], arrival.z[k],       last_motion.z[k],
                                   snapshot.z[k]};
    values.insert(values.end(), cell, cell + PER_CELL);
  }
  return values;
}

/* ---------------------------------------------------------------------- */

void DepositRasters::restore(const double *values)
{
  const size_t k = (size_t) values[0];
  max_thickness.z[k] = values[1];
  max_speed.z[k] = values[2];
  max_energy.z[k] = values[3];
  arrival.z[k] = values[4];
  last_motion.z[k] = values[5];
  snapshot.z[k] = values[6];
}

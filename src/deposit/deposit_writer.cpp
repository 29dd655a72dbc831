// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_writer.h"

#include "elevation_grid.h"

using namespace Slope;

// the sum of the thickness as written is the volume on the grid to 1e-9
static constexpr int EXACT = 12, DIGITS = 9;

enum { X, Y };

/* ---------------------------------------------------------------------- */

std::vector<DepositWriter::File> DepositWriter::files(const std::string &prefix,
                                                      const std::string &number)
{
  std::vector<File> found;
  if (!number.empty())
    found.push_back({prefix + "." + number + ".thickness.asc", DepositRasters::THICKNESS, EXACT});
  const std::vector<File> always = {{".thickness.asc", DepositRasters::THICKNESS, EXACT},
                                    {".surface.asc", SURFACE, DIGITS},
                                    {".base.asc", BASE, DIGITS},
                                    {".max_thickness.asc", DepositRasters::MAX_THICKNESS, DIGITS},
                                    {".max_speed.asc", DepositRasters::MAX_SPEED, DIGITS},
                                    {".max_energy.asc", DepositRasters::MAX_ENERGY, DIGITS},
                                    {".arrival.asc", DepositRasters::ARRIVAL, DIGITS},
                                    {".last_motion.asc", DepositRasters::LAST_MOTION, DIGITS}};
  for (const File &file : always) found.push_back({prefix + file.path, file.content, file.digits});
  return found;
}

/* ---------------------------------------------------------------------- */

void DepositWriter::write(AtomicFile &to, const DepositRasters &rasters, const File &file)
{
  const PlanGrid &grid = rasters.grid();
  const int columns = grid.n[X];
  std::vector<double> row(columns, 0.0);
  std::string text = ElevationGrid::header(columns, grid.n[Y], grid.lo[X], grid.lo[Y], grid.cell);
  for (int j = grid.n[Y] - 1; j >= 0; j--) {    // the rows start in the north
    if (file.content == SURFACE)
      rasters.row(DepositRasters::THICKNESS, j, row.data());
    else if (file.content != BASE)
      rasters.row((DepositRasters::Name) file.content, j, row.data());
    for (int i = 0; i < columns && file.content >= BASE; i++)
      row[i] = rasters.base(i, j) + (file.content == SURFACE ? row[i] : 0.0);
    ElevationGrid::append_row(text, row.data(), columns, file.digits);
    to.write(text);
    text.clear();
  }
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "rasters_to_vtk.h"

#include "elevation_grid.h"
#include "interrupt.h"
#include "line_reader.h"
#include "numbers.h"
#include "options.h"
#include "output_files.h"
#include "progress.h"
#include "vtk_data.h"
#include "vtk_writer.h"

#include <vtkCellData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLStructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

using namespace Slope;
namespace fs = std::filesystem;

static const double NaN = std::numeric_limits<double>::quiet_NaN();

namespace {

/* ----------------------------------------------------------------------
   The cell centres of a raster as points at given heights, with its values; hidden where either is
   NaN. Cells with a hidden corner are hidden too: some filters look at points only, some at cells.
   Returns the number of points that show.
------------------------------------------------------------------------- */

template <class Height>
size_t write_grid(const ElevationGrid &raster, const std::string &name, Height height, bool single,
                  const std::string &path)
{
  const int nx = raster.nx, ny = raster.ny;
  const vtkIdType n = (vtkIdType) nx * ny;
  std::vector<double> z(n);
  std::vector<bool> hidden(n);
  double lowest = NaN;
  size_t showing = 0;
  for (int j = 0; j < ny; j++) {
    check_interrupt();
    for (int i = 0; i < nx; i++) {
      const size_t k = (size_t) j * nx + i;
      z[k] = height(i, j);
      hidden[k] = std::isnan(z[k]) || std::isnan(raster.z[k]);
      if (!hidden[k]) showing++;
      if (!hidden[k] && !(z[k] >= lowest)) lowest = z[k];
    }
  }
  if (showing == 0) return 0;

  // Hidden points need a place too: the ground, so that a program that draws them hides nothing

  for (double &value : z)
    if (std::isnan(value)) value = lowest;

  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(nx, ny, 1);
  vtkNew<vtkPoints> points;
  points->SetData(make_array("Points", n, 3, single, [&](vtkIdType i, int k) {
    if (k == 0) return raster.xlo + (i % nx + 0.5) * raster.cell;
    if (k == 1) return raster.ylo + (i / nx + 0.5) * raster.cell;
    return z[i];
  }));
  grid->SetPoints(points);
  grid->GetPointData()->SetScalars(make_array(name.c_str(), n, 1, single, [&](vtkIdType i, int) {
    return hidden[i] ? NaN : raster.z[i];
  }));

  if ((vtkIdType) showing < n) {
    vtkNew<vtkUnsignedCharArray> point_ghosts, cell_ghosts;
    point_ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    point_ghosts->SetNumberOfTuples(n);
    for (vtkIdType i = 0; i < n; i++)
      point_ghosts->SetValue(i, hidden[i] ? vtkDataSetAttributes::HIDDENPOINT : 0);
    grid->GetPointData()->AddArray(point_ghosts);

    const int cx = std::max(1, nx - 1), cy = std::max(1, ny - 1);
    cell_ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    cell_ghosts->SetNumberOfTuples((vtkIdType) cx * cy);
    for (int j = 0; j < cy; j++)
      for (int i = 0; i < cx; i++) {
        bool any = false;
        for (int dj = 0; dj < std::min(2, ny); dj++)
          for (int di = 0; di < std::min(2, nx); di++)
            any = any || hidden[(size_t) (j + dj) * nx + i + di];
        cell_ghosts->SetValue((vtkIdType) j * cx + i, any ? vtkDataSetAttributes::HIDDENCELL : 0);
      }
    grid->GetCellData()->AddArray(cell_ghosts);
  }
  write_vtk<vtkXMLStructuredGridWriter>(grid.Get(), path);
  return showing;
}

std::string size_text(const ElevationGrid &raster, size_t showing)
{
  return std::to_string(raster.nx) + " x " + std::to_string(raster.ny) + " points, " +
      std::to_string((size_t) raster.nx * raster.ny - showing) + " of them hidden\n";
}

std::string extent_text(const ElevationGrid &raster)
{
  return "x " + to_text(raster.xlo) + " to " + to_text(raster.xhi()) + ", y " +
      to_text(raster.ylo) + " to " + to_text(raster.yhi());
}

// Where local 0 0 lies in the survey, of the sidecar that `slope terrain` writes beside FILE.asc; rasters of a run
// have none: they are in the coordinates of its terrain

struct Origin {
  std::string path;    // empty where nothing is known
  double east = 0.0, north = 0.0;
  std::string epsg = "null";
};

Origin origin_of(const std::string &raster)
{
  const fs::path path = fs::path(raster).replace_extension(".yaml");
  if (fs::path(raster).extension() != ".asc" || !fs::exists(path)) return Origin();
  Origin found;
  found.path = raster;
  LineReader file(path.string());
  std::string section;
  int sides = 0;
  while (file.next()) {
    const auto &words = file.words();
    if (words.empty()) continue;
    if (words.size() == 1) section = words[0];
    if (words.size() != 2) continue;
    if (section == "crs:" && words[0] == "epsg:") found.epsg = words[1];
    if (section != "origin:" || (words[0] != "east:" && words[0] != "north:")) continue;
    double &side = words[0] == "east:" ? found.east : found.north;
    if (!to_number(std::string(words[1]), side) || !std::isfinite(side))
      file.fail("origin must be numbers, got " + std::string(words[1].substr(0, 40)));
    sides++;
  }
  if (sides != 2)
    throw std::runtime_error(path.string() + " must be the sidecar of " + raster +
                             " with origin: east: and north:, got none");
  return found;
}

// A raster in the local coordinates of the first one that has an origin

ElevationGrid read_raster(const std::string &path, Origin &first)
{
  ElevationGrid raster = ElevationGrid::read(path);
  const Origin own = origin_of(path);
  if (own.path.empty()) return raster;
  if (first.path.empty()) first = own;
  if (own.epsg != first.epsg && own.epsg != "null" && first.epsg != "null")
    throw std::runtime_error(path + " must be in the CRS of " + first.path +
                             ", EPSG:" + first.epsg + ", got EPSG:" + own.epsg);
  raster.xlo += own.east - first.east;
  raster.ylo += own.north - first.north;
  return raster;
}

// embankment.thickness.asc -> thickness, embankment.00000900.thickness.asc -> 00000900.thickness

std::string raster_name(const std::string &path)
{
  fs::path stem = fs::path(path).filename();
  if (stem.extension() == ".asc") stem = stem.stem();
  std::string name = stem.extension().string();
  if (name.size() < 2) return stem.string();
  const std::string before = stem.stem().extension().string();
  if (before.size() > 1 && before.find_first_not_of("0123456789", 1) == before.npos)
    name = before + name;
  return name.substr(1);
}

}    // namespace

/* ---------------------------------------------------------------------- */

void Slope::rasters_to_vtk(const Options &options, OutputFiles &output, Progress &progress,
                           std::string &report)
{
  const fs::path folder = options.out.parent_path();
  std::map<std::string, std::string> sources;    // of names that are taken
  if (!options.terrain.empty()) sources["terrain"] = options.terrain;
  for (const auto &path : options.rasters) {
    const std::string name = raster_name(path);
    if (sources.count(name))
      throw std::runtime_error("--raster: " + sources[name] + " and " + path +
                               " would both become " +
                               (folder / output.single(name + ".vts")).string());
    sources[name] = path;
  }

  ElevationGrid ground;
  Origin first;
  if (!options.terrain.empty()) {
    progress.say("terrain");
    ground = read_raster(options.terrain, first);
    const fs::path file = output.single("terrain.vts");
    auto height = [&](int i, int j) {
      return ground.at(i, j);
    };
    const size_t showing = write_grid(ground, "height", height, options.single, output.path(file));
    report += (folder / file).string() + ": " + size_text(ground, showing);
  }
  if (!options.surface.empty()) ground = read_raster(options.surface, first);
  const std::string &base = options.surface.empty() ? options.terrain : options.surface;

  for (const auto &path : options.rasters) {
    const std::string name = raster_name(path);
    progress.say(name);
    const ElevationGrid raster = read_raster(path, first);
    const fs::path file = output.single(name + ".vts");

    // On a centre of the ground's cells its height, also where rounding would put a little weight
    // on a NODATA neighbour

    auto height = [&](int i, int j) {
      const double x = raster.xlo + (i + 0.5) * raster.cell,
                   y = raster.ylo + (j + 0.5) * raster.cell;
      const double u = (x - ground.xlo) / ground.cell - 0.5,
                   v = (y - ground.ylo) / ground.cell - 0.5;
      const double column = std::round(u), row = std::round(v);
      if (std::fabs(u - column) < 1e-6 && std::fabs(v - row) < 1e-6 && column >= 0.0 &&
          row >= 0.0 && column < ground.nx && row < ground.ny)
        return ground.at(column, row);
      return ground.height(x, y);
    };
    const std::string array = name.substr(name.find('.') == name.npos ? 0 : name.find('.') + 1);
    const size_t showing = write_grid(raster, array, height, options.single, output.path(file));
    if (showing == 0)
      throw std::runtime_error(path + " must have a value somewhere on " + base + ", which is " +
                               extent_text(ground) + ", got " + extent_text(raster));
    report += (folder / file).string() + ": " + size_text(raster, showing);
  }
}

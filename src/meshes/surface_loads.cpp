// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_loads.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

using namespace Slope;

// numbers to ten digits, with commas or blanks between them
static void append(std::string &text, const double *values, int n, char between, char end)
{
  char number[32];
  for (int k = 0; k < n; k++) {
    snprintf(number, sizeof(number), "%.10g", values[k]);
    text += number;
    text += k + 1 < n ? between : end;
  }
}

/* ---------------------------------------------------------------------- */

void SurfaceLoads::take(std::vector<Record> &records)
{
  std::sort(records.begin(), records.end(), [](const Record &a, const Record &b) {
    if (a.step != b.step) return a.step < b.step;
    if (a.triangle != b.triangle) return a.triangle < b.triangle;
    if (a.force != b.force) return a.force < b.force;    // the same sum whatever ranks there were
    return a.impulse < b.impulse;
  });
  for (size_t k = 0, end; k < records.size(); k = end) {
    const Record &first = records[k];
    double force = 0.0, impulse = 0.0;
    for (end = k; end < records.size() && records[end].step == first.step &&
         records[end].triangle == first.triangle;
         end++) {
      force += records[end].force;
      impulse += records[end].impulse;
    }
    Load &load =
        loads.insert({static_cast<int>(first.triangle), {0.0, 0.0, 0.0, 0.0}}).first->second;
    load.step = first.step;
    load.last = force;
    load.largest = std::max(load.largest, force);
    load.impulse += impulse;
  }
}

/* ---------------------------------------------------------------------- */

SurfaceLoads::Values SurfaceLoads::values_of(const Load &load, const Triangle &t, double step)
{
  const double area = t.area();
  return {load.step == step ? load.last / area : 0.0, load.largest / area, load.impulse / area,
          area};
}

/* ---------------------------------------------------------------------- */

std::string SurfaceLoads::series(const Row *end) const
{
  std::string s = "step,time,fx,fy,fz,mx,my,mz,jx,jy,jz,contacts,largest_force,largest_moment\n";
  const auto add = [&s](const Row &row) {
    append(s, &row.step, sizeof(Row) / sizeof(double), ',', '\n');
  };
  for (const Row &row : rows) add(row);
  if (end) add(*end);
  return s;
}

/* ---------------------------------------------------------------------- */

std::string SurfaceLoads::triangles(const TouchedSurface &surface, double step) const
{
  std::string s = "triangle,x,y,z,area,last_pressure,largest_pressure,impulse\n";
  for (const auto &entry : loads) {
    const Triangle t = surface.triangle(entry.first);
    const Values v = values_of(entry.second, t, step);
    const Vector m = t.middle();
    const double line[8] = {entry.first + 1.0, m.x,      m.y, m.z + surface.lower, v.area, v.last,
                            v.largest,         v.impulse};
    append(s, line, 8, ',', '\n');
  }
  return s;
}

/* ----------------------------------------------------------------------
   VTK's format for ParaView: corners, cells, and three values of each cell
------------------------------------------------------------------------- */

static void add_array(std::string &text, const char *type, const char *name, int width,
                      const std::string &values)
{
  text += std::string("<DataArray type=\"") + type + "\" Name=\"" + name +
      "\" NumberOfComponents=\"" + std::to_string(width) + "\" format=\"ascii\">\n" + values +
      "</DataArray>\n";
}

std::string SurfaceLoads::polydata(const TouchedSurface &surface, double step) const
{
  std::string corners, links, ends, last, largest, impulse;
  int n = 0;
  auto add = [&](int number) {
    Triangle t = surface.triangle(number);
    const auto found = loads.find(number);
    const Values v = found == loads.end() ? Values{0.0, 0.0, 0.0, 0.0}
                                          : values_of(found->second, t, step);
    for (Vector *corner : {&t.a, &t.b, &t.c}) corner->z += surface.lower;
    append(corners, &t.a.x, 9, ' ', '\n');
    for (int c = 0; c < 3; c++) links += std::to_string(3 * n + c) + (c < 2 ? ' ' : '\n');
    ends += std::to_string(3 * ++n) + '\n';
    append(last, &v.last, 1, ' ', '\n');
    append(largest, &v.largest, 1, ' ', '\n');
    append(impulse, &v.impulse, 1, ' ', '\n');
  };
  if (surface.sparse())
    for (const auto &entry : loads) add(entry.first);
  else
    for (int k = 0; k < surface.count(); k++) add(k);

  std::string s = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
                  "byte_order=\"LittleEndian\">\n<PolyData>\n<Piece NumberOfPoints=\"" +
      std::to_string(3 * n) + "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" " +
      "NumberOfPolys=\"" + std::to_string(n) + "\">\n<Points>\n";
  add_array(s, "Float64", "corners", 3, corners);
  s += "</Points>\n<Polys>\n";
  add_array(s, "Int32", "connectivity", 1, links);
  add_array(s, "Int32", "offsets", 1, ends);
  s += "</Polys>\n<CellData Scalars=\"largest_pressure\">\n";
  add_array(s, "Float64", "last_pressure", 1, last);
  add_array(s, "Float64", "largest_pressure", 1, largest);
  add_array(s, "Float64", "impulse", 1, impulse);
  return s + "</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
}

/* ---------------------------------------------------------------------- */

std::vector<double> SurfaceLoads::pack() const
{
  std::vector<double> list = {static_cast<double>(loads.size()), static_cast<double>(rows.size())};
  for (const auto &entry : loads) {
    list.push_back(entry.first);
    list.insert(list.end(), &entry.second.step, &entry.second.step + 4);
  }
  for (const Row &row : rows)
    list.insert(list.end(), &row.step, &row.step + sizeof(Row) / sizeof(double));
  return list;
}

void SurfaceLoads::unpack(const double *numbers, size_t size, double triangles)
{
  static constexpr size_t LOAD = 5, ROW = sizeof(Row) / sizeof(double);
  const double of_loads = size > 0 ? numbers[0] : 0.0, of_rows = size > 1 ? numbers[1] : 0.0;
  bool whole = size > 1 && of_loads >= 0.0 && of_rows >= 0.0 && of_loads == std::floor(of_loads) &&
      2.0 + LOAD * of_loads + ROW * of_rows == size;
  const size_t nload = whole ? of_loads : 0, nrow = whole ? of_rows : 0;
  for (size_t k = 0; k < nload; k++) {
    const double triangle = numbers[2 + LOAD * k];
    whole = whole && triangle >= 0.0 && triangle < triangles;
  }
  if (!whole)
    throw std::runtime_error(
        "the loads in the restart file must be those of triangles of the surface, "
        "got others: the file is damaged, take an earlier one");

  const double *next = numbers + 2;
  loads.clear();
  rows.resize(nrow);
  for (size_t k = 0; k < nload; k++, next += 5)
    loads[static_cast<int>(next[0])] = {next[1], next[2], next[3], next[4]};
  for (Row &row : rows) {
    std::copy_n(next, sizeof(Row) / sizeof(double), &row.step);
    next += sizeof(Row) / sizeof(double);
  }
}

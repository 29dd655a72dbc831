/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "snapshot_to_vtk.h"

#include "dump_reader.h"
#include "numbers.h"
#include "options.h"
#include "vtk_data.h"
#include "vtk_writer.h"

#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

using namespace Slope;

namespace {

// columns of a dump that become one array, and the array of its lengths

struct Vector {
  const char *columns[3], *name, *magnitude;
};

const Vector VECTORS[] = {{{"vx", "vy", "vz"}, "velocity", "speed"},
                          {{"omegax", "omegay", "omegaz"}, "omega", "spin"},
                          {{"fx", "fy", "fz"}, "force", nullptr},
                          {{"tqx", "tqy", "tqz"}, "torque", nullptr}};

// columns that are whole numbers, whatever they hold in a snapshot: an array must not change its
// type from one time step to the next

bool is_whole(const std::string &name)
{
  for (const char *whole : {"id", "mol", "type", "proc", "procp1", "ix", "iy", "iz"})
    if (name == whole) return true;
  return false;
}

vtkSmartPointer<vtkDataArray> whole_numbers(const Snapshot &snapshot, int column,
                                            const LineReader &file)
{
  const std::string &name = snapshot.names[column];
  const auto &values = snapshot.columns[column];
  const vtkIdType n = snapshot.count;
  for (vtkIdType i = 0; i < n; i++)
    if (!(std::fabs(values[i]) < 9e15) || values[i] != std::floor(values[i]))
      throw std::runtime_error(file.name() + ", line " +
                               std::to_string(snapshot.atoms_line + 1 + i) + ": column " + name +
                               " must be a whole number, got " + to_text(values[i]));
  return make_integers(name.c_str(), n, [&](vtkIdType i) {
    return (vtkTypeInt64) values[i];
  });
}

}    // namespace

/* ---------------------------------------------------------------------- */

void Slope::snapshot_to_vtk(const Snapshot &snapshot, const LineReader &file,
                            const Options &options, double time, const std::string &path)
{
  std::vector<double> xyz;
  std::array<int, 3> coordinates;
  positions(snapshot, file, xyz, coordinates);
  auto data = make_balls(xyz, options.single);
  const vtkIdType n = snapshot.count;
  std::vector<double>().swap(xyz);

  auto add = [&](vtkSmartPointer<vtkDataArray> array) {
    data->GetPointData()->AddArray(array);
  };
  std::vector<bool> done(snapshot.names.size());
  for (const int k : coordinates) done[k] = true;

  // diameter

  const int radius = snapshot.find("radius");
  if (snapshot.find("diameter") < 0 && radius >= 0) {
    const auto &values = snapshot.columns[radius];
    add(make_array("diameter", n, 1, options.single, [&](vtkIdType i, int) {
      return 2.0 * values[i];
    }));
  } else if (snapshot.find("diameter") < 0 && options.diameter > 0.0) {
    add(make_array("diameter", n, 1, options.single, [&](vtkIdType, int) {
      return options.diameter;
    }));
  }

  // vectors; a column of the dump goes before an array of ours of the same name

  for (const auto &vector : VECTORS) {
    int column[3];
    for (int k = 0; k < 3; k++) column[k] = snapshot.find(vector.columns[k]);
    if (*std::min_element(column, column + 3) < 0 || snapshot.find(vector.name) >= 0) continue;
    auto component = [&](vtkIdType i, int k) {
      return snapshot.columns[column[k]][i];
    };
    add(make_array(vector.name, n, 3, options.single, component));
    for (const int k : column) done[k] = true;
    if (vector.magnitude && snapshot.find(vector.magnitude) < 0)
      add(make_array(vector.magnitude, n, 1, options.single, [&](vtkIdType i, int) {
        return std::hypot(component(i, 0), component(i, 1), component(i, 2));
      }));
  }

  // all others by name

  for (size_t k = 0; k < snapshot.names.size(); k++) {
    const std::string &name = snapshot.names[k];
    const auto &values = snapshot.columns[k];
    if (done[k] || !snapshot.numeric[k]) continue;
    if (is_whole(name))
      add(whole_numbers(snapshot, k, file));
    else
      add(make_array(name.c_str(), n, 1, options.single, [&](vtkIdType i, int) {
        return values[i];
      }));
  }
  data->GetPointData()->SetActiveScalars("speed");
  data->GetPointData()->SetActiveVectors("velocity");

  // ParaView takes the time of a file that is opened without the .pvd from here

  data->GetFieldData()->AddArray(make_array("TimeValue", 1, 1, false, [&](vtkIdType, int) {
    return time;
  }));
  data->GetFieldData()->AddArray(make_integers("step", 1, [&](vtkIdType) {
    return (vtkTypeInt64) snapshot.step;
  }));
  write_vtk<vtkXMLPolyDataWriter>(data.Get(), path);
}

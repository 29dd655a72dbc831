/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_VTK_DATA_H
#define SLOPE_VTK_DATA_H

#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkSmartPointer.h>
#include <vtkTypeInt64Array.h>

#include <vector>

class vtkPolyData;

namespace Slope {

// n tuples of value(i,k), in double or single precision
template <class Value>
vtkSmartPointer<vtkDataArray> make_array(const char *name, vtkIdType n, int ncomponents,
                                         bool single, Value value)
{
  auto fill = [&](auto array) {
    array->SetName(name);
    array->SetNumberOfComponents(ncomponents);
    array->SetNumberOfTuples(n);
    auto *at = array->GetPointer(0);
    for (vtkIdType i = 0; i < n; i++)
      for (int k = 0; k < ncomponents; k++) *at++ = value(i, k);
    return vtkSmartPointer<vtkDataArray>(array);
  };
  if (single) return fill(vtkSmartPointer<vtkFloatArray>::New());
  return fill(vtkSmartPointer<vtkDoubleArray>::New());
}

// n values value(i)
template <class Value>
vtkSmartPointer<vtkDataArray> make_integers(const char *name, vtkIdType n, Value value)
{
  auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
  array->SetName(name);
  array->SetNumberOfTuples(n);
  for (vtkIdType i = 0; i < n; i++) array->SetValue(i, value(i));
  return array;
}

// Points with one vertex each: filters and selections of ParaView work on cells
vtkSmartPointer<vtkPolyData> make_balls(const std::vector<double> &xyz, bool single);

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "vtk_data.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

using namespace Slope;

/* ---------------------------------------------------------------------- */

vtkSmartPointer<vtkPolyData> Slope::make_balls(const std::vector<double> &xyz, bool single)
{
  const vtkIdType n = xyz.size() / 3;
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(make_array("Points", n, 3, single, [&](vtkIdType i, int k) {
    return xyz[3 * i + k];
  }));
  data->SetPoints(points);
  vtkNew<vtkCellArray> verts;
  verts->AllocateExact(n, n);
  for (vtkIdType i = 0; i < n; i++) verts->InsertNextCell(1, &i);
  data->SetVerts(verts);
  return data;
}

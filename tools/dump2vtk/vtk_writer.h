/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_VTK_WRITER_H
#define SLOPE_VTK_WRITER_H

#include <vtkErrorCode.h>
#include <vtkNew.h>

#include <fstream>
#include <ios>
#include <stdexcept>
#include <string>

namespace Slope {

static constexpr int COMPRESSION = 1;    // of zlib; VTK's 5 costs a third more time and saves 1 %

// A file with the data of one of VTK's classes, by the writer for it; an error is a
// std::runtime_error of one line that names the path
template <class Writer, class Data> void write_vtk(Data *data, const std::string &path)
{
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetFileName(path.c_str());
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();    // arrays above 4 GB
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(COMPRESSION);
  const bool written = writer->Write() && writer->GetErrorCode() == vtkErrorCode::NoError;

  // VTK does not look at what the last flush of the file says, so look at the file's end

  const std::string ending = "</VTKFile>\n";
  std::string tail(ending.size(), ' ');
  if (written) {
    std::ifstream file(path, std::ios::binary);
    file.seekg(-(std::streamoff) ending.size(), std::ios::end);
    file.read(tail.data(), tail.size());
  }
  if (tail != ending) {
    const auto code = writer->GetErrorCode();
    throw std::runtime_error("cannot write " + path + ": " +
                             (code == vtkErrorCode::NoError
                                  ? "the file is incomplete, is the disk full?"
                                  : vtkErrorCode::GetStringFromErrorCode(code)));
  }
}

}    // namespace Slope

#endif

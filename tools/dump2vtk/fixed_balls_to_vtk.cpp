/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "fixed_balls_to_vtk.h"

#include "line_reader.h"
#include "numbers.h"
#include "options.h"
#include "output_files.h"
#include "progress.h"
#include "vtk_data.h"
#include "vtk_writer.h"

#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <vector>

using namespace Slope;
namespace fs = std::filesystem;

/* ---------------------------------------------------------------------- */

void Slope::fixed_balls_to_vtk(const Options &options, OutputFiles &output, Progress &progress,
                               std::string &report)
{
  std::vector<double> xyz;
  std::vector<size_t> ends;    // of each file's balls
  progress.say("fixed balls");
  for (const auto &path : options.balls) {
    LineReader file(path);
    while (file.next()) {
      auto words = file.words();
      const auto comment = std::find_if(words.begin(), words.end(), [](auto word) {
        return word[0] == '#';
      });
      words.erase(comment, words.end());
      if (words.empty()) continue;
      if (words.size() != 3)
        file.fail("must be x y z of a ball, got " + std::to_string(words.size()) + " words");
      for (const auto &word : words) {
        double value;
        if (!to_number(word, value) || !std::isfinite(value))
          file.fail("must be three finite numbers x y z, got " + std::string(word.substr(0, 40)));
        xyz.push_back(value);
      }
    }
    ends.push_back(xyz.size() / 3);
    if (ends.back() == (ends.size() > 1 ? ends[ends.size() - 2] : 0))
      throw std::runtime_error(path + " must have lines x y z, got none");
  }

  auto data = make_balls(xyz, options.single);
  const vtkIdType n = xyz.size() / 3;
  data->GetPointData()->AddArray(make_array("diameter", n, 1, options.single, [&](vtkIdType, int) {
    return options.diameter;
  }));
  data->GetPointData()->AddArray(make_integers("file", n, [&](vtkIdType i) {
    return 1 + (std::upper_bound(ends.begin(), ends.end(), (size_t) i) - ends.begin());
  }));
  const fs::path file = output.single("balls.vtp");
  write_vtk<vtkXMLPolyDataWriter>(data.Get(), output.path(file));
  report +=
      (options.out.parent_path() / file).string() + ": " + std::to_string(n) + " fixed balls\n";
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2

   dump2vtk: dumps, terrain, rasters and fixed balls as files for ParaView.
   See doc/src/tool_dump2vtk.rst.
------------------------------------------------------------------------- */

#include "dumps_to_vtk.h"
#include "fixed_balls_to_vtk.h"
#include "interrupt.h"
#include "options.h"
#include "output_files.h"
#include "progress.h"
#include "rasters_to_vtk.h"

#include <vtkObject.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

using namespace Slope;

/* ---------------------------------------------------------------------- */

static int run(const std::vector<std::string> &words)
{
  for (const auto &word : words)
    if (word == "--help" || word == "-h") {
      fputs(HELP, stdout);
      return 0;
    }
  const Options options = parse_options(words);

  vtkObject::GlobalWarningDisplayOff();    // write_vtk() says it, in one line
  std::string report;
  OutputFiles output(options.out);
  {
    Progress progress;
    if (!options.terrain.empty() || !options.rasters.empty())
      rasters_to_vtk(options, output, progress, report);
    if (!options.balls.empty()) fixed_balls_to_vtk(options, output, progress, report);
    if (!options.dumps.empty()) dumps_to_vtk(options, output, progress, report);
    output.commit(!options.dumps.empty());
  }
  fputs(report.c_str(), stdout);
  return 0;
}

/* ---------------------------------------------------------------------- */

int main(int narg, char **arg)
{
  catch_signals();

  std::string message;
  try {
    return run(std::vector<std::string>(arg + 1, arg + narg));
  } catch (Interrupted &) {
    fputs("dump2vtk: interrupted, nothing is written\n", stderr);
    return 130;
  } catch (std::bad_alloc &) {
    message = "not enough memory for one snapshot or raster";
  } catch (std::exception &error) {
    message = error.what();
  }
  fprintf(stderr, "dump2vtk: %s\n", message.c_str());
  return 2;
}

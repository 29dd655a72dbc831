/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_OPTIONS_H
#define SLOPE_OPTIONS_H

#include <filesystem>
#include <string>
#include <vector>

namespace Slope {

extern const char HELP[];    // the text of --help

// The command line, checked
struct Options {
  std::vector<std::string> dumps, rasters, balls;
  std::string terrain, surface, deposit;
  std::filesystem::path out;    // without the ending of any file
  double dt = 0.0;              // 0: not given
  double run_dt = 0.0;          // of the deposit's summary, for dumps without a time
  double diameter = 0.0;
  bool single = false, skip = false;
};

// What is wrong is a std::runtime_error of one line
Options parse_options(const std::vector<std::string> &words);

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NUMBER_ROWS_H
#define SLOPE_NUMBER_ROWS_H

#include <string>
#include <vector>

namespace Slope {

// A line of a text file of numbers.
struct NumberRow {
  int line;                      // in the file, from 1
  bool apart;                    // after an empty line
  std::vector<double> values;    // finite
};

// Lines of count numbers each, with blanks, tabs or one comma between two of them; # starts a
// comment, empty lines do not count. names: what the numbers are, for messages: "t ax ay az".
// Errors are std::runtime_error with one line: file, line in it, rule, value.
std::vector<NumberRow> read_number_rows(const std::string &path, int count,
                                        const std::string &names);

}    // namespace Slope

#endif

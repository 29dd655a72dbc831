// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NUMBER_ROWS_H
#define SLOPE_NUMBER_ROWS_H

#include "table_head.h"

#include <functional>
#include <string>
#include <vector>

namespace Slope {

// A line of a text file of numbers.
struct NumberRow {
  int line;                      // in the file, from 1
  bool apart;                    // after an empty line
  std::vector<double> values;    // finite
};

// Lines of as many numbers as there are columns, with blanks, tabs or one comma between two of them; # starts
// a comment, empty lines do not count. Each is given to take. A comment above the first one that
// names other columns or units is an error. Errors are std::runtime_error with one line: file, line in it,
// rule, value.
void read_number_rows(const std::string &path, const TableColumns &columns,
                      const std::function<void(const NumberRow &)> &take);

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NUMBER_ROWS_H
#define SLOPE_NUMBER_ROWS_H

#include <functional>
#include <string>
#include <vector>

namespace Slope {

// The columns of a file that is read by position, and their units.
struct TableColumns {
  std::string letters;    // a letter each: t, x, y or z (also of an acceleration along it)
  std::string names;      // for messages: "t ax ay az"
  bool si;                // m, s and m/s2: those of a head must be the same; else they do not count
  double scale;    // factor on accelerations, which may be what makes m/s2 of those of the file
  std::string rule() const;    // "columns must be t ax ay az in s and m/s2"
};

// Whether a comment above the numbers names other columns, another order or other units. It names columns
// if it, or what follows its last colon, begins with as many names as there are columns, or has
// nothing but names and units: "t,ay,ax,az [gal]", "unit: ft". Anything else says nothing about them.
bool contradicts(const std::string &comment, const TableColumns &columns);

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

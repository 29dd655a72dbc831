// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Text files that users write, and what messages about them quote. No LAMMPS. */

#ifndef SLOPE_TEXT_FILE_H
#define SLOPE_TEXT_FILE_H

#include <stdexcept>
#include <string>

namespace Slope {

// The whole file without a mark of UTF-8. Errors are std::runtime_error: "cannot read PATH: reason".
std::string text_of(const std::string &path);

// the whole file as it is; errors alike
std::string bytes_of(const std::string &path);

// where the text begins: after a mark of UTF-8, if there is one
size_t text_start(const std::string &bytes);

// an error in a line: "PATH, line 7: what"
std::runtime_error line_error(const std::string &path, int line, const std::string &what);

// short and printable
std::string excerpt(const std::string &text);

// "1 ball", "2 balls"
std::string counted(double number, const std::string &what);

// a number to ten digits
std::string number_text(double value);

}    // namespace Slope

#endif

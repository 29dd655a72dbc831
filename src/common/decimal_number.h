// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DECIMAL_NUMBER_H
#define SLOPE_DECIMAL_NUMBER_H

#include <cmath>
#include <cstdlib>
#include <string>

namespace Slope {

// Whether a text is a decimal number as a whole, and finite: not 1.0.0, 1e, 0x10, inf or 1e999. LAMMPS' own
// is_double() takes whatever has the letters of a number, in some versions.
inline bool read_number(const std::string &text, double &value)
{
  if (text.empty() || text.find_first_not_of("0123456789+-.eE") != std::string::npos) return false;
  char *end;
  value = strtod(text.c_str(), &end);
  return *end == '\0' && std::isfinite(value);
}

}    // namespace Slope

#endif

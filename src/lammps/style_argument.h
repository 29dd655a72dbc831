/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_STYLE_ARGUMENT_H
#define SLOPE_STYLE_ARGUMENT_H

#include "decimal_number.h"

#include "error.h"
#include "lammps.h"

#include <cctype>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <string>

namespace LAMMPS_NS {

// Numbers among the arguments of a style. LAMMPS' own errors do not say which argument it was; here
// what names style and argument: "Fix deposit/grid cell".

inline double number_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  double value;
  if (!Slope::read_number(text, value))
    lmp->error->all(FLERR, "{} must be a finite number, got {}", what, text);
  return value;
}

inline int whole_number_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  char *end;
  errno = 0;
  const long value = strtol(text, &end, 10);
  const bool whole = *text && !isspace(static_cast<unsigned char>(*text)) && *end == '\0';
  if (!whole || errno != 0 || value > INT_MAX || value < INT_MIN)
    lmp->error->all(FLERR, "{} must be a whole number below 2^31, got {}", what, text);
  return (int) value;
}

// Coordinates beyond it are mistakes: places closer to each other than 1e-4 would be one there.
static constexpr double FARTHEST = 1.0e12;

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_STYLE_ARGUMENT_H
#define SLOPE_STYLE_ARGUMENT_H

#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <cerrno>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

namespace LAMMPS_NS {

// Numbers among the arguments of a style. LAMMPS' own errors do not say which argument it was; here
// what names style and argument: "Fix deposit/grid cell".

inline double number_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  const double value = utils::is_double(text) ? strtod(text, nullptr) : HUGE_VAL;
  if (!std::isfinite(value))    // 1e999, too
    lmp->error->all(FLERR, "{} must be a finite number, got {}", what, text);
  return value;
}

inline int whole_number_argument(LAMMPS *lmp, const std::string &what, const char *text)
{
  errno = 0;
  const long value = utils::is_integer(text) ? strtol(text, nullptr, 10) : LONG_MAX;
  if (errno != 0 || value > INT_MAX || value < INT_MIN)
    lmp->error->all(FLERR, "{} must be a whole number below 2^31, got {}", what, text);
  return (int) value;
}

// Coordinates beyond it are mistakes: places closer to each other than 1e-4 would be one there.
static constexpr double FARTHEST = 1.0e12;

// A keyword that every region has, with its values: how many words. LAMMPS says no more than "Illegal
// region command" of a wrong one. caller: "Region terrain"; own: its other keywords, for the message.
// Coordinates are in distance units, a lattice does not scale them.
inline int region_keyword(LAMMPS *lmp, const std::string &caller, const std::string &own, int narg,
                          char **arg)
{
  static const std::map<std::string, int> nvalues = {
      {"side", 1}, {"units", 1}, {"open", 1}, {"move", 3}, {"rotate", 7}};
  Error *error = lmp->error;
  const std::string keyword = arg[0];
  const auto known = nvalues.find(keyword);
  if (known == nvalues.end())
    error->all(FLERR, "{}: unknown keyword {}, must be {}side, units, move or rotate", caller,
               keyword, own);
  const int n = known->second;
  if (n >= narg)
    error->all(FLERR, "{} {} must be followed by {} value{}, got {}", caller, keyword, n,
               n > 1 ? "s" : "", narg - 1);

  const std::string value = arg[1];
  if (keyword == "open") error->all(FLERR, "{} cannot have open faces", caller);
  if (keyword == "units" && value != "box")
    error->all(FLERR, "{} units must be box, got {}", caller, value);
  if (keyword == "side" && value != "in" && value != "out")
    error->all(FLERR, "{} side must be in or out, got {}", caller, value);
  const bool moves = keyword == "move";
  for (int k = 1; k <= (moves ? 3 : keyword == "rotate" ? 1 : 0); k++)
    if (strncmp(arg[k], "v_", 2) != 0 && !(moves && strcmp(arg[k], "NULL") == 0))
      error->all(FLERR, "{} {} must be v_name{}, got {}", caller, keyword, moves ? " or NULL" : "",
                 arg[k]);
  if (keyword == "rotate")
    for (int k = 2; k <= 7; k++) number_argument(lmp, caller + " rotate", arg[k]);
  return 1 + n;
}

}    // namespace LAMMPS_NS

#endif

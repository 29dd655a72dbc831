/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NUMBERS_H
#define SLOPE_NUMBERS_H

#include <string>
#include <string_view>

namespace Slope {

// The number that is the whole of a word; false if it is not one. "nan" and "inf" are numbers.
bool to_number(std::string_view word, double &value);

// With 15 digits: step * dt is 3.024 and not 3.0239999999999996
std::string to_text(double value);

}    // namespace Slope

#endif

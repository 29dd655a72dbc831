/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "numbers.h"

#include <charconv>
#include <cstdlib>

using namespace Slope;

/* ---------------------------------------------------------------------- */

bool Slope::to_number(std::string_view word, double &value)
{
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const char *stop = word.data() + word.size();
  const auto result = std::from_chars(word.data(), stop, value);
  if (result.ptr != stop || word.empty()) return false;
  if (result.ec == std::errc()) return true;
  if (result.ec != std::errc::result_out_of_range) return false;

  // from_chars gives no value for 1e-320 or 1e400, strtod does

  value = strtod(std::string(word).c_str(), nullptr);
  return true;
}

/* ---------------------------------------------------------------------- */

std::string Slope::to_text(double value)
{
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value, std::chars_format::general, 15);
  return std::string(text, end.ptr);
}

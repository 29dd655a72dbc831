// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_YAML_TEXT_H
#define SLOPE_YAML_TEXT_H

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace Slope {
namespace yaml {

// A number that is no count has a point in it, or YAML would read 1e-05 as text; null if there is none.
inline std::string real(double value)
{
  if (!std::isfinite(value)) return "null";
  char number[40];
  snprintf(number, sizeof(number), "%.15g", value);
  std::string text = number;
  if (text.find('.') != std::string::npos) return text;
  return text.insert(std::min(text.find('e'), text.size()), ".0");
}

inline std::string count(double value)
{
  char number[40];
  snprintf(number, sizeof(number), "%.0f", value);
  return number;
}

inline std::string quoted(const std::string &text)
{
  std::string inner;
  for (const char c : text) inner += c == '\'' ? "''" : std::string(1, c);
  return "'" + inner + "'";
}

inline void line(std::string &s, const std::string &key, const std::string &value)
{
  s += key + ": " + value + "\n";
}

}    // namespace yaml
}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Names of styles, of which LAMMPS has accelerated variants with a suffix: gravity, gravity/omp,
   gravity/kk/device and our own gravity/slope are one style. No LAMMPS. */

#ifndef SLOPE_STYLE_NAME_H
#define SLOPE_STYLE_NAME_H

#include <string>

namespace Slope {

// the name without the suffix of an accelerated variant: LAMMPS' suffixes, and ours
inline std::string plain_style(const std::string &style)
{
  for (const std::string suffix :
       {"/kk/device", "/kk/host", "/kk", "/gpu", "/intel", "/omp", "/opt", "/slope"})
    if (style.size() > suffix.size() &&
        style.compare(style.size() - suffix.size(), suffix.size(), suffix) == 0)
      return style.substr(0, style.size() - suffix.size());
  return style;
}

// whether it is the plain style, or an accelerated variant of it
inline bool is_style(const std::string &style, const std::string &plain)
{
  return plain_style(style) == plain;
}

}    // namespace Slope

#endif

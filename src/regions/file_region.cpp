/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "file_region.h"

#include "error.h"
#include "style_argument.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

static int defined = 0;    // regions so far

/* ---------------------------------------------------------------------- */

FileRegion::FileRegion(LAMMPS *lmp, int narg, char **arg, const std::vector<std::string> &own) :
    Region(lmp, narg, arg), number(++defined), caller("Region " + std::string(arg[1]))
{
  if (narg < 3) error->all(FLERR, "{}: file name is missing", caller);
  std::string names;
  for (const std::string &keyword : own) names += keyword + ", ";

  // own keywords are taken here, those of every region are checked and passed on

  char units[] = "units", box[] = "box";
  std::vector<char *> rest = {units, box};
  for (int iarg = 3, n; iarg < narg; iarg += n) {
    if (std::find(own.begin(), own.end(), arg[iarg]) == own.end()) {
      n = check_keyword(names, narg - iarg, &arg[iarg]);
      rest.insert(rest.end(), &arg[iarg], &arg[iarg] + n);
      continue;
    }
    const std::string what = caller + " " + arg[iarg];
    if (iarg + 1 >= narg) error->all(FLERR, "{}: value is missing", what);
    const double value = number_argument(lmp, what, arg[iarg + 1]);
    if (!(value > 0.0)) error->all(FLERR, "{} must be > 0, got {:.15g}", what, value);
    values[arg[iarg]] = value;
    n = 2;
  }
  options(static_cast<int>(rest.size()), rest.data());
  cmax = tmax = 0;
}

double FileRegion::given(const std::string &keyword, double otherwise) const
{
  const auto found = values.find(keyword);
  return found == values.end() ? otherwise : found->second;
}

/* ----------------------------------------------------------------------
   A keyword that every region has, with its values: how many words. LAMMPS says no more than "Illegal
   region command" of a wrong one. own: other keywords, for the message. Coordinates are in distance
   units, a lattice does not scale them.
------------------------------------------------------------------------- */

int FileRegion::check_keyword(const std::string &own, int narg, char **arg) const
{
  static const std::map<std::string, int> nvalues = {
      {"side", 1}, {"units", 1}, {"open", 1}, {"move", 3}, {"rotate", 7}};
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

/* ---------------------------------------------------------------------- */

int FileRegion::no_contacts()
{
  error->one(FLERR, "{} {} makes no wall: take fix wall/gran/balls or fix wall/gran/mesh", caller,
             id);
  return 0;
}

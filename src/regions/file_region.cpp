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
  // own keywords are taken here, those of every region are checked and passed on

  char units[] = "units", box[] = "box";
  std::vector<char *> rest = {units, box};
  for (KeywordReader word(lmp, caller, narg - 3, arg + 3); word.next();) {
    const auto is_it = [&](const std::string &keyword) {
      return word.is(keyword, "H");
    };
    if (std::any_of(own.begin(), own.end(), is_it)) {
      values[*word.begin()] = word.positive();
    } else {
      check_keyword(word);
      rest.insert(rest.end(), word.begin(), word.end());
    }
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
   A keyword that every region has: LAMMPS says no more than "Illegal region command" of a wrong one.
   Coordinates are in distance units, a lattice does not scale them.
------------------------------------------------------------------------- */

void FileRegion::check_keyword(KeywordReader &word) const
{
  const auto is_variable = [&](int k) {
    return strncmp(word.text(k), "v_", 2) == 0;
  };
  if (word.is("side", "in|out"))
    word.choice({"in", "out"});
  else if (word.is("units", "box"))
    word.choice({"box"});
  else if (word.is("move", "v_x v_y v_z"))
    for (int k = 1; k <= 3; k++)
      word.must(is_variable(k) || strcmp(word.text(k), "NULL") == 0, "v_name or NULL", k);
  else if (word.is("rotate", "v_theta Px Py Pz Rx Ry Rz")) {
    word.must(is_variable(1), "v_name", 1);
    for (int k = 2; k <= 7; k++) word.number(k);
  } else if (*word.begin() == std::string("open"))
    error->all(FLERR, "{} cannot have open faces", caller);
  else
    word.unknown();
}

/* ---------------------------------------------------------------------- */

int FileRegion::no_contacts()
{
  error->one(FLERR, "{} {} makes no wall: take fix wall/gran/balls or fix wall/gran/mesh", caller,
             id);
  return 0;
}

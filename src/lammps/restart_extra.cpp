/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "restart_extra.h"

#include "atom.h"
#include "rank_zero.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

const double *RestartExtra::find(int i, int nth, int fixed, int each)
{
  const double *at = atom->extra[i], *const end = at + atom->nextra_store;
  auto whole = [end](const double *number, double least) {
    return number < end && *number >= least && *number <= end - number &&
        *number == std::floor(*number);
  };
  for (int k = 0; k < nth; k++) {
    if (!whole(at, 1.0)) return reject(i, at < end ? *at : 0.0);
    at += static_cast<int>(*at);
  }
  if (!whole(at, fixed)) return reject(i, at < end ? *at : 0.0);
  if (!whole(at + 1, 0.0) || at[0] != fixed + at[1] * each) return reject(i, at[1]);
  return at;
}

/* ---------------------------------------------------------------------- */

const double *RestartExtra::reject(int i, double number)
{
  ball = std::max<tagint>(atom->tag[i], 1);    // of a damaged file, too
  wrong = number;
  return nullptr;
}

/* ---------------------------------------------------------------------- */

void RestartExtra::check(const std::string &caller) const
{
  const std::string problem = fmt::format(
      "the contacts of ball {} in the restart file must have a whole number of values that fits in "
      "it, got {:g}: the file is damaged, take an earlier one",
      ball, wrong);
  end_if_any(lmp, caller, ball ? problem : "");
}

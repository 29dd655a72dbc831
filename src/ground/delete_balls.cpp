/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "delete_balls.h"

#include "atom.h"
#include "comm.h"
#include "constants.h"
#include "domain.h"
#include "error.h"
#include "fix_wall_gran_balls.h"
#include "group.h"
#include "input.h"
#include "lammps_compat.h"
#include "style_argument.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr const char *MARKED = "delete_balls_marked";
static constexpr double MUCH = 0.2;    // share of the volume, to be warned of

/* ----------------------------------------------------------------------
   delete_balls GROUP overlap FRACTION
   removes the balls that overlap fixed balls of any fix wall/gran/balls by more than
   FRACTION of the ball's radius
------------------------------------------------------------------------- */

void DeleteBalls::command(int narg, char **arg)
{
  if (!domain->box_exist) error->all(FLERR, "Delete_balls before the simulation box is defined");
  if (narg != 3)
    error->all(FLERR, "Delete_balls needs GROUP overlap FRACTION, got {} arguments", narg);
  if (strcmp(arg[1], "overlap") != 0)
    error->all(FLERR, "Delete_balls keyword must be overlap, got {}", arg[1]);
  if (group->find(arg[0]) < 0) error->all(FLERR, "Delete_balls group must exist, got {}", arg[0]);
  const std::string name = arg[0];    // arg does not outlive the commands that we issue
  const double fraction = number_argument(lmp, "Delete_balls overlap", arg[2]);
  if (!(fraction >= 0.0 && fraction < 1.0))
    error->all(FLERR, "Delete_balls overlap must be >= 0 and < 1 (of the radius), got {}", arg[2]);
  if (!atom->radius_flag)
    error->all(FLERR, "Delete_balls requires balls: atom_style must be sphere, got {}",
               atom->atom_style);

  const auto walls = compat::fixes_of_style(lmp, "wall/gran/balls");
  if (walls.empty())
    error->all(FLERR, "Delete_balls requires a fix wall/gran/balls before it, there is none");

  // mark them by a group, and let LAMMPS delete the group

  group->find_or_create(MARKED);
  const int marked = compat::group_bit(lmp, MARKED), groupbit = compat::group_bit(lmp, name);
  double mine[4] = {0.0, 0.0, 0.0, 0.0}, all[4];    // marked, left, their volumes
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double r = atom->radius[i];
    double deepest = 0.0;
    for (Fix *fix : walls)
      deepest =
          std::fmax(deepest, static_cast<FixWallGranBalls *>(fix)->deepest_overlap(atom->x[i], r));
    if (deepest > fraction * r) {
      atom->mask[i] |= marked;
      mine[0] += 1.0;
      mine[2] += 4.0 / 3.0 * Slope::PI * r * r * r;
    } else {
      mine[1] += 1.0;
      mine[3] += 4.0 / 3.0 * Slope::PI * r * r * r;
    }
  }
  MPI_Allreduce(mine, all, 4, MPI_DOUBLE, MPI_SUM, world);

  if (all[0] > 0.0) input->one(fmt::format("delete_atoms group {} compress no", MARKED));
  input->one(fmt::format("group {} delete", MARKED));

  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Delete_balls: {:.0f} balls of group {} removed that overlapped fixed balls by "
                   "more than {:g} of their radius: {:.6g} m3 of balls; {:.0f} balls left\n",
                   all[0], name, fraction, all[2], all[1]);
  if (all[1] == 0.0) error->all(FLERR, "Delete_balls: no ball of group {} is left", name);
  const double share = all[2] / (all[2] + all[3]);
  if (share > MUCH && comm->me == 0)
    error->warning(
        FLERR,
        "Delete_balls: {:.0f} % of the volume of group {} is removed: smaller balls lose "
        "less",
        100.0 * share, name);
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The fixed balls of fix wall/gran/balls as atoms: to hold the fix against frozen atoms, and
   for whatever needs atoms. Atoms are made as create_atoms makes them. */

#include "create_balls.h"

#include "atom.h"
#include "atom_vec.h"
#include "ball_placement.h"
#include "constants.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "modify.h"
#include "style_argument.h"

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   create_balls TYPE DIAMETER DENSITY surface|file ...
------------------------------------------------------------------------- */

void CreateBalls::command(int narg, char **arg)
{
  if (!domain->box_exist) error->all(FLERR, "Create_balls before the simulation box is defined");
  if (domain->dimension != 3)
    error->all(FLERR, "Create_balls dimension must be 3, got {}", domain->dimension);
  if (modify->nfix_restart_peratom)
    error->all(FLERR,
               "Create_balls cannot follow a restart file with per-atom info of a fix "
               "before that fix is defined");
  if (!atom->radius_flag || !atom->rmass_flag)
    error->all(FLERR,
               "Create_balls atom_style must have radius and mass per atom, as sphere has, "
               "got {}",
               atom->atom_style);

  if (narg < 4)
    error->all(FLERR,
               "Create_balls needs TYPE DIAMETER DENSITY and surface or file, got {} "
               "arguments",
               narg);
  const int type = whole_number_argument(lmp, "Create_balls type", arg[0]);
  const double diameter = number_argument(lmp, "Create_balls diameter", arg[1]);
  const double density = number_argument(lmp, "Create_balls density", arg[2]);
  if (type < 1 || type > atom->ntypes)
    error->all(FLERR, "Create_balls type must be 1 to {} (the atom types of the box), got {}",
               atom->ntypes, arg[0]);
  if (!(diameter > 0.0)) error->all(FLERR, "Create_balls diameter must be > 0, got {}", arg[1]);
  if (!(density > 0.0)) error->all(FLERR, "Create_balls density must be > 0, got {}", arg[2]);

  const double smallest = BallPlacement::smallest_ball(lmp, group->bitmask[0]);
  BallPlacement placement(lmp, "Create_balls", diameter, smallest, narg - 3, &arg[3]);
  std::vector<double> xyz;
  for (const Slope::PlacedBall &b : placement.all()) xyz.insert(xyz.end(), {b.x, b.y, b.z});
  into_box(xyz);

  // the ghosts are overwritten by the new atoms, as at the start of Comm::exchange()

  atom->nghost = 0;
  atom->avec->clear_bonus();

  const int nlocal_previous = atom->nlocal;
  const bigint natoms_previous = atom->natoms;
  for (size_t k = 0; k < xyz.size(); k += 3)
    if (mine(&xyz[k])) atom->avec->create_atom(type, &xyz[k]);
  for (int i = nlocal_previous; i < atom->nlocal; i++) {
    atom->radius[i] = 0.5 * diameter;
    atom->rmass[i] = density * Slope::PI / 6.0 * diameter * diameter * diameter;
  }
  atom->data_fix_compute_variable(nlocal_previous, atom->nlocal);

  bigint nlocal = atom->nlocal;
  MPI_Allreduce(&nlocal, &atom->natoms, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  const bigint created = atom->natoms - natoms_previous, placed = xyz.size() / 3;
  if (created != placed)
    error->all(FLERR, "Create_balls must create every ball once, got {} atoms for {} balls",
               created, placed);
  if (atom->natoms < 0 || atom->natoms >= MAXBIGINT) error->all(FLERR, "Too many total atoms");

  if (atom->tag_enable) atom->tag_extend();
  atom->tag_check();
  if (atom->map_style != Atom::MAP_NONE) {
    atom->map_init();
    atom->map_set();
  }
}

/* ----------------------------------------------------------------------
   wrap the balls into a periodic box; in the other directions they must be in it
   all ranks hold all balls and find the same
------------------------------------------------------------------------- */

void CreateBalls::into_box(std::vector<double> &xyz) const
{
  const double *lo = domain->triclinic ? domain->boxlo_lamda : domain->boxlo;
  const double *hi = domain->triclinic ? domain->boxhi_lamda : domain->boxhi;

  bigint outside = 0;
  double first[3] = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < xyz.size(); k += 3) {
    double *x = &xyz[k], lamda[3];
    domain->remap(x);
    const double *coord = x;
    if (domain->triclinic) {
      domain->x2lamda(x, lamda);
      coord = lamda;
    }
    for (int d = 0; d < 3; d++)
      if (!domain->periodicity[d] && !(coord[d] >= lo[d] && coord[d] < hi[d])) {
        if (outside++ == 0)
          for (int e = 0; e < 3; e++) first[e] = x[e];
        break;
      }
  }
  if (outside)
    error->all(FLERR,
               "Create_balls balls must lie in the simulation box (below its upper faces), "
               "got {} of {} outside, the first at {} {} {}",
               outside, xyz.size() / 3, first[0], first[1], first[2]);
}

/* ----------------------------------------------------------------------
   is a ball in the box in the sub-domain of this rank
------------------------------------------------------------------------- */

bool CreateBalls::mine(const double *x) const
{
  if (!domain->triclinic) {
    for (int d = 0; d < 3; d++)
      if (!(x[d] >= domain->sublo[d] && x[d] < domain->subhi[d])) return false;
    return true;
  }

  double position[3] = {x[0], x[1], x[2]}, lamda[3];
  domain->x2lamda(position, lamda);
  for (int d = 0; d < 3; d++) {
    // the wrapping in real coordinates may be off by round-off
    if (domain->periodicity[d] && (lamda[d] < 0.0 || lamda[d] >= 1.0)) lamda[d] = 0.0;
    if (!(lamda[d] >= domain->sublo_lamda[d] && lamda[d] < domain->subhi_lamda[d])) return false;
  }
  return true;
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Balls as atoms, made as create_atoms makes them: the fixed balls of fix wall/gran/balls, to hold the fix
   against frozen atoms and for whatever needs atoms; or a disordered packing that fills a region. */

#include "create_balls.h"

#include "atom.h"
#include "atom_vec.h"
#include "ball_packing.h"
#include "ball_placement.h"
#include "comm.h"
#include "constants.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "lammps_compat.h"
#include "region.h"
#include "style_argument.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr double MOST_PLACES = 1.0e11;    // of a packing that are looked at

/* ----------------------------------------------------------------------
   create_balls TYPE DIAMETER DENSITY surface|file|fill ...
------------------------------------------------------------------------- */

void CreateBalls::command(int narg, char **arg)
{
  check_box();
  if (narg < 4)
    error->all(FLERR,
               "Create_balls needs TYPE DIAMETER DENSITY and surface, file or fill, got {} "
               "arguments",
               narg);
  const int type = atom_type_argument(lmp, "Create_balls type", arg[0]);
  const double diameter = positive_argument(lmp, "Create_balls diameter", arg[1]);
  const double density = positive_argument(lmp, "Create_balls density", arg[2]);

  const bool filling = strcmp(arg[3], "fill") == 0;
  std::vector<double> xyz;    // of this rank
  const bigint placed = filling ? fill(diameter, narg - 4, &arg[4], xyz)
                                : place(diameter, narg - 3, &arg[3], xyz);

  // the ghosts are overwritten by the new atoms, as at the start of Comm::exchange()

  atom->nghost = 0;
  atom->avec->clear_bonus();

  const int nlocal_previous = atom->nlocal;
  const bigint natoms_previous = atom->natoms;
  for (size_t k = 0; k < xyz.size(); k += 3) atom->avec->create_atom(type, &xyz[k]);
  for (int i = nlocal_previous; i < atom->nlocal; i++) {
    atom->radius[i] = 0.5 * diameter;
    atom->rmass[i] = density * Slope::PI / 6.0 * diameter * diameter * diameter;
  }
  atom->data_fix_compute_variable(nlocal_previous, atom->nlocal);

  bigint nlocal = atom->nlocal;
  MPI_Allreduce(&nlocal, &atom->natoms, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  const bigint created = atom->natoms - natoms_previous;
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

/* ---------------------------------------------------------------------- */

void CreateBalls::check_box() const
{
  if (!domain->box_exist) error->all(FLERR, "Create_balls before the simulation box is defined");
  if (domain->dimension != 3)
    error->all(FLERR, "Create_balls dimension must be 3, got {}", domain->dimension);
  if (compat::balls_wait_for_fixes(lmp))
    error->all(FLERR,
               "Create_balls cannot follow a restart file with per-atom info of a fix "
               "before that fix is defined");
  if (!atom->radius_flag || !atom->rmass_flag)
    error->all(FLERR,
               "Create_balls atom_style must have radius and mass per atom, as sphere has, "
               "got {}",
               atom->atom_style);
}

/* ----------------------------------------------------------------------
   surface ... or file ...: the balls of fix wall/gran/balls; returns how many all ranks have
------------------------------------------------------------------------- */

bigint CreateBalls::place(double diameter, int narg, char **arg, std::vector<double> &xyz) const
{
  const double smallest = BallPlacement::smallest_ball(lmp, compat::group_bit(lmp, "all"));
  BallPlacement placement(lmp, "Create_balls", diameter, smallest, narg, arg);
  std::vector<double> all;
  for (const Slope::PlacedBall &b : placement.all()) all.insert(all.end(), {b.x, b.y, b.z});
  into_box(all);
  for (size_t k = 0; k < all.size(); k += 3)
    if (mine(&all[k])) xyz.insert(xyz.end(), &all[k], &all[k] + 3);
  return all.size() / 3;
}

/* ----------------------------------------------------------------------
   fill REGION [seed N]: each rank places what is in its sub-domain; half a diameter off periodic faces,
   as a packing does not fit itself beyond them; returns how many all ranks have
------------------------------------------------------------------------- */

bigint CreateBalls::fill(double diameter, int narg, char **arg, std::vector<double> &xyz) const
{
  if (narg < 1)
    error->all(FLERR, "Create_balls fill must be followed by REGION [seed N], got no words");
  int seed = 1;
  for (KeywordReader word(lmp, "Create_balls fill", narg - 1, arg + 1); word.next();) {
    if (!word.is("seed", "N")) word.unknown();
    seed = word.whole_number();
    word.must(seed >= 1, "> 0");
  }
  Region *region = region_argument(lmp, "Create_balls fill", arg[0]);

  const Slope::BallPacking packing(diameter, seed);
  double lo[3], hi[3], share[3];
  bounds(region, lo, hi);
  double mine_has = packing.expected((hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]));
  double places;
  MPI_Allreduce(&mine_has, &places, 1, MPI_DOUBLE, MPI_SUM, world);
  if (!(places <= MOST_PLACES))
    error->all(FLERR,
               "Create_balls fill diameter must be so large that the box around region {} has room "
               "for at most {:g} balls, got {:.3g} with {:g}",
               arg[0], MOST_PLACES, places, diameter);
  half_a_ball(diameter, share);
  region->prematch();
  packing.visit(lo, hi, [&](const double *x) {
    double lamda[3], at[3] = {x[0], x[1], x[2]};
    if (!mine(x)) return;
    domain->x2lamda(at, lamda);
    for (int d = 0; d < 3; d++)
      if (domain->periodicity[d] && (lamda[d] < share[d] || lamda[d] > 1.0 - share[d])) return;
    if (region->match(x[0], x[1], x[2])) xyz.insert(xyz.end(), x, x + 3);
  });

  bigint n = xyz.size() / 3, all;
  MPI_Allreduce(&n, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all == 0)
    error->all(FLERR,
               "Create_balls fill region {} must have room for a ball of diameter {}: "
               "smaller ones",
               arg[0], diameter);
  if (comm->me == 0)
    utils::logmesg(lmp, "Create_balls: {} balls of diameter {:g} fill region {}, packing {}\n", all,
                   diameter, arg[0], seed);
  return all;
}

// where a region may be on this rank

void CreateBalls::bounds(const Region *region, double lo[3], double hi[3]) const
{
  if (domain->triclinic)
    domain->bbox(domain->sublo_lamda, domain->subhi_lamda, lo, hi);
  else
    for (int d = 0; d < 3; d++) {
      lo[d] = domain->sublo[d];
      hi[d] = domain->subhi[d];
    }
  if (!region->bboxflag) return;
  const double from[3] = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
  const double to[3] = {region->extent_xhi, region->extent_yhi, region->extent_zhi};
  for (int d = 0; d < 3; d++) {
    lo[d] = std::max(lo[d], from[d]);
    hi[d] = std::max(lo[d], std::min(hi[d], to[d]));
  }
}

// half a diameter as a share of the box along each axis

void CreateBalls::half_a_ball(double diameter, double share[3]) const
{
  const double *h = domain->h_inv;    // rows: h[0] h[5] h[4], h[1] h[3], h[2]
  const double per_length[3] = {std::sqrt(h[0] * h[0] + h[5] * h[5] + h[4] * h[4]),
                                std::sqrt(h[1] * h[1] + h[3] * h[3]), h[2]};
  for (int d = 0; d < 3; d++) share[d] = 0.5 * diameter * per_length[d];
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

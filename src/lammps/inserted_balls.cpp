/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "inserted_balls.h"

#include "constants.h"
#include "lammps_compat.h"

#include "atom.h"
#include "fix.h"
#include "molecule.h"

using namespace LAMMPS_NS;

static double ball_of(double radius, double density)
{
  return 4.0 / 3.0 * Slope::PI * radius * radius * radius * density;
}

/* ----------------------------------------------------------------------
   as Atom::add_molecule_atom() makes them
------------------------------------------------------------------------- */

static void add_molecule(std::vector<InsertedBalls> &found, const compat::Insertion &its, int mask,
                         const Molecule &m)
{
  for (int i = 0; i < m.natoms; i++) {
    const double radius = m.radiusflag ? m.radius[i] : its.radius_lo;
    const double mass = m.rmassflag ? m.rmass[i] : ball_of(radius, its.density_lo);
    const int type = its.type + (m.typeflag ? m.type[i] : 0);
    found.push_back({type, mask, mass, mass, radius, radius});
  }
}

// the largest radius of each type is all that a fix tells of itself

static void add_unseen(std::vector<InsertedBalls> &found, int ntypes, int mask, Fix *fix)
{
  for (int t = 1; t <= ntypes; t++) {
    int type = t;
    const auto radius = static_cast<const double *>(fix->extract("radius", type));
    if (radius && *radius > 0.0) found.push_back({t, mask, 0.0, 0.0, *radius, *radius});
  }
}

/* ---------------------------------------------------------------------- */

std::vector<InsertedBalls> LAMMPS_NS::inserted_balls(LAMMPS *lmp)
{
  std::vector<InsertedBalls> found;
  for (const char *style : {"pour", "deposit"})
    for (Fix *fix : compat::fixes_of_style(lmp, style)) {
      const int mask = 1 | fix->groupbit;
      compat::Insertion its;
      if (!compat::insertion(fix, its))
        add_unseen(found, lmp->atom->ntypes, mask, fix);
      else if (its.molecules.empty())
        found.push_back({its.type, mask, ball_of(its.radius_lo, its.density_lo),
                         ball_of(its.radius_hi, its.density_hi), its.radius_lo, its.radius_hi});
      for (const Molecule *molecule : its.molecules) add_molecule(found, its, mask, *molecule);
    }
  return found;
}

/* ---------------------------------------------------------------------- */

bigint LAMMPS_NS::balls_beside_empty(LAMMPS *lmp, int groupbit,
                                     const std::function<bool(int)> &meant)
{
  int frozen = 0;
  for (const Fix *fix : compat::fixes_of_style(lmp, "freeze")) frozen |= fix->groupbit;
  const Atom *atom = lmp->atom;
  bigint mine[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    if (atom->mask[i] & groupbit) mine[0]++;
    if (!(atom->mask[i] & frozen) && meant(i)) mine[1]++;
  }
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
  if (all[0]) return 0;
  for (const InsertedBalls &balls : inserted_balls(lmp))
    if (balls.mask & groupbit) return 0;
  return all[1];
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "inserted_balls.h"

#include "constants.h"
#include "lammps_compat.h"

#include "fix_deposit.h"
#include "fix_pour.h"
#include "molecule.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace LAMMPS_NS {
namespace compat {
typedef double *Numbers;
typedef Molecule **Molecules;
SLOPE_REVEAL(FixPour, int, ntype)
SLOPE_REVEAL(FixPour, int, mode)
SLOPE_REVEAL(FixPour, int, dstyle)
SLOPE_REVEAL(FixPour, int, npoly)
SLOPE_REVEAL(FixPour, double, radius_one)
SLOPE_REVEAL(FixPour, double, radius_lo)
SLOPE_REVEAL(FixPour, double, radius_hi)
SLOPE_REVEAL(FixPour, Numbers, radius_poly)
SLOPE_REVEAL(FixPour, double, density_lo)
SLOPE_REVEAL(FixPour, double, density_hi)
SLOPE_REVEAL(FixPour, Molecules, onemols)
SLOPE_REVEAL(FixPour, int, nmol)
SLOPE_REVEAL(FixDeposit, int, ntype)
SLOPE_REVEAL(FixDeposit, int, mode)
SLOPE_REVEAL(FixDeposit, Molecules, onemols)
SLOPE_REVEAL(FixDeposit, int, nmol)
}    // namespace compat
}    // namespace LAMMPS_NS

enum { ATOM, MOLECULE };      // mode, in both fixes
enum { ONE, RANGE, POLY };    // dstyle

static constexpr double RADIUS = 0.5, DENSITY = 1.0;    // of LAMMPS, where nothing else is said

static double ball_of(double radius, double density)
{
  return 4.0 / 3.0 * Slope::PI * radius * radius * radius * density;
}

/* ---------------------------------------------------------------------- */

static void add(std::vector<InsertedBalls> &found, int type, int mask, double radius_lo,
                double radius_hi, double density_lo, double density_hi)
{
  found.push_back({type, mask, ball_of(radius_lo, density_lo), ball_of(radius_hi, density_hi),
                   radius_lo, radius_hi});
}

// as Atom::add_molecule_atom() makes them

static void add(std::vector<InsertedBalls> &found, int first_type, int mask, int number,
                Molecule **molecules)
{
  for (int k = 0; k < number; k++)
    for (int i = 0; i < molecules[k]->natoms; i++) {
      const Molecule &m = *molecules[k];
      const double radius = m.radiusflag ? m.radius[i] : RADIUS;
      const double mass = m.rmassflag ? m.rmass[i] : ball_of(radius, DENSITY);
      const int type = first_type + (m.typeflag ? m.type[i] : 0);
      found.push_back({type, mask, mass, mass, radius, radius});
    }
}

/* ---------------------------------------------------------------------- */

static void add(std::vector<InsertedBalls> &found, FixPour *fix)
{
  using namespace compat;
  const int type = fix->*reveal(FixPour_ntype()), mask = 1 | fix->groupbit;
  if (fix->*reveal(FixPour_mode()) == MOLECULE)
    return add(found, type, mask, fix->*reveal(FixPour_nmol()), fix->*reveal(FixPour_onemols()));
  const int sizes = fix->*reveal(FixPour_dstyle());
  double lo = fix->*reveal(FixPour_radius_one()), hi = lo;
  if (sizes == RANGE) {
    lo = fix->*reveal(FixPour_radius_lo());
    hi = fix->*reveal(FixPour_radius_hi());
  } else if (sizes == POLY) {
    const double *radii = fix->*reveal(FixPour_radius_poly());
    const auto ends = std::minmax_element(radii, radii + fix->*reveal(FixPour_npoly()));
    lo = *ends.first;
    hi = *ends.second;
  }
  add(found, type, mask, lo, hi, fix->*reveal(FixPour_density_lo()),
      fix->*reveal(FixPour_density_hi()));
}

static void add(std::vector<InsertedBalls> &found, FixDeposit *fix)
{
  using namespace compat;
  const int type = fix->*reveal(FixDeposit_ntype()), mask = 1 | fix->groupbit;
  if (fix->*reveal(FixDeposit_mode()) == MOLECULE)
    add(found, type, mask, fix->*reveal(FixDeposit_nmol()), fix->*reveal(FixDeposit_onemols()));
  else
    add(found, type, mask, RADIUS, RADIUS, DENSITY, DENSITY);
}

/* ---------------------------------------------------------------------- */

std::vector<InsertedBalls> LAMMPS_NS::inserted_balls(LAMMPS *lmp)
{
  std::vector<InsertedBalls> found;
  for (Fix *fix : compat::fixes_of_style(lmp, "pour")) add(found, static_cast<FixPour *>(fix));
  for (Fix *fix : compat::fixes_of_style(lmp, "deposit"))
    add(found, static_cast<FixDeposit *>(fix));
  return found;
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What differs between the LAMMPS versions that the package supports, and all that the package knows of LAMMPS' insides:
   its lists of fixes and groups, and members that are not public. With its .cpp the only file that may ask for the version.
   Written for the interfaces of 13Nov2026, tested with 29Sep2021 to 4Jul2026. */

#ifndef SLOPE_LAMMPS_COMPAT_H
#define SLOPE_LAMMPS_COMPAT_H

#include "fix.h"
#include "region.h"
#include "style_name.h"

#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class Comm;
class Molecule;
class Neighbor;
class Pair;

namespace compat {

// region by its ID, nullptr if there is none; all of them, in any order; those that an intersection or a union is made of
Region *find_region(LAMMPS *, const std::string &id);
std::vector<Region *> regions(LAMMPS *);
std::vector<Region *> parts_of(LAMMPS *, Region *);

// Fixes in the order of the deck, without one that is just being replaced; those of one style, accelerated variants of it
// included. By its ID, nullptr if there is none; when LAMMPS calls it, see FixConst. Ended as unfix does, if there is one.
std::vector<Fix *> fixes(LAMMPS *);
std::vector<Fix *> fixes_of_style(LAMMPS *, const std::string &style);
Fix *fix_by_id(LAMMPS *, const std::string &id);
int mask_of(LAMMPS *, const Fix *);
void drop_fix(LAMMPS *, const std::string &id);

// bit of a group that exists, in the masks of atoms
int group_bit(LAMMPS *, const std::string &group);

// Fixes, by ID and style, that have something in the restart file that was read and were not there to take it; and whether
// there still are balls' numbers that wait for one.
std::vector<std::pair<std::string, std::string>> left_in_restart(LAMMPS *);
bool balls_wait_for_fixes(LAMMPS *);

// half neighbor list of touching spheres with contact history
void request_history_list(Neighbor *, Pair *, int instance);

// neighbor lists of spheres leave out bonded pairs whose factor in special_bonds is 0; before 2022 they
// are as those of all others, whatever special_bonds says
static constexpr bool LISTS_OF_SPHERES_KNOW_BONDS = SLOPE_LAMMPS_VERSION >= 20220623;

// values of ghost atoms from, and to, those that own them, by the style's pack and unpack
void forward_comm(Comm *, Pair *);
void forward_comm(Comm *, Fix *);
void reverse_comm(Comm *, Pair *);

// pair styles that a pair hybrid is made of, empty if it is none
std::vector<std::string> parts_of_hybrid(LAMMPS *);

// What is in members that are not public. unseen(): what is lost where LAMMPS has other ones than those of the known
// versions, in words; empty: nothing.
std::string unseen();

bool moves_discs(Fix *);       // whether a fix nve/sphere has its keyword disc; unseen: false
bool gravity_varies(Fix *);    // whether a fix gravity has variables; unseen: true

// what a fix pour or fix deposit adds: molecules if there are any, or balls
struct Insertion {
  int type;
  std::vector<const Molecule *> molecules;
  double radius_lo, radius_hi, density_lo, density_hi;
};
bool insertion(Fix *, Insertion &);    // false: unseen

// the shapes of LAMMPS' own regions, numbers only: one with side out does not even have a bounding box
struct Sphere {
  double x, y, z, radius;
};
struct Block {
  double lo[3], hi[3];
};
struct Plane {
  double x, y, z, normal[3];
};
struct Cylinder {
  double axis;                      // 'x', 'y' or 'z'
  double c1, c2, radius, lo, hi;    // c1 c2: y z, x z, x y of the axis
};

// false if the region is none of these, or unseen; a class that is derived from one may be another shape
bool shape(Region *, Sphere &);
bool shape(Region *, Block &);
bool shape(Region *, Plane &);
bool shape(Region *, Cylinder &);

}    // namespace compat
}    // namespace LAMMPS_NS

#endif

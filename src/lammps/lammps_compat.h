/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What differs between the LAMMPS versions that the package supports. The only file that
   may ask for the version. */

#ifndef SLOPE_LAMMPS_COMPAT_H
#define SLOPE_LAMMPS_COMPAT_H

#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "fix_gravity.h"
#include "fix_nve_sphere.h"
#include "modify.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "pair_hybrid.h"
#include "region.h"
#include "region_block.h"
#include "region_cylinder.h"
#include "region_plane.h"
#include "region_sphere.h"
#include "style_name.h"

#include <string>
#include <typeinfo>
#include <vector>

namespace LAMMPS_NS {
class Pair;

namespace compat {

// region by its ID, nullptr if there is none
inline Region *find_region(LAMMPS *lmp, const std::string &id)
{
  Domain *domain = lmp->domain;
#if SLOPE_LAMMPS_VERSION >= 20220504
  return domain->get_region_by_id(id);
#else
  for (int i = 0; i < domain->nregion; i++)
    if (id == domain->regions[i]->id) return domain->regions[i];
  return nullptr;
#endif
}

// all regions, in any order
inline std::vector<Region *> regions(LAMMPS *lmp)
{
#if SLOPE_LAMMPS_VERSION >= 20220504
  return lmp->domain->get_region_list();
#else
  return std::vector<Region *>(lmp->domain->regions, lmp->domain->regions + lmp->domain->nregion);
#endif
}

// regions that an intersection or a union is made of
inline std::vector<Region *> parts_of(LAMMPS *lmp, Region *region)
{
#if SLOPE_LAMMPS_VERSION >= 20220504
  (void) lmp;
  return std::vector<Region *>(region->reglist, region->reglist + region->nregion);
#else
  std::vector<Region *> found;
  for (int i = 0; i < region->nregion; i++) found.push_back(lmp->domain->regions[region->list[i]]);
  return found;
#endif
}

// fixes of one style, accelerated variants of it included, in the order of the deck; without one
// that is just being replaced
inline std::vector<Fix *> fixes_of_style(LAMMPS *lmp, const std::string &style)
{
  std::vector<Fix *> found;
  Modify *modify = lmp->modify;
  for (int i = 0; i < modify->nfix; i++)
    if (modify->fix[i] && Slope::is_style(modify->fix[i]->style, style))
      found.push_back(modify->fix[i]);
  return found;
}

// half neighbor list of touching spheres with contact history
inline void request_history_list(Neighbor *neighbor, Pair *pair, int instance)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  (void) instance;
  neighbor->add_request(pair, NeighConst::REQ_SIZE | NeighConst::REQ_HISTORY);
#else
  int irequest = neighbor->request(pair, instance);
  neighbor->requests[irequest]->size = 1;
  neighbor->requests[irequest]->history = 1;
#endif
}

// neighbor lists of spheres leave out bonded pairs whose factor in special_bonds is 0; before 2022 they
// are as those of all others, whatever special_bonds says
static constexpr bool LISTS_OF_SPHERES_KNOW_BONDS = SLOPE_LAMMPS_VERSION >= 20220623;

// whether a fix nve/sphere has its keyword disc: protected there
inline bool moves_discs(Fix *fix)
{
  struct Reach : public FixNVESphere {
    static double FixNVESphere::*prefactor() { return &Reach::inertia; }
  };
  const auto sphere = dynamic_cast<FixNVESphere *>(fix);
  return sphere && sphere->*Reach::prefactor() > 0.45;    // 0.4 of a sphere, 0.5 of a disc
}

// whether a fix gravity has variables: protected there
inline bool gravity_varies(Fix *fix)
{
  struct Reach : public FixGravity {
    static int FixGravity::*variables() { return &Reach::varflag; }
  };
  const auto gravity = dynamic_cast<FixGravity *>(fix);
  return gravity && gravity->*Reach::variables() != 0;
}

// pair styles that a pair hybrid is made of, empty if it is none: protected there
inline std::vector<std::string> parts_of_hybrid(Pair *pair)
{
  struct Reach : public PairHybrid {
    static int PairHybrid::*number() { return &Reach::nstyles; }
    static char **PairHybrid::*names() { return &Reach::keywords; }
  };
  const auto hybrid = dynamic_cast<PairHybrid *>(pair);
  if (!hybrid) return {};
  char **const names = hybrid->*Reach::names();
  return std::vector<std::string>(names, names + hybrid->*Reach::number());
}

// values of ghost atoms from, and to, those that own them, by the style's pack and unpack
inline void forward_comm(Comm *comm, Pair *pair)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  comm->forward_comm(pair);
#else
  comm->forward_comm_pair(pair);
#endif
}

inline void forward_comm(Comm *comm, Fix *fix)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  comm->forward_comm(fix);
#else
  comm->forward_comm_fix(fix);
#endif
}

inline void reverse_comm(Comm *comm, Pair *pair)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  comm->reverse_comm(pair);
#else
  comm->reverse_comm_pair(pair);
#endif
}

// What LAMMPS does not hand out. C++ does not check access in the arguments of an
// explicit instantiation, which here gives away pointers to these members; their names have been
// the same in all versions, and a new name would not compile.

template <typename Tag, typename Tag::Type member> struct Reveal {
  friend typename Tag::Type reveal(Tag) { return member; }
};
#define SLOPE_REVEAL(CLASS, TYPE, MEMBER) \
  struct CLASS##_##MEMBER {               \
    typedef TYPE(CLASS::*Type);           \
    friend Type reveal(CLASS##_##MEMBER); \
  };                                      \
  template struct Reveal<CLASS##_##MEMBER, &CLASS::MEMBER>;

// the shapes of LAMMPS' own regions: one with side out does not even have a bounding box

SLOPE_REVEAL(RegSphere, double, xc)
SLOPE_REVEAL(RegSphere, double, yc)
SLOPE_REVEAL(RegSphere, double, zc)
SLOPE_REVEAL(RegSphere, double, radius)
SLOPE_REVEAL(RegBlock, double, xlo)
SLOPE_REVEAL(RegBlock, double, xhi)
SLOPE_REVEAL(RegBlock, double, ylo)
SLOPE_REVEAL(RegBlock, double, yhi)
SLOPE_REVEAL(RegBlock, double, zlo)
SLOPE_REVEAL(RegBlock, double, zhi)
SLOPE_REVEAL(RegPlane, double, xp)
SLOPE_REVEAL(RegPlane, double, yp)
SLOPE_REVEAL(RegPlane, double, zp)
typedef double Vector3[3];
SLOPE_REVEAL(RegPlane, Vector3, normal)
SLOPE_REVEAL(RegCylinder, char, axis)
SLOPE_REVEAL(RegCylinder, double, c1)
SLOPE_REVEAL(RegCylinder, double, c2)
SLOPE_REVEAL(RegCylinder, double, radius)
SLOPE_REVEAL(RegCylinder, double, lo)
SLOPE_REVEAL(RegCylinder, double, hi)

// which fixes have something in the restart file that was read, and whether they were there to take it

SLOPE_REVEAL(Modify, char **, id_restart_global)
SLOPE_REVEAL(Modify, char **, style_restart_global)
SLOPE_REVEAL(Modify, int *, used_restart_global)
SLOPE_REVEAL(Modify, char **, id_restart_peratom)
SLOPE_REVEAL(Modify, char **, style_restart_peratom)
SLOPE_REVEAL(Modify, int *, used_restart_peratom)

struct RestartList {
  int number;
  char **id, **style;
  int *used;
};

inline RestartList restart_of_fixes(Modify *m)
{
  return {m->nfix_restart_global, m->*reveal(Modify_id_restart_global()),
          m->*reveal(Modify_style_restart_global()), m->*reveal(Modify_used_restart_global())};
}

inline RestartList restart_by_atom(Modify *m)
{
  return {m->nfix_restart_peratom, m->*reveal(Modify_id_restart_peratom()),
          m->*reveal(Modify_style_restart_peratom()), m->*reveal(Modify_used_restart_peratom())};
}

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
  char axis;
  double c1, c2, radius, lo, hi;    // c1 c2: y z, x z, x y of the axis
};

// false if the region is none of these; a class that is derived from one may be another shape

template <typename Shape> Shape *exactly(Region *region)
{
  return typeid(*region) == typeid(Shape) ? static_cast<Shape *>(region) : nullptr;
}

inline bool shape(Region *region, Sphere &s)
{
  auto *r = exactly<RegSphere>(region);
  if (!r) return false;
  s = {r->*reveal(RegSphere_xc()), r->*reveal(RegSphere_yc()), r->*reveal(RegSphere_zc()),
       r->*reveal(RegSphere_radius())};
  return true;
}

inline bool shape(Region *region, Block &b)
{
  auto *r = exactly<RegBlock>(region);
  if (!r) return false;
  b = {{r->*reveal(RegBlock_xlo()), r->*reveal(RegBlock_ylo()), r->*reveal(RegBlock_zlo())},
       {r->*reveal(RegBlock_xhi()), r->*reveal(RegBlock_yhi()), r->*reveal(RegBlock_zhi())}};
  return true;
}

inline bool shape(Region *region, Plane &p)
{
  auto *r = exactly<RegPlane>(region);
  if (!r) return false;
  const double *normal = r->*reveal(RegPlane_normal());
  p = {r->*reveal(RegPlane_xp()),
       r->*reveal(RegPlane_yp()),
       r->*reveal(RegPlane_zp()),
       {normal[0], normal[1], normal[2]}};
  return true;
}

inline bool shape(Region *region, Cylinder &c)
{
  auto *r = exactly<RegCylinder>(region);
  if (!r) return false;
  c = {r->*reveal(RegCylinder_axis()), r->*reveal(RegCylinder_c1()),
       r->*reveal(RegCylinder_c2()),   r->*reveal(RegCylinder_radius()),
       r->*reveal(RegCylinder_lo()),   r->*reveal(RegCylinder_hi())};
  return true;
}

}    // namespace compat
}    // namespace LAMMPS_NS

#endif

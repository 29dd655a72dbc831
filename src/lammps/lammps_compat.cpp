/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "lammps_compat.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_deposit.h"
#include "fix_gravity.h"
#include "fix_nve_sphere.h"
#include "fix_pour.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "pair.h"
#include "region_block.h"
#include "region_cylinder.h"
#include "region_plane.h"
#include "region_sphere.h"
#include "reveal.h"

#include <algorithm>
#include <set>
#include <typeinfo>

using namespace LAMMPS_NS;
using Slope::revealed;

// the first version that has been tested with the interfaces of which 13Nov2026 has no older ones left
#define SLOPE_LAMMPS_IS_NEW (SLOPE_LAMMPS_VERSION >= 20260704)

/* ----------------------------------------------------------------------
   lists
------------------------------------------------------------------------- */

Region *compat::find_region(LAMMPS *lmp, const std::string &id)
{
#if SLOPE_LAMMPS_VERSION >= 20220504
  return lmp->domain->get_region_by_id(id);
#else
  for (Region *region : regions(lmp))
    if (id == region->id) return region;
  return nullptr;
#endif
}

std::vector<Region *> compat::regions(LAMMPS *lmp)
{
#if SLOPE_LAMMPS_VERSION >= 20220504
  return lmp->domain->get_region_list();
#else
  return std::vector<Region *>(lmp->domain->regions, lmp->domain->regions + lmp->domain->nregion);
#endif
}

std::vector<Region *> compat::parts_of(LAMMPS *lmp, Region *region)
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

std::vector<Fix *> compat::fixes(LAMMPS *lmp)
{
  Modify *modify = lmp->modify;
#if SLOPE_LAMMPS_IS_NEW
  std::vector<Fix *> found = modify->get_fix_list();
#else
  std::vector<Fix *> found(modify->fix, modify->fix + modify->nfix);
#endif
  found.erase(std::remove(found.begin(), found.end(), nullptr), found.end());
  return found;
}

std::vector<Fix *> compat::fixes_of_style(LAMMPS *lmp, const std::string &style)
{
  std::vector<Fix *> found;
  for (Fix *fix : fixes(lmp))
    if (Slope::is_style(fix->style, style)) found.push_back(fix);
  return found;
}

Fix *compat::fix_by_id(LAMMPS *lmp, const std::string &id)
{
  for (Fix *fix : fixes(lmp))
    if (id == fix->id) return fix;
  return nullptr;
}

int compat::mask_of(LAMMPS *lmp, const Fix *fix)
{
#if SLOPE_LAMMPS_IS_NEW
  return lmp->modify->get_fix_mask(const_cast<Fix *>(fix));
#else
  for (int k = 0; k < lmp->modify->nfix; k++)
    if (lmp->modify->fix[k] == fix) return lmp->modify->fmask[k];
  return 0;
#endif
}

// only one that is there: what LAMMPS makes of any other has changed in August 2026

void compat::drop_fix(LAMMPS *lmp, const std::string &id)
{
  if (fix_by_id(lmp, id)) lmp->modify->delete_fix(id);
}

int compat::group_bit(LAMMPS *lmp, const std::string &group)
{
#if SLOPE_LAMMPS_IS_NEW
  return lmp->group->get_bitmask_by_id(FLERR, group, "SLOPE");
#else
  return lmp->group->bitmask[lmp->group->find(group)];
#endif
}

/* ----------------------------------------------------------------------
   neighbor lists, communication
------------------------------------------------------------------------- */

void compat::request_history_list(Neighbor *neighbor, Pair *pair, int instance)
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

void compat::forward_comm(Comm *comm, Pair *pair)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  comm->forward_comm(pair);
#else
  comm->forward_comm_pair(pair);
#endif
}

void compat::forward_comm(Comm *comm, Fix *fix)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  comm->forward_comm(fix);
#else
  comm->forward_comm_fix(fix);
#endif
}

void compat::reverse_comm(Comm *comm, Pair *pair)
{
#if SLOPE_LAMMPS_VERSION >= 20220324
  comm->reverse_comm(pair);
#else
  comm->reverse_comm_pair(pair);
#endif
}

// of each style that LAMMPS knows: the first one of a hybrid, the second one and so on; without a second one it is the first
// again, and without any none

std::vector<std::string> compat::parts_of_hybrid(LAMMPS *lmp)
{
  std::vector<std::string> found;
  Force *force = lmp->force;
  for (const auto &style : *force->pair_map) {
    std::set<Pair *> seen = {nullptr, force->pair};
    for (int n = 1; seen.insert(force->pair_match(style.first, 1, n)).second; n++)
      found.push_back(style.first);
  }
  return found;
}

/* ----------------------------------------------------------------------
   members that are not public
------------------------------------------------------------------------- */

typedef char **Texts;
typedef double *Numbers;
typedef Molecule **Molecules;
typedef double Vector3[3];

SLOPE_REVEAL(FixNVESphere, double, inertia)
SLOPE_REVEAL(FixGravity, int, varflag)

SLOPE_REVEAL(Modify, Texts, id_restart_global)
SLOPE_REVEAL(Modify, Texts, style_restart_global)
SLOPE_REVEAL(Modify, int *, used_restart_global)
SLOPE_REVEAL(Modify, Texts, id_restart_peratom)
SLOPE_REVEAL(Modify, Texts, style_restart_peratom)
SLOPE_REVEAL(Modify, int *, used_restart_peratom)

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
SLOPE_REVEAL(RegPlane, Vector3, normal)
SLOPE_REVEAL(RegCylinder, char, axis)
SLOPE_REVEAL(RegCylinder, double, c1)
SLOPE_REVEAL(RegCylinder, double, c2)
SLOPE_REVEAL(RegCylinder, double, radius)
SLOPE_REVEAL(RegCylinder, double, lo)
SLOPE_REVEAL(RegCylinder, double, hi)

static bool sees_restart()
{
  return revealed<Modify_id_restart_global, Modify_style_restart_global, Modify_used_restart_global,
                  Modify_id_restart_peratom, Modify_style_restart_peratom,
                  Modify_used_restart_peratom>();
}

static bool sees_pour()
{
  return revealed<FixPour_ntype, FixPour_mode, FixPour_dstyle, FixPour_npoly, FixPour_radius_one,
                  FixPour_radius_lo, FixPour_radius_hi, FixPour_radius_poly, FixPour_density_lo,
                  FixPour_density_hi, FixPour_onemols, FixPour_nmol>();
}

static bool sees_deposit()
{
  return revealed<FixDeposit_ntype, FixDeposit_mode, FixDeposit_onemols, FixDeposit_nmol>();
}

static bool sees(const compat::Sphere &)
{
  return revealed<RegSphere_xc, RegSphere_yc, RegSphere_zc, RegSphere_radius>();
}

static bool sees(const compat::Block &)
{
  return revealed<RegBlock_xlo, RegBlock_xhi, RegBlock_ylo, RegBlock_yhi, RegBlock_zlo,
                  RegBlock_zhi>();
}

static bool sees(const compat::Plane &)
{
  return revealed<RegPlane_xp, RegPlane_yp, RegPlane_zp, RegPlane_normal>();
}

static bool sees(const compat::Cylinder &)
{
  return revealed<RegCylinder_axis, RegCylinder_c1, RegCylinder_c2, RegCylinder_radius,
                  RegCylinder_lo, RegCylinder_hi>();
}

/* ---------------------------------------------------------------------- */

std::string compat::unseen()
{
  const std::pair<bool, const char *> uses[] = {
      {revealed<FixNVESphere_inertia>(), "keyword disc of fix nve/sphere is not refused"},
      {sees_restart(),
       "a fix that is defined too late to get what read_restart has for it is not refused"},
      {sees_pour() && sees_deposit(),
       "balls of fix pour and fix deposit are checked when they have come, not before"},
      {sees(Sphere()) && sees(Block()) && sees(Plane()) && sees(Cylinder()),
       "regions sphere, block, plane and cylinder are searched in steps"}};
  std::string found;
  for (const auto &use : uses)
    if (!use.first) found += std::string(found.empty() ? "" : "; ") + use.second;
  return found.empty() ? found
                       : "this LAMMPS has other members than 29Sep2021 to 4Jul2026: " + found;
}

/* ---------------------------------------------------------------------- */

bool compat::moves_discs(Fix *fix)
{
  const auto sphere = dynamic_cast<FixNVESphere *>(fix);
  return sphere && revealed<FixNVESphere_inertia>() &&
      sphere->*FixNVESphere_inertia::at() > 0.45;    // 0.4 of a sphere, 0.5 of a disc
}

bool compat::gravity_varies(Fix *fix)
{
  const auto gravity = dynamic_cast<FixGravity *>(fix);
  return gravity && (!revealed<FixGravity_varflag>() || gravity->*FixGravity_varflag::at() != 0);
}

/* ---------------------------------------------------------------------- */

std::vector<std::pair<std::string, std::string>> compat::left_in_restart(LAMMPS *lmp)
{
  std::vector<std::pair<std::string, std::string>> found;
  if (!sees_restart()) return found;
  Modify *m = lmp->modify;
  const auto add = [&](int n, const int *used, char **id, char **style) {
    for (int k = 0; k < n; k++)
      if (!used[k]) found.emplace_back(id[k], style[k]);
  };
  add(m->nfix_restart_global, m->*Modify_used_restart_global::at(),
      m->*Modify_id_restart_global::at(), m->*Modify_style_restart_global::at());
  add(m->nfix_restart_peratom, m->*Modify_used_restart_peratom::at(),
      m->*Modify_id_restart_peratom::at(), m->*Modify_style_restart_peratom::at());
  return found;
}

bool compat::balls_wait_for_fixes(LAMMPS *lmp)
{
  return lmp->modify->nfix_restart_peratom > 0;
}

/* ---------------------------------------------------------------------- */

enum { ATOM, MOLECULE };      // mode, in both fixes
enum { ONE, RANGE, POLY };    // dstyle

static void see_sizes(FixPour *fix, compat::Insertion &found)
{
  found.density_lo = fix->*FixPour_density_lo::at();
  found.density_hi = fix->*FixPour_density_hi::at();
  const int sizes = fix->*FixPour_dstyle::at();
  found.radius_lo = found.radius_hi = fix->*FixPour_radius_one::at();
  if (sizes == RANGE) {
    found.radius_lo = fix->*FixPour_radius_lo::at();
    found.radius_hi = fix->*FixPour_radius_hi::at();
  } else if (sizes == POLY) {
    const double *radii = fix->*FixPour_radius_poly::at();
    const auto ends = std::minmax_element(radii, radii + fix->*FixPour_npoly::at());
    found.radius_lo = *ends.first;
    found.radius_hi = *ends.second;
  }
}

bool compat::insertion(Fix *fix, Insertion &found)
{
  found = {0, {}, 0.5, 0.5, 1.0, 1.0};    // LAMMPS' sizes and density, where nothing else is said
  if (const auto pour = dynamic_cast<FixPour *>(fix)) {
    if (!sees_pour()) return false;
    found.type = pour->*FixPour_ntype::at();
    Molecule **const molecules = pour->*FixPour_onemols::at();
    if (pour->*FixPour_mode::at() == MOLECULE)
      found.molecules.assign(molecules, molecules + pour->*FixPour_nmol::at());
    else
      see_sizes(pour, found);
    return true;
  }
  const auto deposit = dynamic_cast<FixDeposit *>(fix);
  if (!deposit || !sees_deposit()) return false;
  found.type = deposit->*FixDeposit_ntype::at();
  Molecule **const molecules = deposit->*FixDeposit_onemols::at();
  if (deposit->*FixDeposit_mode::at() == MOLECULE)
    found.molecules.assign(molecules, molecules + deposit->*FixDeposit_nmol::at());
  return true;
}

/* ---------------------------------------------------------------------- */

template <typename Exactly, typename Shape> static Exactly *seen_as(Region *region, const Shape &s)
{
  return typeid(*region) == typeid(Exactly) && sees(s) ? static_cast<Exactly *>(region) : nullptr;
}

bool compat::shape(Region *region, Sphere &s)
{
  const auto r = seen_as<RegSphere>(region, s);
  if (!r) return false;
  s = {r->*RegSphere_xc::at(), r->*RegSphere_yc::at(), r->*RegSphere_zc::at(),
       r->*RegSphere_radius::at()};
  return true;
}

bool compat::shape(Region *region, Block &b)
{
  const auto r = seen_as<RegBlock>(region, b);
  if (!r) return false;
  b = {{r->*RegBlock_xlo::at(), r->*RegBlock_ylo::at(), r->*RegBlock_zlo::at()},
       {r->*RegBlock_xhi::at(), r->*RegBlock_yhi::at(), r->*RegBlock_zhi::at()}};
  return true;
}

bool compat::shape(Region *region, Plane &p)
{
  const auto r = seen_as<RegPlane>(region, p);
  if (!r) return false;
  const double *normal = r->*RegPlane_normal::at();
  p = {r->*RegPlane_xp::at(),
       r->*RegPlane_yp::at(),
       r->*RegPlane_zp::at(),
       {normal[0], normal[1], normal[2]}};
  return true;
}

bool compat::shape(Region *region, Cylinder &c)
{
  const auto r = seen_as<RegCylinder>(region, c);
  if (!r) return false;
  c = {r->*RegCylinder_axis::at() + 0.0, r->*RegCylinder_c1::at(), r->*RegCylinder_c2::at(),
       r->*RegCylinder_radius::at(),     r->*RegCylinder_lo::at(), r->*RegCylinder_hi::at()};
  return true;
}

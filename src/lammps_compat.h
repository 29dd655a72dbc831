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
#include "modify.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "region.h"

#include <string>
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

  // fixes of one style, or of our variant of it, in the order of the deck; without one that is just
  // being replaced
  inline std::vector<Fix *> fixes_of_style(LAMMPS *lmp, const std::string &style)
  {
    std::vector<Fix *> found;
    Modify *modify = lmp->modify;
    for (int i = 0; i < modify->nfix; i++)
      if (modify->fix[i] &&
          (style == modify->fix[i]->style || style + "/slope" == modify->fix[i]->style))
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

  // values of ghost atoms from, and to, those that own them, by a pair style's pack and unpack
  inline void forward_comm(Comm *comm, Pair *pair)
  {
#if SLOPE_LAMMPS_VERSION >= 20220324
    comm->forward_comm(pair);
#else
    comm->forward_comm_pair(pair);
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

}    // namespace compat
}    // namespace LAMMPS_NS

#endif

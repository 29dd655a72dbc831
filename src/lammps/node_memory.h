/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NODE_MEMORY_H
#define SLOPE_NODE_MEMORY_H

#include "pointers.h"

#include <string>

namespace LAMMPS_NS {

// Collective: the ranks that share the memory of this one, to be freed; this one alone where MPI does not know
MPI_Comm ranks_of_node(class LAMMPS *);

// Collective. Each rank says how many bytes it is going to ask for: if the ranks of any node need
// more than the node has left, the run ends on all ranks with one line:
// "WHAT need 5.1 GB of memory on a node (2 ranks), which has 3.2 GB left: REMEDY".
void check_node_memory(class LAMMPS *, double bytes, const std::string &what,
                       const std::string &remedy);

}    // namespace LAMMPS_NS

#endif

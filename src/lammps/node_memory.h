/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NODE_MEMORY_H
#define SLOPE_NODE_MEMORY_H

#include "pointers.h"

#include <cstddef>
#include <mpi.h>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Collective: the ranks that share the memory of this one, to be freed; this one alone where MPI does not know
MPI_Comm ranks_of_node(class LAMMPS *);

// Collective. Each rank says how many bytes it is going to ask for: if the ranks of any node need
// more than the node has left, the run ends on all ranks with one line:
// "WHAT need 5.1 GB of memory on a node (2 ranks), which has 3.2 GB left: REMEDY".
void check_node_memory(class LAMMPS *, double bytes, const std::string &what,
                       const std::string &remedy);

// Numbers that all ranks read and none changes: one copy for the ranks of a node, in memory that they
// share (MPI 3); a copy on each rank where the node gives no such memory, or MPI does not know it.
class NodeArray : protected Pointers {
 public:
  // All ranks. The run ends if a node does not have the memory: "WHAT need ..." (check_node_memory())
  NodeArray(class LAMMPS *, size_t size, const std::string &what);
  ~NodeArray() override;    // all ranks
  NodeArray(const NodeArray &) = delete;
  NodeArray &operator=(const NodeArray &) = delete;

  void fill(const double *values);    // all ranks; those of rank 0
  const double *data() const { return numbers; }
  double bytes() const;    // that this rank has, for all that share them

 private:
  const size_t size;
  double *numbers;
  std::vector<double> own;
  MPI_Comm node;
#if defined(MPI_VERSION) && MPI_VERSION >= 3
  MPI_Win window;
#endif
  bool shared;

  bool is_first() const;    // of those who share a copy
  void share();
};

}    // namespace LAMMPS_NS

#endif

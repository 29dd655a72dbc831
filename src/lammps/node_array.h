/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_NODE_ARRAY_H
#define SLOPE_NODE_ARRAY_H

#include "pointers.h"

#include <cstddef>
#include <mpi.h>
#include <string>
#include <vector>

namespace LAMMPS_NS {

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

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "node_memory.h"

#include "free_memory.h"

#include "comm.h"
#include "error.h"

#include <algorithm>

using namespace LAMMPS_NS;

static constexpr double HEAD = 1 << 20;     // bytes of MPI's own in shared memory
static constexpr size_t CHUNK = 1 << 24;    // numbers of a message: MPI counts in int

#if defined(MPI_VERSION) && MPI_VERSION >= 3
#define SLOPE_NODES
#endif

/* ---------------------------------------------------------------------- */

MPI_Comm LAMMPS_NS::ranks_of_node(LAMMPS *lmp)
{
  MPI_Comm node;
#if defined(MPI_VERSION) && MPI_VERSION >= 3
  MPI_Comm_split_type(lmp->world, MPI_COMM_TYPE_SHARED, lmp->comm->me, MPI_INFO_NULL, &node);
#else
  MPI_Comm_split(lmp->world, lmp->comm->me, lmp->comm->me, &node);
#endif
  return node;
}

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::check_node_memory(LAMMPS *lmp, double bytes, const std::string &what,
                                  const std::string &remedy)
{
  MPI_Comm node = ranks_of_node(lmp);
  double found[3] = {0.0, Slope::free_memory(), 0.0};    // needed, left, ranks
  int ranks;
  MPI_Comm_size(node, &ranks);
  MPI_Allreduce(&bytes, &found[0], 1, MPI_DOUBLE, MPI_SUM, node);
  MPI_Bcast(&found[1], 1, MPI_DOUBLE, 0, node);    // the same for all of them
  MPI_Comm_free(&node);
  found[2] = ranks;

  struct {
    double spare;
    int rank;
  } mine = {found[1] - found[0], lmp->comm->me}, worst;
  MPI_Allreduce(&mine, &worst, 1, MPI_DOUBLE_INT, MPI_MINLOC, lmp->world);
  if (worst.spare >= 0.0) return;
  MPI_Bcast(found, 3, MPI_DOUBLE, worst.rank, lmp->world);
  lmp->error->all(FLERR,
                  "{} need {:.3g} GB of memory on a node ({:.0f} rank{}), which has {:.3g} GB "
                  "left: {}",
                  what, 1.0e-9 * found[0], found[2], found[2] > 1.0 ? "s" : "", 1.0e-9 * found[1],
                  remedy);
}

/* ---------------------------------------------------------------------- */

NodeArray::NodeArray(LAMMPS *lmp, size_t size_in, const std::string &what) :
    Pointers(lmp), size(size_in), numbers(nullptr), node(ranks_of_node(lmp)), shared(false)
{
  const double bytes = static_cast<double>(size) * sizeof(double);
  const std::string remedy = "cut it to the site, or make its cells larger";
  check_node_memory(lmp, is_first() ? bytes : 0.0, what, remedy);
  share();

  // a copy on each rank of a node that shares none

  check_node_memory(lmp, shared ? 0.0 : bytes, what, remedy);
  if (shared) return;
  own.resize(size);
  numbers = own.data();
}

/* ---------------------------------------------------------------------- */

void NodeArray::share()
{
#ifdef SLOPE_NODES
  int ranks, fail = 0, any;
  MPI_Comm_size(node, &ranks);
  if (ranks > 1) {    // Open MPI does not return from a lack of space
    fail = HEAD + static_cast<double>(size) * sizeof(double) > Slope::free_shared_memory();
    MPI_Bcast(&fail, 1, MPI_INT, 0, node);
  }
  if (ranks > 1 && !fail) {
    MPI_Comm_set_errhandler(node, MPI_ERRORS_RETURN);
    const MPI_Aint mine = is_first() ? static_cast<MPI_Aint>(size * sizeof(double)) : 0;
    fail = MPI_Win_allocate_shared(mine, sizeof(double), MPI_INFO_NULL, node, &numbers, &window) !=
        MPI_SUCCESS;
  }
  shared = ranks > 1 && !fail;
  MPI_Allreduce(&fail, &any, 1, MPI_INT, MPI_MAX, world);
  if (any && shared) {
    MPI_Win_free(&window);
    shared = false;
  }
  if (!shared) return;
  MPI_Aint bytes;
  int unit;
  MPI_Win_shared_query(window, 0, &bytes, &unit, &numbers);
#endif
}

bool NodeArray::is_first() const
{
  int rank;
  MPI_Comm_rank(node, &rank);
  return rank == 0;
}

double NodeArray::bytes() const
{
  return !shared || is_first() ? static_cast<double>(size) * sizeof(double) : 0.0;
}

NodeArray::~NodeArray()
{
#ifdef SLOPE_NODES
  int over;
  MPI_Finalized(&over);
  if (over) return;
  if (shared) MPI_Win_free(&window);
#endif
  MPI_Comm_free(&node);
}

/* ---------------------------------------------------------------------- */

void NodeArray::fill(const double *values)
{
  const bool fills = !shared || is_first();
  MPI_Comm those;
  MPI_Comm_split(world, fills, comm->me, &those);
#ifdef SLOPE_NODES
  if (shared) MPI_Win_fence(0, window);
#endif
  if (fills) {
    if (comm->me == 0) std::copy(values, values + size, numbers);
    for (size_t done = 0; done < size; done += CHUNK)
      MPI_Bcast(numbers + done, static_cast<int>(std::min(CHUNK, size - done)), MPI_DOUBLE, 0,
                those);
  }
#ifdef SLOPE_NODES
  if (shared) MPI_Win_fence(0, window);
#endif
  MPI_Comm_free(&those);
}

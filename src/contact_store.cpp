/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "contact_store.h"

#include "atom.h"
#include "error.h"
#include "memory.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

static constexpr int MOST = 1024;    // contacts with one wall that a ball can have

/* ---------------------------------------------------------------------- */

ContactStore::ContactStore(LAMMPS *lmp, const std::string &caller_in) :
    Pointers(lmp), maxexchange(1), caller(caller_in), ncontact(nullptr), values(nullptr)
{
  page.init(MOST * SIZE, 64 * MOST * SIZE);
  grow_arrays(atom->nmax);
  std::fill(ncontact, ncontact + atom->nlocal, 0);
}

ContactStore::~ContactStore()
{
  memory->destroy(ncontact);
  memory->sfree(values);
}

/* ---------------------------------------------------------------------- */

void ContactStore::clear()
{
  page.reset();
  std::fill(ncontact, ncontact + atom->nlocal, 0);
  maxexchange = 1;
}

// the last atoms may have been deleted since the lists were made: nothing is remembered of them

void ContactStore::allot(int i, int n)
{
  if (i >= atom->nlocal) return;
  if (n > MOST)
    error->one(FLERR, "{}: ball {} touches {} fixed parts, the most is {}", caller, atom->tag[i], n,
               MOST);
  values[i] = page.get(n * SIZE);
  maxexchange = std::max(maxexchange, 1 + n * SIZE);
}

void ContactStore::remember(int i, int64_t number, const double *history)
{
  if (i >= atom->nlocal) return;
  double *to = values[i] + ncontact[i]++ * SIZE;
  to[0] = static_cast<double>(number);
  memcpy(to + 1, history, Slope::HISTORY * sizeof(double));
}

/* ---------------------------------------------------------------------- */

void ContactStore::grow_arrays(int nmax)
{
  memory->grow(ncontact, nmax, "contact_store:ncontact");
  values = (double **) memory->srealloc(values, nmax * sizeof(double *), "contact_store:values");
}

// the values stay where they are until the next take()

void ContactStore::copy_arrays(int i, int j)
{
  ncontact[j] = ncontact[i];
  values[j] = values[i];
}

int ContactStore::pack_exchange(int i, double *buf) const
{
  const int n = ncontact[i] * SIZE;
  buf[0] = ncontact[i];
  if (n) memcpy(buf + 1, values[i], n * sizeof(double));
  return 1 + n;
}

int ContactStore::unpack_exchange(int i, const double *buf)
{
  ncontact[i] = static_cast<int>(buf[0]);
  const int n = ncontact[i] * SIZE;
  values[i] = page.get(n);
  if (n) memcpy(values[i], buf + 1, n * sizeof(double));
  maxexchange = std::max(maxexchange, 1 + n);
  return 1 + n;
}

/* ---------------------------------------------------------------------- */

// over all ranks: rank 0 writes it, and read_restart sizes its buffer by it

int ContactStore::maxsize_restart() const
{
  int mine = 0, most;
  for (int i = 0; i < atom->nlocal; i++) mine = std::max(mine, size_restart(i));
  MPI_Allreduce(&mine, &most, 1, MPI_INT, MPI_MAX, world);
  return std::max(most, 2);
}

int ContactStore::pack_restart(int i, double *buf) const
{
  const int m = 1 + pack_exchange(i, &buf[1]);
  buf[0] = m;
  return m;
}

void ContactStore::unpack_restart(int i, int nth)
{
  const double *extra = atom->extra[i];
  int m = 0;
  for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
  unpack_exchange(i, &extra[m + 1]);
}

double ContactStore::memory_usage() const
{
  return static_cast<double>(atom->nmax) * (sizeof(int) + sizeof(double *)) + page.size() +
      histories.capacity() * sizeof(double);
}

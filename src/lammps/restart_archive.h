/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef LMP_RESTART_ARCHIVE_H
#define LMP_RESTART_ARCHIVE_H

#include "archive.h"
#include "comm.h"
#include "error.h"
#include "pointers.h"

#include <cstdio>
#include <stdexcept>
#include <string>

namespace LAMMPS_NS {

// What a fix has in a restart file, its length first, as LAMMPS wants it; by rank 0. more: bytes that the fix itself writes after
// the archive.
inline void write_archive(LAMMPS *lmp, FILE *fp, const std::string &caller, Slope::Archive &archive,
                          double more = 0.0)
{
  if (lmp->comm->me > 0) return;
  const std::string &bytes = archive.bytes();
  const double size = bytes.size() + more;
  if (size > MAXSMALLINT)
    lmp->error->one(FLERR, "{} must have at most {} bytes in a restart file, got {:.0f}", caller,
                    MAXSMALLINT, size);
  const int whole = static_cast<int>(size);
  fwrite(&whole, sizeof(int), 1, fp);
  fwrite(bytes.data(), 1, bytes.size(), fp);
}

// Reading, on all ranks, which have the same: what is wrong ends the run with one line.
template <typename Work> void read_archive(LAMMPS *lmp, const std::string &caller, const Work &work)
{
  std::string problem;
  try {
    work();
  } catch (const std::runtime_error &e) {
    problem = e.what();
  }
  if (!problem.empty()) lmp->error->all(FLERR, "{}: {}", caller, problem);
}

// The bytes of an archive at this place of a file, on all ranks, which opened it on rank 0; only their beginning if they are no
// archive.
inline std::string archive_bytes(LAMMPS *lmp, FILE *fp, const std::string &caller)
{
  using Slope::Archive;
  std::string bytes(Archive::HEAD, '\0');
  auto read = [&](size_t from) {
    if (lmp->comm->me == 0 && bytes.size() > from)
      utils::sfread(FLERR, &bytes[from], 1, bytes.size() - from, fp, nullptr, lmp->error);
    MPI_Bcast(&bytes[from], static_cast<int>(bytes.size() - from), MPI_CHAR, 0, lmp->world);
  };
  read(0);
  size_t size = 0;
  read_archive(lmp, caller, [&]() {
    size = Archive::length(bytes.data());
  });
  if (size > bytes.size()) {
    bytes.resize(size);
    read(Archive::HEAD);
  }
  return bytes;
}

}    // namespace LAMMPS_NS

#endif

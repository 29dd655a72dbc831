/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "restart_archive.h"

#include "lammps_compat.h"
#include "rank_zero.h"

#include "atom.h"
#include "comm.h"
#include "fix.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::write_archive(LAMMPS *lmp, FILE *fp, const std::string &caller,
                              Slope::Archive &archive, double more)
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

/* ---------------------------------------------------------------------- */

std::string LAMMPS_NS::archive_bytes(LAMMPS *lmp, FILE *fp, const std::string &caller)
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

/* ---------------------------------------------------------------------- */

const double *RestartExtra::record_of_ball(int i, int nth, int fixed, int each)
{
  const double *at = atom->extra[i], *const end = at + atom->nextra_store;
  auto whole = [end](const double *number, double least) {
    return number < end && *number >= least && *number <= end - number &&
        *number == std::floor(*number);
  };
  for (int k = 0; k < nth; k++) {
    if (!whole(at, 1.0)) return reject(i, at < end ? *at : 0.0);
    at += static_cast<int>(*at);
  }
  if (!whole(at, fixed)) return reject(i, at < end ? *at : 0.0);
  if (each == 0) return *at == fixed ? at : reject(i, *at);
  if (!whole(at + 1, 0.0) || at[0] != fixed + at[1] * each) return reject(i, at[1]);
  return at;
}

/* ---------------------------------------------------------------------- */

const double *RestartExtra::reject(int i, double number)
{
  ball = std::max<tagint>(atom->tag[i], 1);    // of a damaged file, too
  wrong = number;
  return nullptr;
}

/* ---------------------------------------------------------------------- */

void RestartExtra::check(const std::string &caller) const
{
  const std::string problem = fmt::format(
      "the {} of ball {} in the restart file must have a whole number of values that fits in "
      "it, got {:g}: the file is damaged, take an earlier one",
      what, ball, wrong);
  end_if_any(lmp, caller, ball ? problem : "");
}

/* ---------------------------------------------------------------------- */

void RestartDrops::check()
{
  for (const Fix *fix : compat::fixes(lmp))
    if (std::find(dropped.begin(), dropped.end(), Name(fix->id, fix->style)) != dropped.end())
      error->all(FLERR,
                 "Fix {} {} must be defined before the first command after read_restart that sets "
                 "up a run, such as "
                 "balance, at which LAMMPS drops what the file has for it, got it after that: "
                 "define it before, or "
                 "with another ID if it is to begin anew",
                 fix->id, fix->style);
  for (const Name &left : compat::left_in_restart(lmp)) dropped.push_back(left);
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef LMP_RESTART_ARCHIVE_H
#define LMP_RESTART_ARCHIVE_H

#include "archive.h"
#include "error.h"
#include "pointers.h"

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// What a fix has in a restart file, its length first, as LAMMPS wants it; by rank 0. more: bytes that the fix
// itself writes after the archive.
void write_archive(LAMMPS *lmp, FILE *fp, const std::string &caller, Slope::Archive &archive,
                   double more = 0.0);

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

// The bytes of an archive at this place of a file, on all ranks, which opened it on rank 0; only their
// beginning if they are no archive.
std::string archive_bytes(LAMMPS *lmp, FILE *fp, const std::string &caller);

// What a restart file has for the balls of a fix, which LAMMPS hands over without its length. In a damaged
// file the numbers in it may be anything: a ball is then left without them, and check() ends the run.
class RestartExtra : protected Pointers {
 public:
  explicit RestartExtra(class LAMMPS *lmp, const char *what_in = "contacts") :
      Pointers(lmp), what(what_in), ball(0), wrong(0.0)
  {
  }

  // What the file has for ball i and the nth fix, as LAMMPS' unpack_restart() counts them: how many numbers
  // there are, this one included, then, where each > 0, the number of contacts, and so on: fixed numbers in all,
  // these included, and each more for every contact. nullptr: the file is damaged
  const double *record_of_ball(int i, int nth, int fixed, int each);

  void check(const std::string &caller) const;    // collective

 private:
  const std::string what;
  tagint ball;     // the last one that is damaged; 0: none
  double wrong;    // the number there

  const double *reject(int i, double number);
};

// What a restart file has for fixes goes to those that are defined before the first command that sets LAMMPS up (run,
// balance, write_restart, ...). Then LAMMPS drops the rest, and a fix that comes later, of the same ID and style, begins
// without its contacts or sums.
class RestartDrops : protected Pointers {
 public:
  explicit RestartDrops(class LAMMPS *lmp) : Pointers(lmp) {}

  // at each set-up, before LAMMPS drops: ends the run if there is such a fix
  void check();

 private:
  typedef std::pair<std::string, std::string> Name;    // ID and style
  std::vector<Name> dropped;
};

}    // namespace LAMMPS_NS

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_PREFIX_LOCK_H
#define SLOPE_PREFIX_LOCK_H

#include <memory>
#include <string>

namespace Slope {

// Files PREFIX.* belong to one run at a time: as long as it holds the lock of PREFIX.lock, which names it,
// another one gets an error, a std::runtime_error with one line. The kernel releases the lock of a process that
// has ended in any way; its file may be left then, and means nothing. Several writers of a run share the lock.
// Without locks in the file system (some of those in a network) nothing is refused.
class PrefixLock {
 public:
  // run: any address that tells the runs of this process from each other
  void take(const std::string &prefix, const void *run);

 private:
  std::shared_ptr<struct HeldLock> held;
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_FREE_MEMORY_H
#define SLOPE_FREE_MEMORY_H

#include <algorithm>
#include <fstream>
#include <string>
#include <unistd.h>

namespace Slope {

// Bytes that this machine, or the container that we run in, can give away now; what it has in all
// where it does not say more.
inline double free_memory()
{
  double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  std::ifstream info("/proc/meminfo");
  double kilobytes;
  for (std::string key, line; info >> key; std::getline(info, line))
    if (key == "MemAvailable:" && info >> kilobytes) bytes = std::min(bytes, 1024.0 * kilobytes);

  double limit, used;
  std::ifstream most("/sys/fs/cgroup/memory.max"), now("/sys/fs/cgroup/memory.current");
  if (most >> limit && now >> used) bytes = std::min(bytes, std::max(0.0, limit - used));
  return bytes;
}

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "free_memory.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <sys/statvfs.h>
#include <unistd.h>

using namespace Slope;

namespace {

// the number behind a word at the beginning of a line, NaN if it is not there

double number_after(const std::string &path, const std::string &word)
{
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string first;
    double value;
    if (words >> first && first == word && words >> value) return value;
  }
  return NAN;
}

// the number that is all of a file; NaN if there is none, as in "max"

double number_in(const std::string &path)
{
  std::ifstream file(path);
  double value;
  return (file >> value) ? value : NAN;
}

// what the group and those above it leave; their unused cached file pages are available, too

double left_in_groups(const std::string &root)
{
  std::ifstream file(root + "/proc/self/cgroup");
  std::string line, group;
  while (std::getline(file, line))
    if (line.compare(0, 3, "0::") == 0) group = line.substr(3);
  if (group.empty() || group[0] != '/') return HUGE_VAL;

  double left = HUGE_VAL;
  while (true) {
    const std::string folder = root + "/sys/fs/cgroup" + group;
    const double most = number_in(folder + "/memory.max");
    const double used = number_in(folder + "/memory.current");
    const double idle = number_after(folder + "/memory.stat", "inactive_file");
    if (!std::isnan(most) && !std::isnan(used))
      left = std::min(left, most - used + (std::isnan(idle) ? 0.0 : idle));
    if (group.empty()) return std::max(0.0, left);
    group.resize(group.rfind('/'));
  }
}

}    // namespace

/* ---------------------------------------------------------------------- */

double Slope::free_memory(const std::string &root)
{
  double found = 1024.0 * number_after(root + "/proc/meminfo", "MemAvailable:");
  if (std::isnan(found)) found = (double) sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE);
  return std::min(found, left_in_groups(root));
}

double Slope::free_shared_memory(const std::string &folder)
{
  struct statvfs left;
  if (statvfs(folder.c_str(), &left) != 0 || left.f_blocks == 0) return HUGE_VAL;
  return static_cast<double>(left.f_bavail) * left.f_frsize;
}

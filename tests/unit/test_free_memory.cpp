/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// What Linux says is available, and what control groups leave of it, from files as Linux has them.

#include "free_memory.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

using Slope::free_memory;

static const double GB = 1024.0 * 1024.0 * 1024.0;

class Machine {
 public:
  Machine()
  {
    char name[] = "/tmp/test_free_memory.XXXXXX";
    root = mkdtemp(name);
    write("/proc/meminfo",
          "MemTotal:       33554432 kB\nMemFree:         1048576 kB\n"
          "MemAvailable:   16777216 kB\n");
  }
  ~Machine() { EXPECT_EQ(system(("rm -r " + root).c_str()), 0); }

  void write(const std::string &path, const std::string &text)
  {
    for (size_t k = path.find('/', 1); k != std::string::npos; k = path.find('/', k + 1))
      mkdir((root + path.substr(0, k)).c_str(), 0755);
    std::ofstream(root + path) << text;
  }

  std::string root;
};

TEST(FreeMemory, OfThisMachine)
{
  EXPECT_GT(free_memory(), 1e6);
  EXPECT_LE(free_memory(), (double) sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE));
}

TEST(FreeMemory, WhatIsAvailable)
{
  Machine machine;
  EXPECT_EQ(free_memory(machine.root), 16 * GB);
  machine.write("/proc/self/cgroup", "4:memory:/old\n0::/job\n");    // without files of a limit
  EXPECT_EQ(free_memory(machine.root), 16 * GB);
}

TEST(FreeMemory, NotKnown)
{
  EXPECT_EQ(free_memory("/nowhere"), (double) sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGESIZE));
}

TEST(FreeMemory, ControlGroups)
{
  Machine machine;
  machine.write("/proc/self/cgroup", "0::/slurm/job\n");
  machine.write("/sys/fs/cgroup/slurm/job/memory.max", "max\n");
  machine.write("/sys/fs/cgroup/slurm/job/memory.current", "1000\n");
  EXPECT_EQ(free_memory(machine.root), 16 * GB);

  // the group above it has 8 GB, of which 3 are used, 1 of these for files
  machine.write("/sys/fs/cgroup/slurm/memory.max", "8589934592\n");
  machine.write("/sys/fs/cgroup/slurm/memory.current", "3221225472\n");
  EXPECT_EQ(free_memory(machine.root), 5 * GB);
  machine.write("/sys/fs/cgroup/slurm/memory.stat", "anon 7\ninactive_file 1073741824\n");
  EXPECT_EQ(free_memory(machine.root), 6 * GB);

  // a container sees its own group as the top
  machine.write("/proc/self/cgroup", "0::/\n");
  machine.write("/sys/fs/cgroup/memory.max", "2147483648\n");
  machine.write("/sys/fs/cgroup/memory.current", "3221225472\n");
  EXPECT_EQ(free_memory(machine.root), 0.0);
}

TEST(FreeMemory, SharedByProcesses)
{
  EXPECT_EQ(Slope::free_shared_memory("/nowhere"), HUGE_VAL);
  EXPECT_EQ(Slope::free_shared_memory("/proc"), HUGE_VAL);    // of no size
  EXPECT_GT(Slope::free_shared_memory("/tmp"), 0.0);
}

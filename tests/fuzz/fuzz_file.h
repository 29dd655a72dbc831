/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_FUZZ_FILE_H
#define SLOPE_FUZZ_FILE_H

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

// A file in memory that holds what the fuzzer gives, under a name that the readers can open
class FuzzFile {
 public:
  FuzzFile() : fd(memfd_create("fuzz", 0)), path("/proc/self/fd/" + std::to_string(fd)) {}

  const std::string &of(const uint8_t *data, size_t size)
  {
    if (ftruncate(fd, 0) != 0 || pwrite(fd, data, size, 0) != (ssize_t) size) abort();
    return path;
  }

 private:
  int fd;
  std::string path;
};

// What a reader says of bad input: one line that can be shown, and names the file
inline void must_be_one_line(const std::runtime_error &e, const std::string &path)
{
  const std::string text = e.what();
  bool good = text.find(path) != std::string::npos && text.size() < 1000;
  for (const char c : text) good = good && (unsigned char) c >= ' ' && (unsigned char) c != 127;
  if (good) return;
  fprintf(stderr, "not one line: %s\n", text.c_str());
  abort();
}

// For what must hold of all that is read
inline void must(bool holds, const char *what)
{
  if (holds) return;
  fprintf(stderr, "does not hold: %s\n", what);
  abort();
}

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_ATOMIC_FILE_H
#define SLOPE_ATOMIC_FILE_H

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace Slope {

// A text file that appears under its name only when it is complete: it is written beside, as
// PATH.tmp, and commit() renames it. Without commit(), or after an error, nothing is left
// behind and an older file of that name stays as it was. Errors are std::runtime_error with
// one line that names the path.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string &_path) : path(_path), beside(_path + ".tmp"), fp(nullptr)
  {
    fp = fopen(beside.c_str(), "w");
    if (!fp) fail();
  }

  ~AtomicFile() { discard(); }

  void write(const char *text, size_t length)
  {
    if (fwrite(text, 1, length, fp) != length) fail();
  }

  void write(const std::string &text) { write(text.data(), text.size()); }

  void commit()
  {
    FILE *closing = fp;
    fp = nullptr;
    if (fclose(closing) != 0 || rename(beside.c_str(), path.c_str()) != 0) fail();
  }

 private:
  std::string path, beside;
  FILE *fp;

  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &operator=(const AtomicFile &) = delete;

  void discard()
  {
    if (!fp) return;
    fclose(fp);
    remove(beside.c_str());
    fp = nullptr;
  }

  void fail()
  {
    const std::string reason = strerror(errno);
    if (fp) fclose(fp);
    fp = nullptr;
    remove(beside.c_str());
    throw std::runtime_error("cannot write " + path + ": " + reason);
  }
};

}    // namespace Slope

#endif

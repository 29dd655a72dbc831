// No LAMMPS
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
#include <sys/stat.h>
#include <unistd.h>

namespace Slope {

// A text file that appears under its name only when it is complete: it is written beside, as
// PATH.PROCESS.tmp, and commit() renames it. Without commit(), or after an error, nothing is left
// behind and an older file of that name stays as it was. Of several files that belong together,
// close() all, which is the last that a full disk or a folder of that name can refuse, before the
// first commit().
// Errors are std::runtime_error with one line that names the path.
class AtomicFile {
 public:
  explicit AtomicFile(const std::string &_path) :
      path(_path), beside(_path + "." + std::to_string(getpid()) + ".tmp"),
      fp(fopen(beside.c_str(), "w")), there(fp != nullptr)
  {
    if (!fp) fail();
    check_target();
  }

  ~AtomicFile() { discard(); }

  void write(const char *text, size_t length)
  {
    if (fwrite(text, 1, length, fp) != length) fail();
  }

  void write(const std::string &text) { write(text.data(), text.size()); }

  void close()
  {
    FILE *closing = fp;
    fp = nullptr;
    if (closing && fclose(closing) != 0) fail();
    check_target();
  }

  void commit()
  {
    close();
    if (rename(beside.c_str(), path.c_str()) != 0) fail();
    there = false;
  }

 private:
  std::string path, beside;
  FILE *fp;
  bool there;    // the temporary file exists

  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &operator=(const AtomicFile &) = delete;

  void check_target()    // fails where rename() would
  {
    struct stat info;
    errno = EISDIR;
    if (lstat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode)) fail();
  }

  void discard()
  {
    if (fp) fclose(fp);
    fp = nullptr;
    if (there) remove(beside.c_str());
    there = false;
  }

  void fail()
  {
    const std::string reason = strerror(errno);
    discard();
    throw std::runtime_error("cannot write " + path + ": " + reason);
  }
};

}    // namespace Slope

#endif

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
#include <memory>
#include <stdexcept>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

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

// Files that appear together: on a full disk, or where one of them cannot be written, either all are
// new, or none.
class FileSet {
 public:
  // whether all could be written: each is opened beside, and removed
  static void probe(const std::vector<std::string> &paths)
  {
    for (const std::string &path : paths) AtomicFile file(path);
  }

  AtomicFile &add(const std::string &path)
  {
    files.emplace_back(new AtomicFile(path));
    paths.push_back(path);
    return *files.back();
  }

  std::vector<std::string> names() const    // without their folder, in the order they were added
  {
    std::vector<std::string> found;
    for (const std::string &path : paths) found.push_back(path.substr(path.rfind('/') + 1));
    return found;
  }

  void commit()
  {
    for (auto &file : files) file->close();
    for (auto &file : files) file->commit();
  }

 private:
  std::vector<std::unique_ptr<AtomicFile>> files;
  std::vector<std::string> paths;
};

}    // namespace Slope

#endif

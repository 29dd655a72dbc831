// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_FILE_SET_H
#define SLOPE_FILE_SET_H

#include "atomic_file.h"

#include <memory>
#include <string>
#include <vector>

namespace Slope {

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

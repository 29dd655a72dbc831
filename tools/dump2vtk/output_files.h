/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_OUTPUT_FILES_H
#define SLOPE_OUTPUT_FILES_H

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace Slope {

// All output files. They are written in a folder of their own beside OUT, and get their names when
// the last one is complete; without commit() nothing is left behind. Errors are std::runtime_error
// with one line that names the path.
class OutputFiles {
 public:
  explicit OutputFiles(const std::filesystem::path &out);
  ~OutputFiles();

  // where to write a file; its name is relative to OUT's folder
  std::string path(const std::filesystem::path &file);

  // OUT/OUT_STEP.vtp: many files, so they have a folder of their own
  std::filesystem::path snapshot(int64_t step) const;

  std::filesystem::path single(const std::string &ending) const;    // OUT.ENDING

  void commit(bool series);    // series: with snapshots, which replace those of an earlier call

 private:
  std::filesystem::path out, beside;
  std::string name;
  std::vector<std::filesystem::path> files;

  OutputFiles(const OutputFiles &) = delete;
  OutputFiles &operator=(const OutputFiles &) = delete;
  [[noreturn]] void fail(const std::filesystem::path &target, const std::error_code &error) const;
  void remove_old() const;
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "output_files.h"

#include "interrupt.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

using namespace Slope;
namespace fs = std::filesystem;

static constexpr int STEP_DIGITS = 8;

/* ---------------------------------------------------------------------- */

OutputFiles::OutputFiles(const fs::path &_out) : out(_out), name(_out.filename())
{
  std::error_code error;
  if (fs::exists(out, error) && !fs::is_directory(out, error))
    throw std::runtime_error("cannot write " + out.string() + "/: a file has this name");
  std::string pattern = out.string() + ".tmp.XXXXXX";
  if (!mkdtemp(pattern.data()))
    throw std::runtime_error("cannot write " + out.string() + ".*: " + strerror(errno));
  beside = pattern;
}

OutputFiles::~OutputFiles()
{
  std::error_code error;
  fs::remove_all(beside, error);
}

/* ---------------------------------------------------------------------- */

std::string OutputFiles::path(const fs::path &file)
{
  if (files.empty() || files.back() != file) files.push_back(file);
  return (beside / file.filename()).string();
}

fs::path OutputFiles::snapshot(int64_t step) const
{
  std::string digits = std::to_string(step);
  digits.insert(0, std::max<int>(0, STEP_DIGITS - digits.size()), '0');
  return fs::path(name) / (name + "_" + digits + ".vtp");
}

fs::path OutputFiles::single(const std::string &ending) const
{
  return name + "." + ending;
}

/* ---------------------------------------------------------------------- */

void OutputFiles::commit(bool series)
{
  check_interrupt();
  std::error_code error;
  if (series) {
    fs::create_directory(out, error);
    if (error) fail(out, error);
    remove_old();
  }
  for (const auto &file : files) {
    const fs::path target = out.parent_path() / file;
    fs::rename(beside / file.filename(), target, error);
    if (error) fail(target, error);
  }
}

/* ---------------------------------------------------------------------- */

void OutputFiles::fail(const fs::path &target, const std::error_code &error) const
{
  throw std::runtime_error("cannot write " + target.string() + ": " +
                           error.default_error_condition().message());
}

/* ----------------------------------------------------------------------
   Snapshots of an earlier call: ParaView would take them for part of the series
------------------------------------------------------------------------- */

void OutputFiles::remove_old() const
{
  std::error_code error;
  for (const auto &entry : fs::directory_iterator(out, error)) {
    const std::string file = entry.path().filename(), begin = name + "_";
    if (file.compare(0, begin.size(), begin) != 0 || entry.path().extension() != ".vtp") continue;
    const std::string digits = file.substr(begin.size(), file.size() - begin.size() - 4);
    if (digits.size() < STEP_DIGITS || digits.find_first_not_of("0123456789") != digits.npos)
      continue;
    fs::remove(entry.path(), error);
    if (error) fail(entry.path(), error);
  }
}

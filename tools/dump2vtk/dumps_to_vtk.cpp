/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "dumps_to_vtk.h"

#include "atomic_file.h"
#include "dump_reader.h"
#include "interrupt.h"
#include "numbers.h"
#include "options.h"
#include "output_files.h"
#include "progress.h"
#include "snapshot_to_vtk.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <map>
#include <stdexcept>

using namespace Slope;
namespace fs = std::filesystem;

namespace {

// a snapshot that is written

struct Entry {
  double time;
  std::string source;    // file and line of the snapshot
  bool has_time;
  size_t count;
  fs::file_time_type written;    // the file
};

using Series = std::map<int64_t, Entry>;    // by step

double time_of(const Snapshot &snapshot, const Options &options)
{
  if (options.dt > 0.0) return snapshot.step * options.dt;
  if (snapshot.has_time) return snapshot.time;
  return options.run_dt > 0.0 ? snapshot.step * options.run_dt : snapshot.step;
}

std::string xml_text(const std::string &text)
{
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

// what a longer run before left in the folder comes after the last step of this one

void warn_of_other_run(const Series &series, Progress &progress)
{
  auto other = series.begin();
  for (auto one = std::next(other); one != series.end(); other = one++)
    if (other->second.written - one->second.written > std::chrono::seconds(1)) {
      progress.warn(one->second.source + ": step " + std::to_string(one->first) +
                    " was written before step " + std::to_string(other->first) + " of " +
                    other->second.source + ": is it of another run?");
      break;
    }
}

void write_pvd(const Series &series, const OutputFiles &output, const std::string &path)
{
  AtomicFile file(path);
  file.write("<?xml version=\"1.0\"?>\n"
             "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
             "  <Collection>\n");
  for (const auto &[step, entry] : series)
    file.write("    <DataSet timestep=\"" + to_text(entry.time) +
               "\" group=\"\" part=\"0\" file=\"" + xml_text(output.snapshot(step).string()) +
               "\"/>\n");
  file.write("  </Collection>\n</VTKFile>\n");
  file.commit();
}

}    // namespace

/* ---------------------------------------------------------------------- */

void Slope::dumps_to_vtk(const Options &options, OutputFiles &output, Progress &progress,
                         std::string &report)
{
  int64_t total = 0, before = 0;
  for (const auto &path : options.dumps) {
    LineReader check(path);    // a misspelt name shows now and not after an hour
    total += fs::file_size(path);
  }

  Series series;
  Snapshot snapshot;
  for (const auto &path : options.dumps) {
    DumpReader reader(path);
    size_t dropped = 0;
    std::string first, word;
    while (true) {
      check_interrupt();
      try {
        if (!reader.next(snapshot)) break;
      } catch (CutShort &error) {
        if (!options.skip) throw;
        progress.warn(std::string(error.what()) + "; skipped");
        continue;
      }
      const std::string source = path + ", line " + std::to_string(snapshot.first_line);
      const auto known = series.find(snapshot.step);
      if (known != series.end()) {
        if (dropped++ == 0)
          first = source + ": step " + std::to_string(snapshot.step) + " is dropped, it is in " +
              known->second.source;
        continue;
      }
      for (size_t k = 0; k < snapshot.names.size() && word.empty(); k++)
        if (!snapshot.numeric[k]) word = snapshot.names[k];

      if (options.dt == 0.0 && !series.empty()) {
        const Entry &other = series.begin()->second;
        if (other.has_time != snapshot.has_time)
          throw std::runtime_error(source + ": ITEM: TIME must be in all snapshots or in none, " +
                                   "the one of " + other.source + " is different; give --dt");
      }

      const double time = time_of(snapshot, options);
      const fs::path file = output.snapshot(snapshot.step);
      snapshot_to_vtk(snapshot, reader.file(), options, time, output.path(file));
      series[snapshot.step] = {time, source, snapshot.has_time, snapshot.count,
                               fs::last_write_time(path)};
      progress.say(
          std::to_string(100 * (before + reader.file().bytes()) / std::max<int64_t>(1, total)) +
          " %, " + std::to_string(series.size()) + " snapshots, step " +
          std::to_string(snapshot.step));
    }
    before += fs::file_size(path);
    if (dropped > 1) first += "; so are " + std::to_string(dropped - 1) + " more of this file";
    if (dropped) progress.warn(first);
    if (!word.empty()) progress.warn(path + ": column " + word + " holds words and is left out");
  }
  if (series.empty()) throw std::runtime_error("the dumps have no complete snapshot");
  warn_of_other_run(series, progress);

  // after the snapshots, so that it gets its name last

  const fs::path pvd = output.single("pvd");
  write_pvd(series, output, output.path(pvd));

  const Entry &start = series.begin()->second, &end = series.rbegin()->second;
  report += (options.out.parent_path() / pvd).string() + ": " + std::to_string(series.size()) +
      " snapshots, step " + std::to_string(series.begin()->first) + " to " +
      std::to_string(series.rbegin()->first) + ", time " + to_text(start.time) + " to " +
      to_text(end.time) + ", " + std::to_string(end.count) + " balls in the last\n";
}

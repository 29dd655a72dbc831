/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

// Any file is the snapshots of a dump, or ends in errors of one line

#include "dump_reader.h"
#include "fuzz_file.h"

#include <cmath>

using namespace Slope;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static FuzzFile file;
  const std::string &path = file.of(data, size);
  try {
    DumpReader reader(path);
    Snapshot snapshot;
    std::vector<double> xyz;
    std::array<int, 3> used;
    for (bool more = true; more;) {
      try {
        more = reader.next(snapshot);
        if (!more) break;
        for (size_t k = 0; k < snapshot.columns.size(); k++)
          must(snapshot.columns[k].size() == (snapshot.numeric[k] ? snapshot.count : 0),
               "a value for each ball");
        positions(snapshot, reader.file(), xyz, used);
        must(xyz.size() == 3 * snapshot.count, "a position for each ball");
      } catch (CutShort &e) {
        must_be_one_line(e, path);    // and the next snapshot follows
      }
    }
  } catch (std::runtime_error &e) {
    must_be_one_line(e, path);
  }
  return 0;
}

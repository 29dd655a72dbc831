/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DUMP_READER_H
#define SLOPE_DUMP_READER_H

#include "line_reader.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace Slope {

// All balls of one time step. The memory is kept from one snapshot to the next.
struct Snapshot {
  int64_t step;
  bool has_time;    // ITEM: TIME, in time units
  double time;
  size_t count;
  std::vector<std::string> names;              // of the columns
  std::vector<std::vector<double>> columns;    // [column][ball]
  std::vector<bool> numeric;    // false: words, such as elements; the column is empty

  // Edges of the box: lowest corner, lengths, tilts xy xz yz
  bool has_box;
  std::array<double, 3> corner, length, tilt;

  int64_t first_line;    // in the file, for messages
  int64_t atoms_line;

  int find(std::string_view name) const;    // column, or -1
};

// Snapshots of a LAMMPS dump (styles atom and custom, text), one after the other
class DumpReader {
 public:
  explicit DumpReader(const std::string &path) : lines(path), any(false) {}

  // The next snapshot; false at the end of the file. After CutShort the next call goes on with the
  // snapshot that follows, if there is one.
  bool next(Snapshot &snapshot);

  const LineReader &file() const { return lines; }

 private:
  LineReader lines;
  bool any;    // a snapshot has begun, so it is a dump

  void must_follow(const char *what);
  double number(const char *what);
  int64_t whole(const char *what);
  void read_box(Snapshot &snapshot);
  void read_names(Snapshot &snapshot);
  void read_atoms(Snapshot &snapshot);
};

// Positions x y z of all balls, in distance units, from whatever the columns hold: x y z,
// xu yu zu, or scaled by the box xs ys zs, xsu ysu zsu, in this order. used tells the columns that
// were taken. Positions must be finite.
void positions(const Snapshot &snapshot, const LineReader &file, std::vector<double> &xyz,
               std::array<int, 3> &used);

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_DUMP_READER_H
#define SLOPE_DUMP_READER_H

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

struct gzFile_s;

namespace Slope {

// A snapshot that ends before its last ball: what a killed run leaves behind. Any other error of
// the classes below is a plain std::runtime_error; each has one line: file, line, rule, value.
class CutShort : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The number that is the whole of a word; false if it is not one. "nan" and "inf" are numbers.
bool to_number(std::string_view word, double &value);

// The lines of a text file, plain or compressed by gzip, in constant memory.
class LineReader {
 public:
  explicit LineReader(const std::string &path);
  ~LineReader();

  bool next();    // false at the end of the file
  std::string_view line() const { return text; }
  bool complete() const { return ended; }    // whether the line ends in a line break
  int64_t number() const { return nline; }
  void again() { held = true; }    // next() gives the same line once more

  // the words of the line, between blanks and tabs
  const std::vector<std::string_view> &words();

  // what is wrong in this line, with file and number
  std::string where(const std::string &what) const;
  [[noreturn]] void fail(const std::string &what) const;

  int64_t bytes() const;    // of the file that have been read
  const std::string &name() const { return path; }

 private:
  std::string path;
  gzFile_s *gz;
  std::vector<char> buffer;
  size_t begin, end;
  std::string_view text;
  std::vector<std::string_view> split;
  int64_t nline;
  bool ended, held, finished, cut;

  LineReader(const LineReader &) = delete;
  LineReader &operator=(const LineReader &) = delete;
  void refill();
};

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

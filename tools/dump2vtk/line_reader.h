/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_LINE_READER_H
#define SLOPE_LINE_READER_H

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

struct gzFile_s;

namespace Slope {

// A snapshot that ends before its last ball, or a compressed file that is cut short: what a killed
// run leaves behind. Any other error is a plain std::runtime_error; each has one line: file, line,
// rule, value.
class CutShort : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

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

}    // namespace Slope

#endif

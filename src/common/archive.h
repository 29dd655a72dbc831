// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_ARCHIVE_H
#define SLOPE_ARCHIVE_H

#include <cstddef>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace Slope {

// What a restart file has for a style: its name and version, then members, each with its name and how many
// numbers it is. The same calls, in the same order, write them and read them. Of what is read, name and number
// must be those that are asked for: a file of another version, or a damaged one, throws std::runtime_error. All
// is numbers, in the machine's own bytes.
class Archive {
 public:
  Archive(const std::string &style, int version);                        // to be written
  Archive(const std::string &style, int version, const char *buffer);    // to be read

  bool reads() const { return from != nullptr; }

  void numbers(const std::string &name, double *values, size_t n);
  void list(const std::string &name, std::vector<double> &values);    // as many as there are
  void lines(const std::string &name,
             std::vector<std::string> &texts);    // one number for each byte

  template <class Record> void records(const std::string &name, std::vector<Record> &records)
  {
    static constexpr size_t EACH = sizeof(Record) / sizeof(double);    // numbers only
    const double *const first = reinterpret_cast<const double *>(records.data());
    std::vector<double> values(first, first + records.size() * EACH);
    list(name, values);
    records.resize(values.size() / EACH);
    if (!records.empty())
      std::memcpy(records.data(), values.data(), records.size() * sizeof(Record));
  }

  template <class T> void number(const std::string &name, T &value)
  {
    double x = static_cast<double>(value);
    numbers(name, &x, 1);
    value = static_cast<T>(x);
  }

  // a number that the reader must have, too: of what a contact has, for instance
  void same(const std::string &name, double value);

  // Numbers that say which one WHAT is, which must be that of the file. If not: "the WHAT must be that of the
  // restart file, TEXT of its numbers; got TEXT of mine", then the remedy.
  struct Mark {
    std::string name;
    double value;
  };
  void same(const std::string &what, const std::vector<Mark> &mine,
            const std::function<std::string(const double *)> &text, const std::string &remedy = "");

  // how many numbers of a member follow, which are not in the archive but after it; from 0 to most
  size_t count(const std::string &name, size_t n, double most);

  // --- what was written ---

  const std::string &bytes();

  // --- what is read ---

  // a buffer begins with HEAD bytes that say how many there are, 0: these are no archive
  static constexpr size_t HEAD = 24;
  static size_t length(const char *head);
  const char *rest() const { return at; }    // what follows the members that have been read

 private:
  std::string written;
  const char *const from, *at, *end;
  const int version;

  void put(const void *, size_t);
  void get(void *, size_t);
  [[noreturn]] void other_version(const std::string &got) const;
};

}    // namespace Slope

#endif

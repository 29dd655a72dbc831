/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "dump_reader.h"

#include "numbers.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

using namespace Slope;

static constexpr double MAXWHOLE = 9007199254740992.0;    // whole numbers are exact up to here

namespace {

std::string printable(std::string_view word)
{
  std::string found(word.substr(0, 40));
  for (char &c : found)
    if (!isprint((unsigned char) c)) c = '?';
  return found;
}

bool starts_with(std::string_view text, std::string_view begin)
{
  return text.substr(0, begin.size()) == begin;
}

// columns that hold words

bool is_text(std::string_view name)
{
  return name == "element" || name == "typelabel";
}

}    // namespace

/* ---------------------------------------------------------------------- */

int Snapshot::find(std::string_view name) const
{
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? -1 : at - names.begin();
}

/* ----------------------------------------------------------------------
   The line after an ITEM line. One without a line break may have lost its last digits.
------------------------------------------------------------------------- */

void DumpReader::must_follow(const char *what)
{
  if (!lines.next() || !lines.complete())
    throw CutShort(
        lines.where(std::string("the file ends in the header of a snapshot, at ") + what));
  if (starts_with(lines.line(), "ITEM:")) {
    lines.again();
    throw CutShort(lines.where(std::string("another snapshot begins in a header, at ") + what));
  }
}

double DumpReader::number(const char *what)
{
  must_follow(what);
  const auto &words = lines.words();
  double value;
  if (words.size() != 1 || !to_number(words[0], value))
    lines.fail(std::string(what) + " must be a number, got " + printable(lines.line()));
  return value;
}

int64_t DumpReader::whole(const char *what)
{
  const double value = number(what);
  if (!(value >= 0.0 && value <= MAXWHOLE && value == std::floor(value)))
    lines.fail(std::string(what) + " must be a whole number >= 0, got " + printable(lines.line()));
  return value;
}

/* ----------------------------------------------------------------------
   Three lines lo hi, or, for a tilted box, lo hi tilt, where lo and hi bound the tilted box.
   Lines of another form are passed over: the box counts only for scaled positions.
------------------------------------------------------------------------- */

void DumpReader::read_box(Snapshot &snapshot)
{
  double rows[3][3] = {};
  bool known = true;
  for (auto &row : rows) {
    must_follow("BOX BOUNDS");
    const auto &words = lines.words();
    if (words.size() < 2)
      lines.fail("BOX BOUNDS must be two numbers, got " + printable(lines.line()));
    if (words.size() > 3) known = false;
    for (size_t k = 0; k < std::min<size_t>(words.size(), 3); k++)
      if (!to_number(words[k], row[k]))
        lines.fail("BOX BOUNDS must be numbers, got " + printable(words[k]));
  }
  snapshot.has_box = known;
  snapshot.tilt = {rows[0][2], rows[1][2], rows[2][2]};
  const auto [xy, xz, yz] = snapshot.tilt;
  const double xlo = rows[0][0] - std::min({0.0, xy, xz, xy + xz});
  const double xhi = rows[0][1] - std::max({0.0, xy, xz, xy + xz});
  const double ylo = rows[1][0] - std::min(0.0, yz), yhi = rows[1][1] - std::max(0.0, yz);
  snapshot.corner = {xlo, ylo, rows[2][0]};
  snapshot.length = {xhi - xlo, yhi - ylo, rows[2][1] - rows[2][0]};
}

/* ---------------------------------------------------------------------- */

void DumpReader::read_names(Snapshot &snapshot)
{
  const auto &words = lines.words();
  const std::vector<std::string_view> names(words.begin() + 2, words.end());    // after ITEM: ATOMS
  if (names.empty()) lines.fail("ITEM: ATOMS must name the columns, got none");
  std::set<std::string_view> different;
  for (const auto &name : names)
    if (!different.insert(name).second)
      lines.fail("columns must have different names, got twice " + printable(name));

  snapshot.names.assign(names.begin(), names.end());
  snapshot.columns.resize(names.size());
  snapshot.numeric.clear();
  for (const auto &name : names) snapshot.numeric.push_back(!is_text(name));
  for (auto &column : snapshot.columns) column.clear();
  snapshot.atoms_line = lines.number();
}

/* ---------------------------------------------------------------------- */

void DumpReader::read_atoms(Snapshot &snapshot)
{
  const size_t ncolumns = snapshot.names.size();
  for (size_t n = 0; n < snapshot.count; n++) {
    const bool more = lines.next();
    const bool other = more && starts_with(lines.line(), "ITEM:");
    if (other) lines.again();
    if (!more || other || !lines.complete())
      throw CutShort(lines.where("the snapshot of step " + std::to_string(snapshot.step) +
                                 " is cut short, got " + std::to_string(n) + " of " +
                                 std::to_string(snapshot.count) + " balls"));

    const auto &words = lines.words();
    if (words.size() != ncolumns)
      lines.fail("must have " + std::to_string(ncolumns) + " columns, as in line " +
                 std::to_string(snapshot.atoms_line) + ", got " + std::to_string(words.size()));
    for (size_t k = 0; k < ncolumns; k++) {
      if (!snapshot.numeric[k]) continue;
      double value;
      if (!to_number(words[k], value))
        lines.fail("column " + printable(snapshot.names[k]) + " must be a number, got " +
                   printable(words[k]));
      snapshot.columns[k].push_back(value);
    }
  }
}

/* ---------------------------------------------------------------------- */

bool DumpReader::next(Snapshot &snapshot)
{
  do {
    if (!lines.next()) {
      if (lines.number() == 0) throw std::runtime_error(lines.name() + " is empty");
      if (!any) lines.fail("must be a LAMMPS dump with ITEM: TIMESTEP, got none");
      return false;
    }
  } while (lines.words().empty());

  snapshot.first_line = lines.number();
  snapshot.step = -1;
  snapshot.has_time = snapshot.has_box = false;
  bool counted = false;
  snapshot.count = 0;

  // LAMMPS writes UNITS (first snapshot), TIME, TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS, ATOMS

  while (true) {
    const std::string_view line = lines.line();
    if (!starts_with(line, "ITEM: ")) {
      if (any || snapshot.step >= 0) lines.fail("must be an ITEM line, got " + printable(line));
      lines.fail("must begin with ITEM:, as a text dump of LAMMPS does, got " + printable(line));
    }
    const std::string_view item = line.substr(6);
    if (!lines.complete()) throw CutShort(lines.where("the file ends in the header of a snapshot"));

    if (snapshot.step >= 0 && (starts_with(item, "UNITS") || starts_with(item, "TIME"))) {
      lines.again();
      throw CutShort(lines.where("another snapshot begins in the header of step " +
                                 std::to_string(snapshot.step)));
    }
    if (starts_with(item, "UNITS")) {
      must_follow("UNITS");
    } else if (starts_with(item, "TIMESTEP")) {
      snapshot.step = whole("TIMESTEP");
      any = true;
    } else if (starts_with(item, "TIME")) {
      snapshot.time = number("TIME");
      snapshot.has_time = true;
      if (!std::isfinite(snapshot.time))
        lines.fail("TIME must be finite, got " + printable(lines.line()));
    } else if (starts_with(item, "NUMBER OF ATOMS")) {
      snapshot.count = whole("NUMBER OF ATOMS");
      counted = true;
    } else if (starts_with(item, "BOX BOUNDS")) {
      read_box(snapshot);
    } else if (starts_with(item, "ATOMS")) {
      if (snapshot.step < 0) lines.fail("ITEM: TIMESTEP must stand before ITEM: ATOMS");
      if (!counted) lines.fail("ITEM: NUMBER OF ATOMS must stand before ITEM: ATOMS");
      read_names(snapshot);
      break;
    } else {
      lines.fail("must be an item of dump style atom or custom, got ITEM: " + printable(item));
    }
    if (!lines.next()) throw CutShort(lines.where("the file ends in the header of a snapshot"));
  }

  read_atoms(snapshot);
  return true;
}

/* ---------------------------------------------------------------------- */

void Slope::positions(const Snapshot &snapshot, const LineReader &file, std::vector<double> &xyz,
                      std::array<int, 3> &used)
{
  static constexpr const char *SUFFIX[] = {"", "u", "s", "su"};
  auto wrong = [&](int64_t line, const std::string &what) {
    throw std::runtime_error(file.name() + ", line " + std::to_string(line) + ": " + what);
  };

  bool scaled = false, found = false;
  for (const std::string suffix : SUFFIX) {
    for (int axis = 0; axis < 3; axis++)
      used[axis] = snapshot.find(std::string(1, "xyz"[axis]) + suffix);
    found = *std::min_element(used.begin(), used.end()) >= 0;
    scaled = suffix[0] == 's';
    if (found) break;
  }
  if (!found) {
    std::string got;
    for (const auto &name : snapshot.names) got += ' ' + printable(name);
    wrong(snapshot.atoms_line,
          "there must be columns x y z, xu yu zu, xs ys zs or xsu ysu zsu, got" +
              got.substr(0, 200));
  }
  if (scaled && !snapshot.has_box)
    wrong(snapshot.atoms_line, "scaled positions need ITEM: BOX BOUNDS with lo hi or lo hi tilt");

  xyz.resize(3 * snapshot.count);
  const auto [lx, ly, lz] = snapshot.length;
  const auto [xy, xz, yz] = snapshot.tilt;
  for (size_t i = 0; i < snapshot.count; i++) {
    double *p = &xyz[3 * i];
    for (int axis = 0; axis < 3; axis++) {
      p[axis] = snapshot.columns[used[axis]][i];
      if (!std::isfinite(p[axis]))
        wrong(snapshot.atoms_line + 1 + i,
              "column " + snapshot.names[used[axis]] + " must be finite, got " +
                  std::to_string(p[axis]));
    }
    if (scaled) {
      p[0] = snapshot.corner[0] + lx * p[0] + xy * p[1] + xz * p[2];
      p[1] = snapshot.corner[1] + ly * p[1] + yz * p[2];
      p[2] = snapshot.corner[2] + lz * p[2];
    }
  }
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "archive.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

using namespace Slope;

static constexpr char MARK[] = "SLOPE\0\0";    // with the 0 at its end: 8 bytes
static constexpr size_t NAME = 24;             // bytes of a member's name

constexpr size_t Archive::HEAD;

// a number, and again in another form: of a damaged file one of them may be anything
namespace {
struct Twice {
  double number, again;
  explicit Twice(double n = 0.0) : number(n), again(-1.0 - n) {}

  bool whole(double most) const
  {
    return number >= 0.0 && number <= most && number == std::floor(number) &&
        again == -1.0 - number;
  }
};
}    // namespace

static std::string text(double value)
{
  char number[40];
  snprintf(number, sizeof(number), "%.15g", value);
  return number;
}

[[noreturn]] static void damaged(const std::string &what)
{
  throw std::runtime_error("the restart file must have " + what +
                           ": the file is damaged, take an earlier one");
}

/* ---------------------------------------------------------------------- */

Archive::Archive(const std::string &style, int v) :
    from(nullptr), at(nullptr), end(nullptr), version(v)
{
  written.assign(HEAD, '\0');
  double mine = version;
  numbers(style, &mine, 1);
}

Archive::Archive(const std::string &style, int v, const char *buffer) :
    from(buffer), at(buffer + HEAD), end(nullptr), version(v)
{
  const size_t size = length(buffer);
  if (size == 0) other_version("none, or those of an earlier version");
  end = buffer + size;
  double found = 0.0;
  numbers(style, &found, 1);
  if (found != version) other_version(text(found));
}

void Archive::other_version(const std::string &got) const
{
  throw std::runtime_error("the restart file must have data of version " + std::to_string(version) +
                           ", got " + got +
                           ": start again, or continue with the version of SLOPE that wrote it");
}

/* ----------------------------------------------------------------------
   the head: a mark, and the length of all
------------------------------------------------------------------------- */

size_t Archive::length(const char *head)
{
  if (memcmp(head, MARK, sizeof(MARK)) != 0) return 0;
  Twice size;
  memcpy(&size, head + sizeof(MARK), sizeof(size));
  if (!size.whole(MOST_COUNTED) || size.number < HEAD)
    damaged("a whole number of bytes, there twice, got " + text(size.number) + " and " +
            text(-1.0 - size.again));
  return static_cast<size_t>(size.number);
}

const std::string &Archive::bytes()
{
  const Twice size(static_cast<double>(written.size()));
  memcpy(&written[0], MARK, sizeof(MARK));
  memcpy(&written[sizeof(MARK)], &size, sizeof(size));
  return written;
}

/* ---------------------------------------------------------------------- */

void Archive::put(const void *data, size_t bytes)
{
  written.append(static_cast<const char *>(data), bytes);
}

void Archive::get(void *data, size_t bytes)
{
  if (bytes > static_cast<size_t>(end - at)) damaged("all of its members, got fewer bytes");
  if (bytes) memcpy(data, at, bytes);
  at += bytes;
}

/* ---------------------------------------------------------------------- */

size_t Archive::count(const std::string &name, size_t n, double most)
{
  char label[NAME] = {};
  if (!reads()) {
    name.copy(label, NAME);
    put(label, NAME);
    const Twice size(static_cast<double>(n));
    put(&size, sizeof(size));
    return n;
  }
  Twice size;
  get(label, NAME);
  const std::string found(label, std::find(label, label + NAME, '\0'));
  if (found != name.substr(0, NAME)) damaged("the member " + name + " here, got another one");
  get(&size, sizeof(size));
  if (!size.whole(most))
    damaged("a whole number of values in " + name + ", from 0 to " + text(most) +
            " and there twice, got " + text(size.number) + " and " + text(-1.0 - size.again));
  return static_cast<size_t>(size.number);
}

void Archive::numbers(const std::string &name, double *values, size_t n)
{
  const size_t found = count(name, n, MOST_COUNTED / sizeof(double));
  if (found != n)
    damaged(std::to_string(n) + " values in " + name + ", got " + std::to_string(found));
  if (reads())
    get(values, n * sizeof(double));
  else
    put(values, n * sizeof(double));
}

void Archive::list(const std::string &name, std::vector<double> &values)
{
  const double follow = reads() ? static_cast<double>(end - at) - NAME - sizeof(Twice) : 0.0;
  values.resize(count(name, values.size(), follow / sizeof(double)));
  if (reads())
    get(values.data(), values.size() * sizeof(double));
  else
    put(values.data(), values.size() * sizeof(double));
}

void Archive::lines(const std::string &name, std::vector<std::string> &texts)
{
  std::vector<double> bytes;
  for (const std::string &line : texts) {
    bytes.insert(bytes.end(), line.begin(), line.end());
    bytes.push_back('\n');
  }
  list(name, bytes);
  if (!reads()) return;
  texts.clear();
  std::string line;
  for (const double byte : bytes) {
    if (!(byte >= -128.0 && byte < 128.0)) damaged("bytes in " + name + ", got " + text(byte));
    line += static_cast<char>(byte);
    if (line.back() != '\n') continue;
    line.pop_back();
    texts.push_back(line);
    line.clear();
  }
}

void Archive::same(const std::string &name, double value)
{
  double found = value;
  number(name, found);
  if (found != value)
    other_version("one with " + name + " " + text(found) + " in place of " + text(value));
}

void Archive::same(const std::string &what, const std::vector<Mark> &marks,
                   const std::function<std::string(const double *)> &text,
                   const std::string &remedy)
{
  std::vector<double> mine;
  for (const Mark &mark : marks) mine.push_back(mark.value);
  std::vector<double> found = mine;
  for (size_t k = 0; k < marks.size(); k++) number(marks[k].name, found[k]);
  if (memcmp(found.data(), mine.data(), mine.size() * sizeof(double)) != 0)
    throw std::runtime_error("the " + what + " must be that of the restart file, " +
                             text(found.data()) + "; got " + text(mine.data()) + remedy);
}

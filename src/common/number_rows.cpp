// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "number_rows.h"

#include "constants.h"
#include "decimal_number.h"
#include "text_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

using namespace Slope;

typedef std::vector<std::string> Words;

static constexpr double AMPLIFIED = 10.0;    // at most, up or down, beside a change of units

// letters of columns; lon and lat belong to no file of a deck

static const std::map<std::string, Words> NAMES = {
    {"t", {"t", "time", "times"}},
    {"x", {"x", "e", "east", "easting", "eastings", "ew", "e-w", "ax", "accx", "xcoord", "coordx"}},
    {"y",
     {"y", "n", "north", "northing", "northings", "ns", "n-s", "ay", "accy", "ycoord", "coordy"}},
    {"z",
     {"z", "h", "height", "elevation", "elev", "altitude", "alt", "ud", "u-d", "up", "az", "accz",
      "zcoord", "coordz"}},
    {"lon", {"lon", "long", "lng", "longitude"}},
    {"lat", {"lat", "latitude"}}};

static const Words FILLERS = {
    "a",         "in",     "and",   "unit",   "units",        "column",       "columns",
    "point",     "points", "coord", "coords", "coordinate",   "coordinates",  "position",
    "positions", "local",  "acc",   "accel",  "acceleration", "accelerations"};

// names of units, each with its value in that of the SI

typedef std::map<std::string, double> Units;

static const Units LENGTHS = {
    {"m", 1.0},       {"metre", 1.0},    {"metres", 1.0}, {"meter", 1.0},  {"meters", 1.0},
    {"km", 1e3},      {"cm", 0.01},      {"mm", 1e-3},    {"ft", 0.3048},  {"feet", 0.3048},
    {"foot", 0.3048}, {"us-ft", 0.3048}, {"deg", 0.0},    {"degree", 0.0}, {"degrees", 0.0}};
static const Units TIMES = {
    {"s", 1.0},   {"sec", 1.0},   {"secs", 1.0}, {"second", 1.0},       {"seconds", 1.0},
    {"ms", 1e-3}, {"msec", 1e-3}, {"min", 60.0}, {"millisecond", 1e-3}, {"milliseconds", 1e-3}};
static const Units ACCELERATIONS = {{"m/s2", 1.0},     {"m/s/s", 1.0},  {"ms-2", 1.0},
                                    {"gal", 0.01},     {"gals", 0.01},  {"cm/s2", 0.01},
                                    {"cm/s/s", 0.01},  {"cms-2", 0.01}, {"mm/s2", 1e-3},
                                    {"ft/s2", 0.3048}, {"g", GRAVITY}};
static const Words VELOCITIES = {"m/s", "cm/s", "mm/s", "kine"};

static bool is_of(const Words &list, const std::string &word)
{
  return std::find(list.begin(), list.end(), word) != list.end();
}

static void replace_all(std::string &text, const std::string &what, const std::string &by)
{
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

/* ----------------------------------------------------------------------
   in lower case, without signs of powers, brackets and commas
------------------------------------------------------------------------- */

static std::string plain(std::string text)
{
  static const char *const SPELLINGS[][2] = {
      {"\xef\xbc\x88", " "},
      {"\xef\xbc\x89", " "},    // brackets, comma and blank of full width
      {"\xef\xbc\x8c", " "},
      {"\xe3\x80\x80", " "},
      {"\xc2\xb2", "2"},
      {"\xc2\xb0", " deg "},
      {"**", ""},
      {"^", ""},
      {"/sec", "/s"},
      {" s-2", "/s2"}};
  const size_t colon = text.find_last_of(':');
  if (colon != std::string::npos) text.erase(0, colon + 1);
  for (char &c : text) {
    c = tolower((unsigned char) c);
    if (isspace((unsigned char) c) || strchr("()[],;\"'", c)) c = ' ';
  }
  for (const auto &one : SPELLINGS) replace_all(text, one[0], one[1]);
  return text;
}

static Words split(const std::string &text, const char *at)
{
  Words words;
  for (size_t from = 0, to; (from = text.find_first_not_of(at, from)) != std::string::npos;
       from = to) {
    to = std::min(text.find_first_of(at, from), text.size());
    words.push_back(text.substr(from, to - from));
  }
  return words;
}

namespace {

// what the words of a head say

struct Head {
  const TableColumns &columns;
  std::string letters;
  int names;
  bool wrong_unit;

  explicit Head(const TableColumns &_columns) : columns(_columns), names(0), wrong_unit(false) {}

  // scale may change the unit, and the amplitude beside
  bool is_right(double acceleration) const
  {
    const double beside = std::fabs(columns.scale) / acceleration;
    return acceleration == 1.0 ||
        (columns.scale != 1.0 && beside <= AMPLIFIED && beside >= 1.0 / AMPLIFIED);
  }

  bool take_unit(const std::string &word)
  {
    const bool motion = columns.letters[0] == 't';
    const auto length = LENGTHS.find(word), time = TIMES.find(word), a = ACCELERATIONS.find(word);
    if (length != LENGTHS.end())
      wrong_unit = wrong_unit || motion || length->second != 1.0;
    else if (motion && time != TIMES.end())
      wrong_unit = wrong_unit || time->second != 1.0;
    else if (motion && a != ACCELERATIONS.end())
      wrong_unit = wrong_unit || !is_right(a->second);
    else if (motion && is_of(VELOCITIES, word))
      wrong_unit = true;
    else
      return false;
    return true;
  }

  // false if the word belongs to no head
  bool take(const std::string &word)
  {
    for (const auto &one : NAMES)
      if (is_of(one.second, word)) {
        letters += one.first;
        names++;
        return true;
      }
    return take_unit(word) || is_of(FILLERS, word);
  }
};
}    // namespace

/* ---------------------------------------------------------------------- */

bool Slope::contradicts(const std::string &comment, const TableColumns &columns)
{
  Head head(columns);
  bool whole = true;
  for (const std::string &word : split(plain(comment), " ")) {
    // acc_x, easting_m, lat/lon
    bool known = head.take(word);
    const Words parts = split(word, "_/");
    if (!known && parts.size() > 1)
      known = std::all_of(parts.begin(), parts.end(), [&](const std::string &part) {
        return head.take(part);
      });
    whole = whole && known;
    if (!known) break;
  }
  if (head.names < (int) columns.letters.size() && !whole) return false;
  return (head.names > 1 && head.letters != columns.letters) || (columns.si && head.wrong_unit);
}

/* ---------------------------------------------------------------------- */

std::string TableColumns::rule() const
{
  return "columns must be " + names + (!si ? "" : letters[0] == 't' ? " in s and m/s2" : " in m");
}

static const char *const BLANK = " \t\r\v\f";

/* ----------------------------------------------------------------------
   all numbers of a line; false if there is anything else in it
------------------------------------------------------------------------- */

static bool parse(const std::string &text, std::vector<double> &values)
{
  values.clear();
  for (size_t at = text.find_first_not_of(BLANK); at != std::string::npos;) {
    if (!values.empty() && text[at] == ',') at = text.find_first_not_of(BLANK, at + 1);
    if (at == std::string::npos) return false;
    const size_t end = std::min(text.find_first_of(std::string(",") + BLANK, at), text.size());
    double value;
    if (!read_number(text.substr(at, end - at), value)) return false;
    values.push_back(value);
    at = text.find_first_not_of(BLANK, end);
  }
  return true;
}

// for messages

static std::string trimmed(const std::string &text)
{
  const size_t from = text.find_first_not_of(BLANK);
  return excerpt(from == std::string::npos
                     ? text
                     : text.substr(from, text.find_last_not_of(BLANK) - from + 1));
}

/* ---------------------------------------------------------------------- */

void Slope::read_number_rows(const std::string &path, const TableColumns &columns,
                             const std::function<void(const NumberRow &)> &take)
{
  const std::string text = text_of(path);
  NumberRow row = {0, false, {}};
  bool head = true;
  for (size_t pos = 0; pos < text.size();) {
    const size_t end = std::min(text.find('\n', pos), text.size());
    const std::string whole = text.substr(pos, end - pos);
    pos = end + 1;
    row.line++;
    const std::string content = whole.substr(0, whole.find('#'));
    const bool numbers = parse(content, row.values), comment = content != whole;
    if (numbers && row.values.empty()) {
      if (comment && head) {
        const std::string said = whole.substr(content.size() + 1);
        if (contradicts(said, columns))
          throw line_error(path, row.line, columns.rule() + ", got " + trimmed(said));
      }
      row.apart = row.apart || !comment;
      continue;
    }
    if (!numbers || row.values.size() != columns.letters.size())
      throw line_error(path, row.line,
                       "must be " + std::to_string(columns.letters.size()) + " numbers, " +
                           columns.names + ", got " + trimmed(content));
    take(row);
    row.apart = head = false;
  }
}

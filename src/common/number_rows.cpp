// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "number_rows.h"

#include "text_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

using namespace Slope;

static const char *const BLANK = " \t\r\v\f";

/* ----------------------------------------------------------------------
   all numbers of a line; false if there is anything else in it
------------------------------------------------------------------------- */

static bool parse(const std::string &text, std::vector<double> &values)
{
  const char *at = text.c_str(), *const stop = at + text.size();
  auto skip_blanks = [&]() {
    while (at != stop && isspace((unsigned char) *at)) at++;
  };
  values.clear();
  skip_blanks();
  while (at != stop) {
    if (!values.empty() && *at == ',') {
      at++;
      skip_blanks();
    }
    char *end;
    const double value = strtod(at, &end);
    if (end == at || !std::isfinite(value)) return false;
    if (end != stop && *end != ',' && !isspace((unsigned char) *end)) return false;
    values.push_back(value);
    at = end;
    skip_blanks();
  }
  return true;
}

/* ---------------------------------------------------------------------- */

std::vector<NumberRow> Slope::read_number_rows(const std::string &path, int count,
                                               const std::string &names)
{
  const std::string text = text_of(path);
  std::vector<NumberRow> rows;
  NumberRow row = {0, false, {}};
  for (size_t pos = 0; pos < text.size();) {
    const size_t end = std::min(text.find('\n', pos), text.size());
    const std::string whole = text.substr(pos, end - pos);
    pos = end + 1;
    row.line++;
    const std::string content = whole.substr(0, whole.find('#'));
    const bool numbers = parse(content, row.values);
    if (numbers && row.values.empty()) {
      row.apart = row.apart || content == whole;
      continue;
    }
    if (!numbers || (int) row.values.size() != count) {
      const size_t from = content.find_first_not_of(BLANK), to = content.find_last_not_of(BLANK);
      throw line_error(path, row.line,
                       "must be " + std::to_string(count) + " numbers, " + names + ", got " +
                           excerpt(content.substr(from, to - from + 1)));
    }
    rows.push_back(row);
    row.apart = false;
  }
  return rows;
}

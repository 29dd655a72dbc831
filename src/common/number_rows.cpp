// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "number_rows.h"

#include "decimal_number.h"
#include "text_file.h"

#include <algorithm>

using namespace Slope;

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

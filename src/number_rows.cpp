/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "number_rows.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace Slope;

/* ---------------------------------------------------------------------- */

std::runtime_error Slope::row_error(const std::string &path, int line, const std::string &what)
{
  return std::runtime_error(path + ", line " + std::to_string(line) + ": " + what);
}

std::string Slope::number_text(double value)
{
  char text[32];
  snprintf(text, sizeof(text), "%.10g", value);
  return text;
}

/* ---------------------------------------------------------------------- */

static std::string text_of(const std::string &path)
{
  FILE *fp = fopen(path.c_str(), "rb");
  if (!fp) throw std::runtime_error("cannot read " + path + ": " + strerror(errno));
  std::string text;
  std::vector<char> chunk(1 << 16);
  size_t n;
  while ((n = fread(chunk.data(), 1, chunk.size(), fp)) > 0) text.append(chunk.data(), n);
  const std::string reason = ferror(fp) ? strerror(errno) : "";
  fclose(fp);
  if (!reason.empty()) throw std::runtime_error("cannot read " + path + ": " + reason);
  if (text.compare(0, 3, "\xef\xbb\xbf") == 0) text.erase(0, 3);    // mark of UTF-8
  return text;
}

/* ----------------------------------------------------------------------
   what a message quotes: short and printable
------------------------------------------------------------------------- */

static std::string quoted(const std::string &text)
{
  std::string found = text.substr(0, 60);
  for (char &c : found)
    if (!isprint((unsigned char) c)) c = '?';
  return found;
}

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
  NumberRow row = {0, {}};
  for (size_t pos = 0; pos < text.size();) {
    const size_t end = std::min(text.find('\n', pos), text.size());
    const std::string whole = text.substr(pos, end - pos);
    pos = end + 1;
    row.line++;
    const std::string content = whole.substr(0, whole.find('#'));
    const bool numbers = parse(content, row.values);
    if (numbers && row.values.empty()) continue;
    if (!numbers || (int) row.values.size() != count)
      throw row_error(
          path, row.line,
          "must be " + std::to_string(count) + " numbers, " + names + ", got " +
              quoted(content.substr(std::min(content.find_first_not_of(" \t\r"), content.size()))));
    rows.push_back(row);
  }
  return rows;
}

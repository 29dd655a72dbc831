// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "text_file.h"

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

static constexpr size_t LONGEST = 40;    // excerpt

std::string Slope::bytes_of(const std::string &path)
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
  return text;
}

size_t Slope::text_start(const std::string &bytes)
{
  return bytes.compare(0, 3, "\xef\xbb\xbf") == 0 ? 3 : 0;
}

std::string Slope::text_of(const std::string &path)
{
  std::string text = bytes_of(path);
  text.erase(0, text_start(text));
  return text;
}

std::runtime_error Slope::line_error(const std::string &path, int line, const std::string &what)
{
  return std::runtime_error(path + ", line " + std::to_string(line) + ": " + what);
}

std::string Slope::excerpt(const std::string &text)
{
  std::string found = text.substr(0, LONGEST);
  for (char &c : found)
    if (!isprint((unsigned char) c)) c = '?';
  return found;
}

std::string Slope::counted(double number, const std::string &what)
{
  char text[32];
  snprintf(text, sizeof(text), "%.0f ", number);
  return text + what + (number == 1.0 ? "" : "s");
}

std::string Slope::number_text(double value)
{
  char text[32];
  snprintf(text, sizeof(text), "%.10g", value);
  return text;
}

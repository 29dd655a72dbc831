// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "stl_file.h"

#include "decimal_number.h"
#include "text_file.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

using namespace Slope;

static constexpr size_t HEADER = 84, RECORD = 50;    // bytes of a binary file
static constexpr double FLAT = 1.0e-7;    // height over longest side of a triangle without an area

/* ---------------------------------------------------------------------- */

static bool is_space(char c)
{
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

// the file's numbers are little-endian
static uint32_t number_at(const std::string &bytes, size_t at)
{
  uint32_t value = 0;
  for (int k = 3; k >= 0; k--) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

static float float_at(const std::string &bytes, size_t at)
{
  const uint32_t bits = number_at(bytes, at);
  float value;
  memcpy(&value, &bits, sizeof(value));
  return value;
}

/* ---------------------------------------------------------------------- */

static bool begins_with_solid(const std::string &bytes)
{
  size_t k = text_start(bytes);
  while (k < bytes.size() && is_space(bytes[k])) k++;
  for (const char *c = "solid"; *c; c++, k++)
    if (k >= bytes.size() || (bytes[k] | 0x20) != *c) return false;
  return k == bytes.size() || is_space(bytes[k]);
}

/* ---------------------------------------------------------------------- */

static bool is_elevation_grid(const std::string &bytes)
{
  size_t k = text_start(bytes);
  while (k < bytes.size() && is_space(bytes[k])) k++;
  std::string word;
  for (; k < bytes.size() && word.size() < 5; k++) word += static_cast<char>(bytes[k] | 0x20);
  return word == "ncols" || word == "nrows";
}

/* ---------------------------------------------------------------------- */

static std::vector<Triangle> read_binary(const std::string &path, const std::string &bytes)
{
  const size_t n = number_at(bytes, 80);
  std::vector<Triangle> list(n);
  for (size_t k = 0; k < n; k++) {
    double v[9];
    for (int c = 0; c < 9; c++) {
      v[c] = float_at(bytes, HEADER + RECORD * k + 12 + 4 * c);
      if (!std::isfinite(v[c]))
        throw std::runtime_error(path + ", triangle " + std::to_string(k + 1) +
                                 ": coordinates must be finite numbers, got " + number_text(v[c]));
    }
    list[k] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
  }
  return list;
}

/* ----------------------------------------------------------------------
   words of a text file, in lower case, and the lines that they are in
------------------------------------------------------------------------- */

namespace {
class Words {
 public:
  Words(const std::string &_path, const std::string &_text) :
      path(_path), text(_text), at(text_start(_text)), line(1)
  {
  }

  bool next(std::string &word)    // false at the end
  {
    for (; at < text.size() && is_space(text[at]); at++) line += text[at] == '\n';
    word.clear();
    for (; at < text.size() && !is_space(text[at]); at++) {
      const char c = text[at];
      word += c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
    }
    return !word.empty();
  }

  void rest_of_line()
  {
    while (at < text.size() && text[at] != '\n') at++;
  }

  void expect(const char *what)
  {
    std::string word;
    if (!next(word)) end(what);
    if (word == what) return;
    if (at == text.size() && std::string(what).compare(0, word.size(), word) == 0) end(what);
    fail(std::string(what) + " is expected here, got " + excerpt(word));
  }

  double number(const char *what)
  {
    std::string word;
    if (!next(word)) end(what);
    double value;
    if (!read_number(word, value))
      fail(std::string(what) + " must be a finite number, got " + excerpt(word));
    return value;
  }

  std::runtime_error error(const std::string &what) const { return line_error(path, line, what); }
  void fail(const std::string &what) const { throw error(what); }
  void end(const char *what) const
  {
    throw error(std::string("the file is cut short: it ends where ") + what + " is expected");
  }

 private:
  const std::string &path, &text;
  size_t at;
  int line;
};
}    // namespace

/* ---------------------------------------------------------------------- */

static Triangle read_facet(Words &words)
{
  words.expect("normal");
  std::string unused;
  for (int k = 0; k < 3; k++)    // some programs write nan
    if (!words.next(unused)) words.end("a normal");
  words.expect("outer");
  words.expect("loop");
  double v[9];
  for (int c = 0; c < 9; c++) {
    if (c % 3 == 0) words.expect("vertex");
    v[c] = words.number("a coordinate");
  }
  words.expect("endloop");
  words.expect("endfacet");
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
}

static std::vector<Triangle> read_text(const std::string &path, const std::string &text)
{
  std::vector<Triangle> list;
  Words words(path, text);
  std::string word;
  while (words.next(word)) {    // a solid
    if (word != "solid") words.fail("solid is expected here, got " + excerpt(word));
    words.rest_of_line();    // its name
    while (true) {
      if (!words.next(word)) words.end("facet or endsolid");
      if (word == "endsolid") break;
      if (word != "facet") words.fail("facet or endsolid is expected here, got " + excerpt(word));
      list.push_back(read_facet(words));
    }
    words.rest_of_line();
  }
  return list;
}

/* ---------------------------------------------------------------------- */

static Vector placed(const Vector &v, double scale, const Vector &move)
{
  return {scale * v.x + move.x, scale * v.y + move.y, scale * v.z + move.z};
}

// half the distance of a float to the next one, for the largest coordinate
static double rounding_of(const std::vector<Triangle> &list)
{
  double most = 0.0;
  for (const Triangle &t : list)
    for (const Vector *v : {&t.a, &t.b, &t.c})
      most = std::max({most, std::fabs(v->x), std::fabs(v->y), std::fabs(v->z)});
  return most > 0.0 ? std::ldexp(0.5, std::ilogb(most) - (FLT_MANT_DIG - 1)) : 0.0;
}

/* ---------------------------------------------------------------------- */

StlFile StlFile::read(const std::string &path, double scale, const Vector &move)
{
  const std::string bytes = bytes_of(path);
  const size_t n = bytes.size() < HEADER ? 0 : number_at(bytes, 80);
  const bool fits = bytes.size() >= HEADER && bytes.size() == HEADER + RECORD * n;
  StlFile file;
  const bool text = begins_with_solid(bytes) && bytes.find('\0') == std::string::npos;
  const bool binary = fits || !text;
  if (!fits && is_elevation_grid(bytes))
    throw std::runtime_error(path + ": must be an STL file, got an elevation grid: terrain " +
                             path + " takes one");
  if (binary && bytes.size() < HEADER)
    throw std::runtime_error(path +
                             ": an STL file begins with solid, or has at least 84 bytes, got " +
                             std::to_string(bytes.size()));
  if (binary && bytes.size() < HEADER + RECORD * n)
    throw std::runtime_error(path +
                             ": the file is cut short, or no STL: " + counted(n, "triangle") +
                             (n == 1 ? " needs " : " need ") + std::to_string(HEADER + RECORD * n) +
                             " bytes, got " + std::to_string(bytes.size()));
  const std::vector<Triangle> all = binary ? read_binary(path, bytes) : read_text(path, bytes);

  file.surplus = binary ? static_cast<double>(bytes.size() - HEADER - RECORD * n) : 0.0;
  file.rounding = binary ? scale * rounding_of(all) : 0.0;
  file.skipped = 0;
  for (const Triangle &t : all) {
    const double side = t.longest_side();
    if (!(2.0 * t.area() > FLAT * side * side))
      file.skipped++;
    else
      file.triangles.push_back(
          {placed(t.a, scale, move), placed(t.b, scale, move), placed(t.c, scale, move)});
  }
  if (file.triangles.empty())
    throw std::runtime_error(
        path + ": there must be a triangle with an area, got " +
        (all.empty() ? std::string("no triangles") : std::to_string(all.size()) + " without"));
  return file;
}

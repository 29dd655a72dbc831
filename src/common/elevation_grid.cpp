// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "elevation_grid.h"

#include "atomic_file.h"
#include "free_memory.h"
#include "text_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <sys/stat.h>

using namespace Slope;

static constexpr double NODATA = -9999.0;    // in a file whose header names no other
static const double NaN = std::numeric_limits<double>::quiet_NaN();

static const double POWER[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                               1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

namespace {

// as few digits as keep the value

std::string exact(double value)
{
  char text[32];
  snprintf(text, sizeof(text), "%.15g", value);
  if (strtod(text, nullptr) != value) snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

// Linux gives more memory than there is, and kills who uses it: what cannot fit is refused before

void check_memory(const std::string &what, double need)
{
  const double have = free_memory();
  char text[80];
  snprintf(text, sizeof(text), " need %.3g GB of memory, %.3g GB are free", 1e-9 * need,
           1e-9 * have);
  if (need > have) throw std::runtime_error(what + text);
}

bool ends_word(char c)
{
  return c == '\0' || isspace((unsigned char) c);
}

// strtod of a decimal number; for the usual heights by whole numbers and then four times as fast: up to 15 digits and
// a power of ten are exact, so that their quotient is what strtod gives

double parse(const char *text, char **end)
{
  const char *c = text;
  const bool negative = *c == '-';
  if (negative) c++;
  long long number = 0;
  int digits = 0, decimals = 0;
  for (; *c >= '0' && *c <= '9' && digits <= 15; c++, digits++) number = 10 * number + (*c - '0');
  if (digits > 0 && *c == '.')
    for (c++; *c >= '0' && *c <= '9' && digits <= 15; c++, digits++, decimals++)
      number = 10 * number + (*c - '0');
  if (digits == 0 || digits > 15 || !ends_word(*c)) {
    const char *first = text + (*text == '-' || *text == '+');
    if (*first != '0' || tolower((unsigned char) first[1]) != 'x') return strtod(text, end);
    *end = const_cast<char *>(text);    // hexadecimal
    return 0.0;
  }
  *end = const_cast<char *>(c);
  const double value = number / POWER[decimals];
  return negative ? -value : value;
}

// The text of a grid file, taken word by word. Lines are counted only when an error asks for the
// number, so that they cost nothing.

class GridText {
 public:
  explicit GridText(const std::string &_path) : path(_path), pos(0), last(0)
  {
    struct stat info;
    const bool known = stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode);
    check_memory(path + ": its text would", known ? info.st_size : 0);
    text = bytes_of(path);
    pos = text_start(text);
  }

  size_t size() const { return text.size(); }

  bool at_end()
  {
    while (pos < text.size() && isspace((unsigned char) text[pos])) pos++;
    return pos == text.size();
  }

  // the next word if it is a number; if not, it is still the next word
  bool number(double &value)
  {
    if (at_end()) return false;
    char *end;
    value = parse(&text[pos], &end);
    if (end == &text[pos] || !ends_word(*end)) return false;
    last = pos;
    pos = end - &text[0];
    return true;
  }

  bool at_number()
  {
    const size_t here = pos, before = last;
    double value;
    const bool found = number(value);
    pos = here;
    last = before;
    return found;
  }

  std::string word()
  {
    if (at_end()) return "the end of the file";
    last = pos;
    while (pos < text.size() && !isspace((unsigned char) text[pos])) pos++;
    return excerpt(text.substr(last, pos - last));
  }

  // one line: file, line of the word that was taken last, what is wrong
  std::runtime_error error(const std::string &what) const
  {
    const auto line = 1 + std::count(text.begin(), text.begin() + last, '\n');
    return std::runtime_error(path + ", line " + std::to_string(line) + ": " + what);
  }

 private:
  std::string path, text;
  size_t pos, last;
};

struct Header {
  int nx, ny;
  double xlo, ylo, cell, nodata;
};

// key value pairs up to the first word that is a number

Header read_header(GridText &text)
{
  std::map<std::string, double> header;
  while (!text.at_end() && !text.at_number()) {
    const std::string key = text.word();
    std::string name = key;
    std::transform(name.begin(), name.end(), name.begin(), tolower);
    if (name != "ncols" && name != "nrows" && name != "xllcorner" && name != "xllcenter" &&
        name != "yllcorner" && name != "yllcenter" && name != "cellsize" && name != "nodata_value")
      throw text.error("must be a header key of an ESRI ASCII grid or a number, got " + key);

    double value;
    if (!text.number(value)) throw text.error(key + " must be a number, got " + text.word());
    if (!std::isfinite(value) && name != "nodata_value")
      throw text.error(key + " must be finite, got " + number_text(value));
    if ((name == "ncols" || name == "nrows") && (value < 1.0 || value != std::floor(value)))
      throw text.error(key + " must be a whole number >= 1, got " + number_text(value));
    if (name == "cellsize" && value <= 0.0)
      throw text.error(key + " must be > 0, got " + number_text(value));
    for (const std::string axis : {"xll", "yll"})
      for (const bool center : {false, true})
        if (name == axis + (center ? "center" : "corner") &&
            header.count(axis + (center ? "corner" : "center")))
          throw text.error(axis + "corner and " + axis + "center are both given");
    if (header.count(name)) throw text.error("header key " + key + " is given twice");
    header[name] = value;
  }

  for (const char *name : {"ncols", "nrows", "cellsize"})
    if (!header.count(name)) throw text.error(std::string("header key ") + name + " is missing");

  const double ncells = header["ncols"] * header["nrows"];
  if (ncells > ElevationGrid::MAXCELLS)
    throw text.error(number_text(header["ncols"]) + " x " + number_text(header["nrows"]) +
                     " cells would need " + number_text(std::round(8e-9 * ncells)) +
                     " GB of memory, at most " + number_text(ElevationGrid::MAXCELLS) +
                     " cells are possible");

  Header found;
  found.nx = (int) header["ncols"];
  found.ny = (int) header["nrows"];
  found.cell = header["cellsize"];
  found.nodata = header.count("nodata_value") ? header["nodata_value"] : NODATA;

  // the lower left corner of the raster is half a cell from the centre of its first cell

  for (const char axis : {'x', 'y'}) {
    const std::string corner = std::string(1, axis) + "llcorner";
    const std::string center = std::string(1, axis) + "llcenter";
    if (!header.count(corner) && !header.count(center))
      throw text.error("header key " + corner + " (or " + center + ") is missing");
    (axis == 'x' ? found.xlo : found.ylo) =
        header.count(corner) ? header[corner] : header[center] - 0.5 * found.cell;
  }
  return found;
}

// %.*g, for the usual heights by whole numbers and then ten times as fast; digits <= 15 there

void append(std::string &row, double value, int digits)
{
  const double size = std::fabs(value);
  char text[32];
  if (digits > 15 || size < 1.0 || size >= POWER[digits]) {
    row.append(text, snprintf(text, sizeof(text), "%.*g", digits, value));
    return;
  }

  int whole = 1;
  while (size >= POWER[whole]) whole++;
  int decimals = digits - whole;
  long long number = std::llround(size * POWER[decimals]);
  while (decimals > 0 && number % 10 == 0) {
    number /= 10;
    decimals--;
  }
  char *begin = text + sizeof(text);
  for (int k = 0; number > 0; k++) {
    if (k > 0 && k == decimals) *--begin = '.';
    *--begin = '0' + number % 10;
    number /= 10;
  }
  if (value < 0.0) *--begin = '-';
  row.append(begin, text + sizeof(text) - begin);
}

// f = 0 is a and 1 is b, even if the other one is NaN

double between(double a, double b, double f)
{
  if (f == 0.0) return a;
  if (f == 1.0) return b;
  return a + f * (b - a);
}

}    // namespace

/* ---------------------------------------------------------------------- */

ElevationGrid::ElevationGrid(int _nx, int _ny, double _xlo, double _ylo, double _cell,
                             double value) :
    nx(_nx),
    ny(_ny), xlo(_xlo), ylo(_ylo), cell(_cell), z((size_t) _nx * _ny, value), elsewhere(nullptr)
{
}

void ElevationGrid::refer_to(const double *values)
{
  elsewhere = values;
  std::vector<double>().swap(z);
}

/* ---------------------------------------------------------------------- */

ElevationGrid ElevationGrid::read(const std::string &path)
{
  GridText text(path);
  if (text.at_end()) throw std::runtime_error(path + " is empty");
  const Header header = read_header(text);

  const std::string size =
      std::to_string(header.ny) + " rows x " + std::to_string(header.nx) + " columns";
  const size_t ncells = (size_t) header.nx * header.ny;
  ElevationGrid grid(0, 0, header.xlo, header.ylo, header.cell, NaN);
  grid.nx = header.nx;
  grid.ny = header.ny;

  // a value and what separates it are two bytes: a short file cannot ask for a lot of memory

  const size_t most = std::min(ncells, text.size() / 2 + 1);
  check_memory(path + ": " + size, text.size() + 8.0 * most);
  grid.z.reserve(most);

  // a NODATA value beyond any height may have been rounded, as in -3.40282e+38

  const double nodata = header.nodata;
  const double tolerance = std::fabs(nodata) > 1e30 ? 1e-5 * std::fabs(nodata) : 0.0;

  bool any = false;
  while (grid.z.size() < ncells) {
    double value;
    if (!text.number(value)) {
      if (text.at_end())
        throw text.error("only " + std::to_string(grid.z.size()) + " of " + std::to_string(ncells) +
                         " values (" + size + ")");
      const std::string word = text.word();
      throw text.error("height must be a number, got " + word);
    }
    if (value == nodata || std::fabs(value - nodata) <= tolerance ||
        (std::isnan(value) && std::isnan(nodata)))
      value = NaN;
    else if (!std::isfinite(value))
      throw text.error("height must be finite, got " + number_text(value));
    else
      any = true;
    grid.z.push_back(value);
  }

  if (!text.at_end()) {
    const std::string word = text.word();
    throw text.error("more than " + std::to_string(ncells) + " values (" + size + "), next is " +
                     word);
  }
  if (!any)
    throw std::runtime_error(path + ": all " + std::to_string(ncells) + " values are NODATA");

  // the file begins in the north

  const auto row = [&](int j) {
    return grid.z.begin() + (size_t) j * grid.nx;
  };
  for (int j = 0; j < grid.ny / 2; j++) std::swap_ranges(row(j), row(j + 1), row(grid.ny - 1 - j));
  return grid;
}

/* ---------------------------------------------------------------------- */

void ElevationGrid::write(AtomicFile &file, int digits) const
{
  file.write(header(nx, ny, xlo, ylo, cell));
  std::string text;
  for (int j = ny - 1; j >= 0; j--) {
    text.clear();
    append_row(text, values() + (size_t) j * nx, nx, digits);
    file.write(text);
  }
}

/* ---------------------------------------------------------------------- */

std::string ElevationGrid::header(int nx, int ny, double xlo, double ylo, double cell)
{
  return "ncols " + std::to_string(nx) + "\nnrows " + std::to_string(ny) + "\nxllcorner " +
      exact(xlo) + "\nyllcorner " + exact(ylo) + "\ncellsize " + exact(cell) +
      "\nNODATA_value -9999\n";
}

/* ---------------------------------------------------------------------- */

void ElevationGrid::append_row(std::string &text, const double *row, int nx, int digits)
{
  for (int i = 0; i < nx; i++) {
    if (row[i] == 0.0)
      text += '0';    // most cells of a deposit
    else if (std::isnan(row[i]))
      text += "-9999";
    else
      append(text, row[i], digits);
    text += i + 1 < nx ? ' ' : '\n';
  }
}

/* ---------------------------------------------------------------------- */

double ElevationGrid::height(double x, double y) const
{
  if (!(x >= xlo && x <= xhi() && y >= ylo && y <= yhi())) return NaN;

  // in units of cells from the centre of the first one: -0.5 to n - 0.5

  const double u = (x - xlo) / cell - 0.5;
  const double v = (y - ylo) / cell - 0.5;
  const int i = std::max(0, std::min(nx - 2, (int) std::floor(u)));
  const int j = std::max(0, std::min(ny - 2, (int) std::floor(v)));
  const double fx = nx > 1 ? u - i : 0.0;
  const double fy = ny > 1 ? v - j : 0.0;

  // a raster of one column or row is constant across it

  const double *south = values() + (size_t) j * nx + i;
  const double *north = ny > 1 ? south + nx : south;
  const int east = nx > 1 ? 1 : 0;
  return between(between(south[0], south[east], fx), between(north[0], north[east], fx), fy);
}

/* ----------------------------------------------------------------------
   A NODATA centre makes height() NaN in the open square of two cells' width around it, and in
   the second column or row from the edge also in the rim, which is extrapolated from it
------------------------------------------------------------------------- */

bool ElevationGrid::nodata_within(double x, double y, double r) const
{
  const double u = (x - xlo) / cell - 0.5;
  const double v = (y - ylo) / cell - 0.5;
  const double reach = r / cell;

  // as a double up to here: far from the raster it is more than an int holds

  auto within = [](double at, int n) {
    return (int) std::max(-1.0, std::min((double) n, at));
  };
  const int ilo = std::max(0, within(std::floor(u - reach - 1.5), nx));
  const int ihi = std::min(nx - 1, within(std::ceil(u + reach + 1.5), nx));
  const int jlo = std::max(0, within(std::floor(v - reach - 1.5), ny));
  const int jhi = std::min(ny - 1, within(std::ceil(v + reach + 1.5), ny));

  // distance from a coordinate to the area that one NODATA centre makes unknown

  auto distance = [](double at, int i, int n) {
    const double lo = i <= 1 ? -0.5 : i - 1;
    const double hi = i >= n - 2 ? n - 0.5 : i + 1;
    return std::max(0.0, std::max(lo - at, at - hi));
  };

  for (int j = jlo; j <= jhi; j++)
    for (int i = ilo; i <= ihi; i++) {
      if (!std::isnan(at(i, j))) continue;
      const double du = distance(u, i, nx), dv = distance(v, j, ny);
      if (du * du + dv * dv < reach * reach) return true;
    }
  return false;
}

/* ---------------------------------------------------------------------- */

double ElevationGrid::zmin() const
{
  double found = NaN;
  for (const double *v = values(), *end = v + (size_t) nx * ny; v < end; v++)
    if (!(*v >= found) && !std::isnan(*v)) found = *v;
  return found;
}

/* ---------------------------------------------------------------------- */

double ElevationGrid::zmax() const
{
  double found = NaN;
  for (const double *v = values(), *end = v + (size_t) nx * ny; v < end; v++)
    if (!(*v <= found) && !std::isnan(*v)) found = *v;
  return found;
}

/* ---------------------------------------------------------------------- */

int ElevationGrid::count_nodata() const
{
  return std::count_if(values(), values() + (size_t) nx * ny, [](double value) {
    return std::isnan(value);
  });
}

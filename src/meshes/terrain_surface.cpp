// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "terrain_surface.h"

#include "constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

using namespace Slope;

static constexpr double MOST = std::numeric_limits<int>::max() / 4;    // corners

/* ---------------------------------------------------------------------- */

TerrainSurface::TerrainSurface(const ElevationGrid &grid, const std::string &name) :
    about_{grid.nx + 2,
           grid.ny + 2,
           grid.xlo,
           grid.ylo,
           grid.xhi(),
           grid.yhi(),
           grid.cell,
           {grid.xlo, grid.ylo, HUGE_VAL},
           {grid.xhi(), grid.yhi(), -HUGE_VAL},
           0.0,
           0}
{
  if (static_cast<double>(about_.nx) * about_.ny > MOST)
    throw std::runtime_error(name + ": a smooth ground must have at most " +
                             std::to_string(static_cast<int>(MOST)) + " cells, got " +
                             std::to_string(grid.nx) + " times " + std::to_string(grid.ny));
  fill(grid);
  measure();
  if (about_.missing == (about_.nx - 1) * (about_.ny - 1))
    throw std::runtime_error(name +
                             ": a smooth ground needs four neighbor cells with a value, got none");
}

// the rim: from the two cells beside it, or as high as the only one

void TerrainSurface::fill(const ElevationGrid &grid)
{
  const int nx = about_.nx, ny = about_.ny;
  own.resize(static_cast<size_t>(nx) * ny);
  z = own.data();
  auto at = [&](int i, int j) -> double & {
    return own[static_cast<size_t>(j) * nx + i];
  };
  auto beyond = [](double first, double second) {
    return std::isfinite(second) ? first - 0.5 * (second - first) : first;
  };
  for (int j = 1; j + 1 < ny; j++) {
    for (int i = 1; i + 1 < nx; i++) at(i, j) = grid.at(i - 1, j - 1);
    at(0, j) = nx > 3 ? beyond(at(1, j), at(2, j)) : at(1, j);
    at(nx - 1, j) = nx > 3 ? beyond(at(nx - 2, j), at(nx - 3, j)) : at(1, j);
  }
  for (int i = 0; i < nx; i++) {
    at(i, 0) = ny > 3 ? beyond(at(i, 1), at(i, 2)) : at(i, 1);
    at(i, ny - 1) = ny > 3 ? beyond(at(i, ny - 2), at(i, ny - 3)) : at(i, 1);
  }
}

void TerrainSurface::measure()
{
  for (int j = 0; j + 1 < about_.ny; j++)
    for (int i = 0; i + 1 < about_.nx; i++) {
      double zmin, zmax;
      if (!quadrangle(i, j, zmin, zmax)) {
        about_.missing++;
        continue;
      }
      about_.lowest.z = std::min(about_.lowest.z, zmin);
      about_.highest.z = std::max(about_.highest.z, zmax);
      const double turns = GOLDEN * (1.0 + i + 3.0 * j);
      about_.sum += (1.0 + turns - std::floor(turns)) * (zmin + 2.0 * zmax + 1.0);
    }
}

/* ---------------------------------------------------------------------- */

double TerrainSurface::place(int i, int n, double lo, double hi, double cell)
{
  return i == 0 ? lo : i == n - 1 ? hi : lo + (i - 0.5) * cell;
}

// the corners between which x is: this one and the next
int TerrainSurface::index_of(double x, int n, double lo, double cell)
{
  const double at = std::floor((x - lo) / cell + 0.5);
  return static_cast<int>(std::max(0.0, std::min(at, n - 2.0)));
}

Vector TerrainSurface::corner(int i, int j) const
{
  const About &a = about_;
  return {place(i, a.nx, a.xlo, a.xhi, a.cell), place(j, a.ny, a.ylo, a.yhi, a.cell),
          z[static_cast<size_t>(j) * a.nx + i]};
}

// lowest and highest corner; false if one has no value
bool TerrainSurface::quadrangle(int i, int j, double &zmin, double &zmax) const
{
  const double *row = &z[static_cast<size_t>(j) * about_.nx + i], *next = row + about_.nx;
  if (!std::isfinite(row[0] + row[1] + next[0] + next[1])) return false;
  zmin = std::min(std::min(row[0], row[1]), std::min(next[0], next[1]));
  zmax = std::max(std::max(row[0], row[1]), std::max(next[0], next[1]));
  return true;
}

/* ---------------------------------------------------------------------- */

Triangle TerrainSurface::triangle(int number) const
{
  const int quad = number / 2, i = quad % (about_.nx - 1), j = quad / (about_.nx - 1);
  const Vector a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
               d = corner(i, j + 1);
  const bool second = number % 2;
  if (std::fabs(a.z - c.z) <= std::fabs(b.z - d.z))
    return second ? Triangle{a, c, d} : Triangle{a, b, c};
  return second ? Triangle{b, c, d} : Triangle{a, b, d};
}

/* ---------------------------------------------------------------------- */

void TerrainSurface::find_near(const Vector &x, double reach, std::vector<int> &numbers) const
{
  const int nx = about_.nx, ny = about_.ny;
  const double xlo = about_.xlo, ylo = about_.ylo, cell = about_.cell;
  if (x.x < xlo - reach || x.x > about_.xhi + reach || x.y < ylo - reach ||
      x.y > about_.yhi + reach)
    return;
  const int ilo = index_of(x.x - reach, nx, xlo, cell), ihi = index_of(x.x + reach, nx, xlo, cell);
  const int jlo = index_of(x.y - reach, ny, ylo, cell), jhi = index_of(x.y + reach, ny, ylo, cell);
  for (int j = jlo; j <= jhi; j++)
    for (int i = ilo; i <= ihi; i++) {
      double zmin, zmax;
      if (!quadrangle(i, j, zmin, zmax) || zmin > x.z + reach || zmax < x.z - reach) continue;
      const int first = 2 * (j * (nx - 1) + i);
      numbers.push_back(first);
      numbers.push_back(first + 1);
    }
}

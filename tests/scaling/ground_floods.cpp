/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Floods of scattered ground at its widest spacing: does a ball of the same size find a way through? Not a test of its own.

     cmake --build build --target ground_floods
     build/tests/ground_floods N [TERRAIN.asc ...]

   N seeds on each of: planes of 0 to 80 degrees, cones, pits, cliffs, a release with a scarp; and N windows of each terrain, with
   balls of 0.3 to 3 of its cells. Prints each way that is found; exit status 1 if there is one. */

#include "ball_flood.h"
#include "elevation_grid.h"
#include "scattered_sampler.h"
#include "surface_gaps.h"
#include "surface_sampler.h"

#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

using namespace Slope;

static constexpr double SIDE = 14.0;    // balls, of a window
static int floods = 0, ways = 0;

static std::vector<double> places(BallSampler &&sampler)
{
  std::vector<PlacedBall> balls;
  SurfaceCounts counts;
  const TilePlan tiles = sampler.tiles();
  for (int tile = 0; tile < tiles.nx * tiles.ny; tile++) sampler.sample(tile, balls, counts);
  std::vector<double> xyz;
  for (const PlacedBall &b : balls) xyz.insert(xyz.end(), {b.x, b.y, b.z});
  return xyz;
}

static void flood(const std::string &what, const GroundHeights &s, uint64_t seed, const GroundHeights *below = nullptr)
{
  const double spacing = ScatteredSampler::WIDEST * 2.0 * R;
  std::vector<double> xyz = places(ScatteredSampler({0.0, SIDE, 0.0, SIDE, spacing, 0.3, 0.1}, s, seed));
  if (below) {
    const auto more = places(SurfaceSampler({0.0, SIDE, 0.0, SIDE, R, 0.3, 0.1}, R, *below));
    xyz.insert(xyz.end(), more.begin(), more.end());
  }
  double zlo = HUGE_VAL, zhi = -HUGE_VAL;
  for (size_t k = 2; k < xyz.size(); k += 3) {
    zlo = std::min(zlo, xyz[k]);
    zhi = std::max(zhi, xyz[k]);
  }
  const double rim = below ? 0.5 : 1.0;
  floods++;
  if (!ball_gets_through(xyz, 2.0 * R, {{rim, rim, zlo - 2.0}}, {{SIDE - rim, SIDE - rim, zhi + 2.0}})) return;
  ways++;
  std::printf("a way through %s, seed %d\n", what.c_str(), static_cast<int>(seed));
}

static void shapes(uint64_t seed)
{
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int degrees = 0; degrees <= 80; degrees += 10)
    flood("a plane of " + std::to_string(degrees), plane(degrees, 360.0 * unit(random)), seed);
  const double g = std::tan((30.0 + 50.0 * unit(random)) * PI / 180.0), x0 = 7.0 + unit(random), high = 12.0 * unit(random);
  const double across = unit(random);
  GroundHeights cone, pit, cliff, field, slip;
  cone.height = [=](double x, double y, double &z) {
    z = -g * std::hypot(x - x0, y - 7.2);
    return true;
  };
  pit.height = [=](double x, double y, double &z) {
    z = g * std::min(std::hypot(x - x0, y - 6.8), 4.0);
    return true;
  };
  cliff.height = [=](double x, double y, double &z) {
    z = 0.3 * y + (x + across * y < x0 ? 0.0 : high);
    return true;
  };
  flood("a cone", cone, seed);
  flood("a pit", pit, seed);
  flood("a cliff", cliff, seed);
  const double depth = 1.0 + 5.0 * unit(random);
  field.height = [=](double x, double y, double &z) {
    z = across * x + 0.2 * y;
    return true;
  };
  slip.height = [=](double x, double y, double &z) {
    z = across * x - depth + 0.4 * (y - 5.0);
    return std::fabs(x - x0) < 3.0 && std::fabs(y - 7.0 - across * x / 4.0) < 2.5 && z <= across * x + 0.2 * y;
  };
  field.keep = [=](double x, double y) {
    double z;
    return !slip.height(x, y, z);
  };
  field.scar = slip.height;
  flood("a release", field, seed, &slip);
}

int main(int narg, char **arg)
{
  const int n = narg > 1 ? std::atoi(arg[1]) : 10;
  for (int seed = 1; seed <= n; seed++) shapes(seed);
  for (int k = 2; k < narg; k++) {
    const ElevationGrid grid = ElevationGrid::read(arg[k]);
    std::mt19937 random(k);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double wide = grid.xhi() - grid.xlo, high = grid.yhi() - grid.ylo;
    for (int seed = 1; seed <= n; seed++) {
      const double d = grid.cell * std::pow(10.0, -0.5 + unit(random));
      const double x0 = grid.xlo + unit(random) * (wide - SIDE * d), y0 = grid.ylo + unit(random) * (high - SIDE * d);
      GroundHeights s;    // in diameters
      s.height = [&grid, d, x0, y0](double x, double y, double &z) {
        z = grid.height(x0 + d * x, y0 + d * y) / d;
        return z == z;
      };
      flood(arg[k], s, seed);
    }
  }
  std::printf("%d floods, %d ways\n", floods, ways);
  return ways > 0;
}

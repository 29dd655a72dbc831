// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Fixed balls, as many of them as somebody has come near: tiles of the plan whose balls are made
   when they are first looked for, sorted into cells, and may be dropped again. No LAMMPS. */

#ifndef SLOPE_BALL_TILES_H
#define SLOPE_BALL_TILES_H

#include "ball_sampler.h"
#include "vector3.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace Slope {

class BallTiles {
 public:
  // append the balls of a tile, always the same ones
  typedef std::function<void(int tile, std::vector<PlacedBall> &balls)> Make;

  BallTiles(const TilePlan &plan, double diameter, const Make &make);

  // call visit(k, distance^2) for every ball k closer to x than reach; makes the tiles there
  template <typename Visit> void visit_near(const double *x, double reach, Visit visit);

  // balls are known by k until drop_unused(); 32 bytes may be read at the last place
  const Vector *places() const { return place.data(); }
  int64_t number(int k) const { return numbers[k]; }
  int zone(int k) const { return zones[k]; }

  // Between lists of neighbors: drop the tiles that none of the last lists asked for, if their balls
  // are more than half of all. Balls change their k. A single tile is kept.
  void drop_unused();

  int made() const { return static_cast<int>(tiles.size()); }
  double memory_usage() const;

 private:
  const TilePlan plan;
  const double diameter;
  const Make make;

  struct Tile {
    int number;                // in the plan
    size_t begin, end;         // balls
    std::vector<int> first;    // cell c (x fastest) holds begin + first[c] .. first[c+1]-1
    std::vector<float> top;    // highest ball centre of a cell
    double xlo, ylo, cell_inv;
    int ncx, ncy;
    int64_t asked;    // when it was last asked for
  };
  std::vector<int> slot;      // of the plan's tiles, -1: not made
  std::vector<Tile> tiles;    // those that are made
  int64_t now;

  std::vector<Vector> place;
  std::vector<int64_t> numbers;
  std::vector<unsigned short> zones;
  std::vector<PlacedBall> fresh;

  Tile &at(int number)
  {
    if (slot[number] < 0) add(number);
    return tiles[slot[number]];
  }
  void add(int number);
  void sort(Tile &);
  int clamped(double at, int n) const
  {
    return at > 0.0 ? (at < n ? static_cast<int>(at) : n - 1) : 0;
  }
  template <typename Visit>
  void visit_tile(const Tile &, const double *x, double reach, Visit visit) const;
};

/* ---------------------------------------------------------------------- */

template <typename Visit> void BallTiles::visit_near(const double *x, double reach, Visit visit)
{
  const double inv = 1.0 / plan.size, spare = 1.0e-9;
  const double px = plan.cosine * x[0] + plan.sine * x[1];
  const double py = plan.cosine * x[1] - plan.sine * x[0];
  const double ulo = (px - reach - plan.xlo) * inv, uhi = (px + reach - plan.xlo) * inv;
  const double vlo = (py - reach - plan.ylo) * inv, vhi = (py + reach - plan.ylo) * inv;

  // balls lie up to a spacing beyond the plan, so less than a tile

  if (!(uhi >= -1.0 && ulo <= plan.nx + 1.0 && vhi >= -1.0 && vlo <= plan.ny + 1.0)) return;
  const int ilo = clamped(ulo - spare, plan.nx), ihi = clamped(uhi + spare, plan.nx);
  const int jlo = clamped(vlo - spare, plan.ny), jhi = clamped(vhi + spare, plan.ny);
  for (int j = jlo; j <= jhi; j++)
    for (int i = ilo; i <= ihi; i++) {
      Tile &tile = at(j * plan.nx + i);
      tile.asked = now;
      visit_tile(tile, x, reach, visit);
    }
}

template <typename Visit>
void BallTiles::visit_tile(const Tile &tile, const double *x, double reach, Visit visit) const
{
  const double ulo = (x[0] - reach - tile.xlo) * tile.cell_inv;
  const double uhi = (x[0] + reach - tile.xlo) * tile.cell_inv;
  const double vlo = (x[1] - reach - tile.ylo) * tile.cell_inv;
  const double vhi = (x[1] + reach - tile.ylo) * tile.cell_inv;
  if (!(uhi >= 0.0 && ulo < tile.ncx && vhi >= 0.0 && vlo < tile.ncy)) return;
  const int ilo = clamped(ulo, tile.ncx), ihi = clamped(uhi, tile.ncx);
  const int jlo = clamped(vlo, tile.ncy), jhi = clamped(vhi, tile.ncy);
  const double reach2 = reach * reach, lowest = x[2] - reach;

  for (int j = jlo; j <= jhi; j++)
    for (int i = ilo; i <= ihi; i++) {
      const size_t c = static_cast<size_t>(j) * tile.ncx + i;
      if (tile.top[c] < lowest) continue;    // a ball high above the ground
      const int base = static_cast<int>(tile.begin);
      for (int k = base + tile.first[c]; k < base + tile.first[c + 1]; k++) {
        const double dx = x[0] - place[k].x, dy = x[1] - place[k].y, dz = x[2] - place[k].z;
        const double d2 = dx * dx + dy * dy + dz * dz;
        if (d2 < reach2) visit(k, d2);
      }
    }
}

}    // namespace Slope

#endif

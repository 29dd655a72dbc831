// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_tiles.h"

#include <algorithm>
#include <climits>
#include <stdexcept>

using namespace Slope;

static constexpr int64_t LONG_AGO = 100;    // lists of neighbors

/* ---------------------------------------------------------------------- */

BallTiles::BallTiles(const TilePlan &p, double d, const Make &m) :
    plan(p), diameter(d), make(m), now(0)
{
  slot.assign(static_cast<size_t>(plan.nx) * plan.ny, -1);
}

/* ---------------------------------------------------------------------- */

void BallTiles::add(int number)
{
  fresh.clear();
  make(number, fresh);
  const size_t size = place.size() + fresh.size();
  if (size >= INT_MAX) throw std::length_error("2^31 fixed balls near those of one rank");
  if (place.capacity() < size + 1)    // contacts are read 32 bytes at a time, 8 beyond a vector
    place.reserve(std::max(size + 1, 2 * place.capacity()));

  tiles.emplace_back();
  Tile &tile = tiles.back();
  tile.number = number;
  tile.begin = place.size();
  tile.end = size;
  tile.asked = now;
  place.resize(size);
  numbers.resize(size);
  zones.resize(size);
  sort(tile);
  slot[number] = made() - 1;
}

/* ----------------------------------------------------------------------
   counting sort of the fresh balls into plan cells of one diameter
------------------------------------------------------------------------- */

void BallTiles::sort(Tile &tile)
{
  const size_t n = fresh.size();
  tile.ncx = tile.ncy = 0;
  tile.xlo = tile.ylo = tile.cell_inv = 0.0;
  if (n == 0) return;
  double xlo = HUGE_VAL, ylo = HUGE_VAL, xhi = -HUGE_VAL, yhi = -HUGE_VAL;
  for (const PlacedBall &b : fresh) {
    xlo = std::min(xlo, b.x);
    xhi = std::max(xhi, b.x);
    ylo = std::min(ylo, b.y);
    yhi = std::max(yhi, b.y);
  }

  // larger cells where the balls are so sparse that empty cells would outnumber them, in plan or in
  // a long row

  const double area = (xhi - xlo + diameter) * (yhi - ylo + diameter);
  const double longest = std::max(xhi - xlo, yhi - ylo);
  const double cell = std::max({diameter, std::sqrt(area / (2.0 * n)), longest / n});
  const double cell_inv = 1.0 / cell;
  tile.xlo = xlo;
  tile.ylo = ylo;
  tile.cell_inv = cell_inv;
  tile.ncx = static_cast<int>((xhi - xlo) * cell_inv) + 1;
  tile.ncy = static_cast<int>((yhi - ylo) * cell_inv) + 1;

  auto cell_of = [&](const PlacedBall &b) {
    return static_cast<size_t>((b.y - ylo) * cell_inv) * tile.ncx +
        static_cast<size_t>((b.x - xlo) * cell_inv);
  };
  const size_t ncell = static_cast<size_t>(tile.ncx) * tile.ncy;
  tile.first.assign(ncell + 1, 0);
  tile.top.assign(ncell, -HUGE_VALF);
  for (const PlacedBall &b : fresh) tile.first[cell_of(b) + 1]++;
  for (size_t c = 0; c < ncell; c++) tile.first[c + 1] += tile.first[c];
  std::vector<int> next(tile.first.begin(), tile.first.end() - 1);
  for (const PlacedBall &b : fresh) {
    const size_t c = cell_of(b), k = tile.begin + next[c]++;
    numbers[k] = b.number;
    zones[k] = static_cast<unsigned short>(b.zone);
    place[k] = {b.x, b.y, b.z};
    tile.top[c] = std::max(tile.top[c], std::nextafter(static_cast<float>(b.z), HUGE_VALF));
  }
}

/* ---------------------------------------------------------------------- */

void BallTiles::drop_unused()
{
  now++;
  if (slot.size() == 1) return;
  size_t unused = 0;
  for (const Tile &t : tiles)
    if (t.asked < now - LONG_AGO) unused += t.end - t.begin;
  if (2 * unused <= place.size()) return;

  size_t left = 0, balls = 0;
  for (size_t t = 0; t < tiles.size(); t++) {
    if (tiles[t].asked < now - LONG_AGO) {
      slot[tiles[t].number] = -1;
      continue;
    }
    Tile tile = std::move(tiles[t]);
    std::copy(place.begin() + tile.begin, place.begin() + tile.end, place.begin() + balls);
    std::copy(numbers.begin() + tile.begin, numbers.begin() + tile.end, numbers.begin() + balls);
    std::copy(zones.begin() + tile.begin, zones.begin() + tile.end, zones.begin() + balls);
    tile.end = balls + (tile.end - tile.begin);
    tile.begin = balls;
    balls = tile.end;
    slot[tile.number] = static_cast<int>(left);
    tiles[left++] = std::move(tile);
  }
  tiles.resize(left);

  std::vector<Vector> fewer;
  fewer.reserve(balls + 1);
  fewer.assign(place.begin(), place.begin() + balls);
  place.swap(fewer);
  numbers.resize(balls);
  numbers.shrink_to_fit();
  zones.resize(balls);
  zones.shrink_to_fit();
}

double BallTiles::memory_usage() const
{
  double bytes = place.capacity() * sizeof(Vector) + numbers.capacity() * sizeof(int64_t) +
      zones.capacity() * sizeof(zones[0]) + slot.capacity() * sizeof(int) +
      tiles.capacity() * sizeof(Tile) + fresh.capacity() * sizeof(PlacedBall);
  for (const Tile &t : tiles)
    bytes += t.first.capacity() * sizeof(int) + t.top.capacity() * sizeof(float);
  return bytes;
}

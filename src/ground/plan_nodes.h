// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The nodes of a plan grid on a surface, looked at tile by tile and only where somebody asks.
   No LAMMPS. Lengths are in one unit of the caller's choice (m). */

#ifndef SLOPE_PLAN_NODES_H
#define SLOPE_PLAN_NODES_H

#include "ball_sampler.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace Slope {

// number of nodes of the plan grid; a double, because it may be beyond any integer
double count_nodes(const NodeGrid &grid);

// Cell i,j of the plan grid has its corners at the nodes i,j i+1,j i,j+1 i+1,j+1. Cells that
// reach over the edge of the rectangle have corners outside: i and j run from -1 to nx and ny.
// A tile is a square of nodes and of the cells of which these are the lower left corners; the
// first tiles of a row or column have the cells before their nodes, too.
class PlanNodes {
 public:
  static constexpr int TILE = 32;                // nodes along its side, a power of two
  static constexpr double ROUND_OFF = 1.0e-9;    // of the spacing

  // Needs a spacing > 0 and a rectangle that is not empty (else std::invalid_argument), fewer
  // than 2^31 nodes (else std::length_error).
  PlanNodes(const NodeGrid &grid, const GroundHeights &surface, int tile = TILE);

  const NodeGrid grid;
  const GroundHeights surface;
  const int tile, shift;    // 1 << shift is the tile
  int nx, ny, tiles_x, tiles_y;
  double xfirst, yfirst;    // node 0,0

  // a node on the edge of the rectangle does not fall out of it by round-off
  double x(int i) const;
  double y(int j) const;

  // what is at a node; nothing beyond the grid. The reference is good until forget().
  struct Look {
    double z;     // NaN: no surface
    bool ball;    // kept, so there is a ball
    bool surface() const { return z == z; }
  };
  const Look &at(int i, int j);

  bool has_ball(int i, int j) { return at(i, j).ball; }

  // height of the ball on a node, NaN without; -infinite where rounding may decide on that, at a rim. Not
  // remembered.
  double probe(int i, int j) const;

  // a cell's number, and the tile that it belongs to
  int64_t cell(int i, int j) const { return static_cast<int64_t>(j + 1) * (nx + 1) + (i + 1); }
  int cell_i(int64_t cell) const { return static_cast<int>(cell % (nx + 1)) - 1; }
  int cell_j(int64_t cell) const { return static_cast<int>(cell / (nx + 1)) - 1; }

  // whether all nodes of a tile i,j and those around it have a ball, or none has
  enum Balls { NONE, SOME, ALL };
  Balls around(int i, int j);

  // forget all tiles but those in rows jlo to jhi of tiles
  void forget(int jlo = 0, int jhi = -1);
  size_t looked_at() const { return known; }    // tiles that are remembered

 private:
  struct Tile {
    std::vector<Look> nodes;
    int inside, balls;    // nodes of the grid, those with a ball
  };
  std::vector<std::unique_ptr<Tile>> tiles;
  size_t known;
  const Look nothing;

  const Tile &make_tile(int tile_number);
};

}    // namespace Slope

#endif

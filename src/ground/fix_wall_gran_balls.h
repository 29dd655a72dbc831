/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(wall/gran/balls,FixWallGranBalls);
// clang-format on
#else

#ifndef LMP_FIX_WALL_GRAN_BALLS_H
#define LMP_FIX_WALL_GRAN_BALLS_H

#include "fix_contact_wall.h"

#include "ball_ground.h"
#include "ball_tiles.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixWallGranBalls : public FixContactWall, public OnBallGround {
 public:
  FixWallGranBalls(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_neighbor() override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;

  double memory_usage() override;

  void find_contacts(bool repeat) override { find_touching(repeat, "see delete_balls"); }
  void check_sizes() override;

  // largest overlap (m) of a ball at x with any fixed ball, <= 0 if it touches none
  double deepest_overlap(const double *x, double radius) const;

  const BallGround &ground() const override;

 private:
  double diameter, radius;

  std::unique_ptr<class BallPlacement> placement;
  std::unique_ptr<Slope::BallTiles> balls;    // those near the moving balls of this rank
  bool smaller_warned;

  // atom types of the fixed balls, wall_type first; which of them a ball has, by its zone

  std::vector<int> types, type_of_zone;

  // a list for each of these, by type of the moving ball

  size_t list_of(int which, int moving) const;
  std::vector<double> histories;    // of the lists' entries

  double force_mine[3], force_all[3];    // on the fixed balls
  int force_ready;

  Slope::ContactLaw law_of_list(size_t) const override;
  Slope::FixedPartners partners() const override
  {
    return {balls->places(), &radius, Slope::FixedPartners::ONE};
  }
  void key_of(int ball, double *key) const override;
  std::string name_of(int ball) const override;
  Depth depth_of(const Slope::ContactEntry &, double overlap) const override;
  void give_histories();
  void archive_wall(Slope::Archive &) override;
  void apply(bool);
};

}    // namespace LAMMPS_NS

#endif
#endif

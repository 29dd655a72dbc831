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

#include "fix.h"

#include "ball_tiles.h"
#include "contact_holder.h"
#include "contact_list.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixWallGranBalls : public Fix, public ContactHolder {
 public:
  FixWallGranBalls(class LAMMPS *, int, char **);
  ~FixWallGranBalls() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void setup(int) override;
  void pre_exchange() override;
  void post_neighbor() override;
  void post_force(int) override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;

  double memory_usage() override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

  void find_contacts(bool starting, bool lists_new) override;
  double elastic_energy() const override;

  // largest overlap (m) of a ball at x with any fixed ball, <= 0 if it touches none
  double deepest_overlap(const double *x, double radius) const;

  // the body that the balls lie sunk below, nullptr if they do not
  std::shared_ptr<class SunkRegion> body() const;

  // the region outside of which the balls are, without knowing whether it is sunk; or empty
  const std::string &left_out() const;

 private:
  std::string caller;    // style and ID, for messages
  int wall_type;
  double diameter, radius;
  class PairGranRestitution *pair;

  std::unique_ptr<class BallPlacement> placement;
  std::unique_ptr<Slope::BallTiles> balls;    // those near the moving balls of this rank
  bool smaller_warned;

  // what may touch until the next neighbor list, by type of the moving ball, and the same contacts
  // by atom, touching ones only

  std::vector<Slope::ContactList> lists;
  std::unique_ptr<class ContactStore> store;
  bool contacts_in_lists;    // contacts have been updated since they were last stored by atom

  double force_mine[3], force_all[3];    // on the fixed balls
  int force_ready;

  Slope::FixedPartners partners() const { return {balls->places(), radius}; }
  void check_sizes();
  void store_contacts();
  void apply(bool);
};

}    // namespace LAMMPS_NS

#endif
#endif

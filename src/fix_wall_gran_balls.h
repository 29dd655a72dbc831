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

#include "contact_holder.h"
#include "contact_list.h"
#include "my_page.h"

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

  // the body that the balls lie sunk below, nullptr if they do not; all ranks ask
  std::shared_ptr<class SunkRegion> body() const;

  // the region outside of which the balls are, without knowing whether it is sunk; or empty
  const std::string &left_out() const { return outside; }

 private:
  std::string caller;    // style and ID, for messages
  int wall_type;
  double diameter, radius;
  class PairGranRestitution *pair;

  std::shared_ptr<class SunkRegion> sunk;
  bool sunk_released;
  std::string outside;
  double smallest;    // diameter of the smallest ball that finds no way through; 0: unknown

  // the fixed balls, sorted by plan cell (x fastest): cell c holds first[c] .. first[c+1]-1

  std::vector<Slope::Vector> balls;
  std::vector<int> first;
  std::vector<int> number;    // of each ball in the placement, which rounding does not change
  std::vector<float> top;     // highest ball centre of a cell
  double xlo, ylo, cell_inv;
  int ncx, ncy;
  double checksum[3];    // of the places in their order: a restart must find the same balls

  // what may touch until the next neighbor list, by type of the moving ball

  std::vector<Slope::ContactList> lists;
  std::vector<double> history;
  bool lists_newer;    // contacts have been updated since they were last stored by atom

  // the same contacts stored by atom, touching ones only: what exchange and restart carry

  int *npartner;
  int **partner;
  double **values;
  MyPage<int> ipage;
  MyPage<double> dpage;

  double force_mine[3], force_all[3];    // on the fixed balls
  int force_ready;

  void sort_balls(const std::vector<double> &);
  void add_up(const std::vector<double> &);
  template <typename Visit> void visit_near(const double *, double, Visit) const;
  void check_sizes();
  void store_contacts();
  void apply(bool);
};

}    // namespace LAMMPS_NS

#endif
#endif

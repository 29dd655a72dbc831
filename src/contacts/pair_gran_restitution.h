/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef PAIR_CLASS
// clang-format off
PairStyle(gran/restitution,PairGranRestitution);
// clang-format on
#else

#ifndef LMP_PAIR_GRAN_RESTITUTION_H
#define LMP_PAIR_GRAN_RESTITUTION_H

#include "pair.h"

#include "ball_states.h"
#include "contact_guards.h"
#include "contact_table.h"
#include "contact_works.h"
#include "pair_lists.h"
#include "restart_archive.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class PairGranRestitution : public Pair {
 public:
  explicit PairGranRestitution(class LAMMPS *);
  ~PairGranRestitution() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void setup() override;
  double single(int, int, int, int, double, double, double, double &) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  double memory_usage() override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;

  // not marked override: the arguments differ between versions
  void transfer_history(double *, double *);
  void transfer_history(double *, double *, int, int);

  // size of a ball against another, for computes and for balancing by cost;
  // not marked override: they moved between classes in later LAMMPS
  double atom2cut(int);
  double radii2cut(double, double);

  // the pair style of this name, alone or in pair hybrid; nullptr if there is none, or more than one
  static PairGranRestitution *of(class LAMMPS *);

  // for the walls, which register at init: the contact law of a type pair, nullptr where no pair_coeff
  // set it; what contacts see of the balls
  const Slope::ContactLaw *law(int itype, int jtype) const;
  void announce_wall(class ContactHolder *wall, int wall_type, const std::vector<int> &other_types,
                     int groupbit, const char *style);
  Slope::MovingBalls moving_balls() { return states.balls(); }
  class Continuation *continuation() const;    // nullptr before init()
  bool sizes_vary = false;                     // between two neighbor lists, by fix adapt
  ContactGuards guards;
  Slope::ContactWorks works;    // of fix energy/ledger, walls included

 protected:
  ContactTable table;
  PairLists lists;
  BallStates states;
  std::vector<class ContactHolder *> walls;
  int freeze_group_bit;
  class FixContactHistory *fix_history;
  std::string history_id, dummy_id;
  RestartDrops restart_drops;

  void allocate();
  void watch_energy();
};

}    // namespace LAMMPS_NS

#endif
#endif

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

#include "contact_counts.h"
#include "contact_guards.h"
#include "contact_history_owner.h"
#include "contact_law.h"
#include "contact_list.h"
#include "contact_table.h"
#include "contact_works.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class PairGranRestitution : public Pair, public ContactHistoryOwner {
 public:
  explicit PairGranRestitution(class LAMMPS *);
  ~PairGranRestitution() override;
  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void setup() override;
  void reset_dt() override;
  double single(int, int, int, int, double, double, double, double &) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  void *extract(const char *, int &) override;
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

  // the pair style of this name, alone or in pair hybrid; nullptr if there is none
  static PairGranRestitution *of(class LAMMPS *);

  // for the walls: the contact law of a type pair, nullptr where no pair_coeff
  // set it, and a line in the start-up table for every type that the wall meets
  const Slope::ContactLaw *law(int itype, int jtype) const;
  void announce_wall(class ContactHolder *wall, int wall_type, int groupbit, const char *style);
  Slope::MovingBalls moving_balls();
  void store_flags() const override;
  bool sizes_vary = false;    // between two neighbor lists, by fix adapt

  void watch_energy() override;
  void check_finite() const override { guards.check_finite(); }
  void report_guards() override { guards.report(); }
  ContactGuards guards;
  Slope::ContactWorks works;    // of fix energy/ledger, walls included

 protected:
  ContactTable table;

  double dt = 0.0;
  bool repeat = false;    // the forces of the last step are found once more: at a set-up
  int freeze_group_bit;
  class FixContactHistory *fix_history;
  std::vector<Slope::ContactList> lists;    // by type pair and by which side is frozen
  std::vector<class ContactHolder *> walls;
  Slope::ContactCounts counts;
  std::vector<Slope::Vector> ahead;    // velocities that normal dashpots act on, if they are
  bool ahead_known;                    // others than those of the middle of the step

  std::string history_id, dummy_id;

  void allocate();
  void build_lists();
  void find_contacts();
  void find_ahead();
};

}    // namespace LAMMPS_NS

#endif
#endif

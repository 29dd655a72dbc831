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

#include "contact_law.h"
#include "contact_list.h"
#include "energy_guard.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class PairGranRestitution : public Pair {
 public:
  PairGranRestitution(class LAMMPS *);
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

  // for fix wall/gran/balls: the contact law of a type pair, nullptr where no pair_coeff
  // set it, and a line in the start-up table for every type that the wall meets
  const Slope::ContactLaw *law(int itype, int jtype) const;
  void announce_wall(class ContactHolder *wall, int wall_type, int groupbit);
  Slope::MovingBalls moving_balls();
  void store_flags() const;
  bool force_estimated(int i) const;    // of a ball at set-up: contacts that slid alone, see contact_law.h
  bool sizes_vary;    // between two neighbor lists, by fix adapt

  // guards; what they found, for summaries
  void watch_energy();     // every EnergyGuard::EVERY steps and at the end of a run
  void see_overlap(int i, double overlap, double radius);    // radius: the smaller one
  void report_guards();    // at the end of a run
  struct Guards {
    double deepest;        // overlap, of the smaller radius
    double energy_growth;
    bigint deep, energy_grew, dangerous_builds;
  };
  Guards guards() const;    // collective
  std::vector<std::string> warnings;    // so far, each once

 protected:
  // what pair_coeff was given for a type pair; the laws are made from it
  struct Coeff {
    int set;
    int restitution_set;    // 1: dashpots from e, 0: cn and ct as given
    int spring_set;         // 1: kr and cr as given
    double kn, kt, e, cn, ct, phi, rolling, kr, cr;
  };

  // what the masses and radii of a type's atoms are, over all ranks
  struct TypeRange {
    double mass_min, mass_max, radius_dynamic, radius_frozen;
    bool moving, frozen;
  };

  int mass_ball;         // mass ball instead of mass pair
  int limit_damping;     // the normal force never pulls
  int rolling_reduced;   // rolling radius RiRj/(Ri+Rj) instead of its double
  int plain;             // velocities of the dashpots as velocity Verlet has them

  std::vector<Coeff> coeffs;              // (ntypes+1) x (ntypes+1), both triangles filled
  std::vector<Slope::ContactLaw> laws;    // same layout
  std::vector<TypeRange> ranges;          // by type
  std::vector<char> wall_type;            // by type: 1 if a wall fix uses it

  double dt;
  bool starting;    // at set-up
  int freeze_group_bit;
  class FixContactHistory *fix_history;
  std::vector<Slope::ContactList> lists;    // by type pair and by which side is frozen
  // contacts that were seen deeper than is sensible: with every neighbor list and by watch_energy()
  struct Overlaps {
    double most;    // of the smaller radius
    tagint ball;
    bigint step, count;
  } overlaps;

  std::vector<class ContactHolder *> walls;
  std::vector<unsigned char> counts, counts_before, estimated;    // see MovingBalls
  enum { COUNTS, BOTH_COUNTS, ESTIMATED } shared;    // what is communicated of them
  EnergyGuard energy;
  std::vector<Slope::Vector> half_v, half_omega;    // at set-up, where they are known
  std::string history_id, dummy_id;
  std::string table;    // start-up table as last printed

  void allocate();
  int index(int i, int j) const;
  void make_laws();
  void find_ranges();
  void print_table();
  void check_timestep();
  bool can_touch(int, int) const;
  double bound_on_step(int, int) const;
  void check_neighbor_lists();
  void check_fixed_balls();
  template <typename... Args> void warn(const char *format, const Args &...args);
  void build_lists();
  void find_contacts(bool lists_new);
  void share();
  void check_dashpots();
  void find_half_step();
};

}    // namespace LAMMPS_NS

#endif
#endif

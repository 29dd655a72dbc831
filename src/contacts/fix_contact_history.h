/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(CONTACT_HISTORY,FixContactHistory);
// clang-format on
#else

#ifndef LMP_FIX_CONTACT_HISTORY_H
#define LMP_FIX_CONTACT_HISTORY_H

#include "fix_neigh_history.h"

#include "continuation.h"
#include "restart_archive.h"

#include <functional>

namespace LAMMPS_NS {

class FixContactHistory : public FixNeighHistory {
 public:
  FixContactHistory(class LAMMPS *, int, char **);
  ~FixContactHistory() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void post_integrate() override;
  void reset_dt() override;
  void pre_exchange() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void end_of_step() override;
  void post_run() override;

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
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;

  // of the pair style, which sets them
  class ContactGuards *guards;
  const class PairLists *lists;
  std::function<void()> watch_energy;    // every EnergyGuard::EVERY steps, before and at the end

  // Whether the neighbor list is a new one, told once: the pair style's lists must be made anew. When these
  // have been used, their histories are newer than those stored by atom.
  bool take_new_lists();
  void note_used() { lists_used = true; }

  Continuation continuation;

 private:
  bool lists_new, lists_used;
  tagint
      *known_as;    // ID of each ball when the contacts were stored by atom; 0: it came after that
  RestartExtra restart_extra;

  void store_contacts();
  void rename_partners();
  void check_order() const;
  void archive(Slope::Archive &);    // members of a restart file
  int most_packed() const;           // numbers of a ball of this rank, as pack_exchange() has them
};

}    // namespace LAMMPS_NS

#endif
#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What is not sensible in a run with contacts, and a warning of each, once: time step, dashpots
   and masses, neighbor lists, balls that nothing moves or holds, deep contacts, energy that grows. */

#ifndef SLOPE_CONTACT_GUARDS_H
#define SLOPE_CONTACT_GUARDS_H

#include "pointers.h"

#include "energy_guard.h"
#include "motion_guard.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class ContactTable;

class ContactGuards : protected Pointers {
 public:
  ContactGuards(LAMMPS *, const ContactTable &);

  // once per run, when masses, coefficients and step are final; prints the table if it has changed
  void start(int freeze_group_bit);
  void begin_step();    // collective

  void record_overlap(int i, double overlap, double radius);    // m; radius: the smaller one
  void watch_energy(double elastic);    // J, of this rank's springs; collective
  void check_finite() const { energy.check_finite(); }
  void say(const std::string &text);    // a warning of a wall; by rank 0, or by all
  void report();                        // at the end of a run; collective

  struct Found {
    double deepest;    // overlap, of the smaller radius
    double energy_growth;
    bigint deep, energy_grew, dangerous_builds;
    void add(const Found &);    // of another run
  };
  Found found() const;                  // in this run; collective
  std::vector<std::string> warnings;    // so far, each once; on rank 0

 private:
  const ContactTable &table;
  std::string printed;    // table as last printed
  EnergyGuard energy;
  MotionGuard motion;

  // contacts that were seen deeper than is sensible: with every neighbor list and by watch_energy()
  struct Overlaps {
    double most;    // of the smaller radius
    tagint ball;
    bigint step, count;
  } overlaps;

  template <typename... Args> void warn(const char *format, const Args &...args);
  void print_table();
  void check_timestep();
  void check_dashpots();
  void check_dashpots(int itype, int jtype);
  void check_neighbor_lists();
};

}    // namespace LAMMPS_NS

#endif

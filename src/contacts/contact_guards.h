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

#include <set>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// What moves the balls of a run and what holds them: a ball that nothing moves, or that nothing pulls,
// hangs in the air and counts as one at rest.
class MotionGuard : protected Pointers {
 public:
  explicit MotionGuard(LAMMPS *);

  void start(int freeze_group_bit);    // at the set-up of a run

  // What is not sensible, in words; collective. In the first step of a run: neither run 0 nor rerun moves
  // anything.
  std::vector<std::string> begin_step();
  std::vector<std::string> end_run();    // balls that came since, or that hang

 private:
  int frozen;    // group bits
  bool stepped;
  bigint unmoved;    // balls

  struct Movers {
    int moved, guided;     // group bits
    std::string guides;    // fixes
  };
  Movers movers() const;
  template <typename Test> bigint count_free(Test test) const;
  void check_unmoved(const Movers &, std::vector<std::string> &found);
  void check_gravity(std::vector<std::string> &found) const;
  void check_frozen(const Movers &, std::vector<std::string> &found) const;
};

// Balls that grow: no new neighbor list comes for that, and none reaches farther than for the largest balls of the set-up.
class GrowthGuard : protected Pointers {
 public:
  explicit GrowthGuard(LAMMPS *lmp) : Pointers(lmp), wanted(false), most(0.0) {}

  void begin(bool sizes_vary);    // a run

  void begin_list();    // around each neighbor list, of which the balls are known by their indices
  void end_list();

  // by how much a radius has grown at most while there was one list, m; collective. Begins anew.
  double grown();

 private:
  bool wanted;                   // sizes vary
  std::vector<double> radius;    // when the list was made
  double most;
};

class ContactGuards : protected Pointers {
 public:
  ContactGuards(LAMMPS *, const class ContactTable &);

  // once per run, when masses, coefficients and step are final; prints the table if it has changed
  void start(int freeze_group_bit);
  void begin_step();    // collective

  // from start(), or the first step, to report(): not while rerun looks at snapshots, of which none follows from the one before
  bool in_run() const { return running; }

  // whatever of step, dashpots and masses is not sensible and has not been warned of in this run: when balls have come or changed,
  // and the step
  void check_balls();

  void record_overlap(int i, double overlap, double radius);    // m; radius: the smaller one
  void watch_energy(double elastic);    // J, of this rank's springs; collective
  EnergyGuard energy;
  GrowthGuard growth;
  // collective; beyond: m, by which two balls reach farther than at the set-up
  void check_growth(double beyond);
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
  const class ContactTable &table;
  std::string printed;    // table as last printed
  MotionGuard motion;
  std::set<std::string> told;    // warned of by check_balls() in this run

  // contacts that were seen deeper than is sensible: with every neighbor list and by watch_energy()
  struct Overlaps {
    double most;    // of the smaller radius
    tagint ball;
    bigint step, count;
  } overlaps;

  bool unseen_told;    // of this LAMMPS: in one run of each pair style
  bool running;

  template <typename... Args> void warn(const char *format, const Args &...args);
  void print_table();
  void check_timestep();
  void check_dashpots(int itype, int jtype);
  void check_neighbor_lists(int freeze_group_bit);
};

// The guard against balls that are placed inside each other. A linear spring of this
// stiffness turns an overlap of a few per cent of the radius into a shot; a run must not
// start from one. Used by the pair style and by the walls at set-up; contacts that come
// with a history (a continued or restarted run) are not looked at, nor are the snapshots of rerun.
class InitialOverlap : protected Pointers {
 public:
  static constexpr double LIMIT = 0.05;    // of the smaller radius

  InitialOverlap(class LAMMPS *lmp, const ContactGuards &guards) :
      Pointers(lmp), in_run(guards.in_run()), worst(LIMIT), count(0)
  {
  }

  // note one overlapping pair; partner names it in the message
  void record(double overlap, double radius, tagint ball, const double *where,
              const std::string &partner);

  // collective: ends the run if any rank saw an overlap above the limit
  void check(const std::string &caller, const std::string &remedy = "see delete_balls");

 private:
  const bool in_run;
  double worst;        // overlap / radius
  bigint count;        // pairs above the limit
  std::string text;    // the worst pair
};

}    // namespace LAMMPS_NS

#endif

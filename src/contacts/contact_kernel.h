/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The two passes of a step over a list of contacts, compiled for several instruction sets. The best one
   that the processor has is chosen when it is first asked for. No LAMMPS.

   Results of one kernel are the same from run to run; those of two kernels differ by rounding, because some
   processors multiply and add without rounding in between. */

#ifndef SLOPE_CONTACT_KERNEL_H
#define SLOPE_CONTACT_KERNEL_H

#include "contact_balls.h"
#include "contact_law.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace Slope {

struct ContactEntry {
  int i, j;    // moving ball, partner
};

// scheme solved: four contacts of a step, count of which are not idle
struct ActiveContacts {
  int k[4], count;
  double n[3][4], overlap[4], weight[4], turn[4], beyond[4];    // as SolvedContactOf
};

// a contact list as the kernels see it
struct ContactView {
  static constexpr int BLOCK = 64;

  const ContactEntry *entries;
  double *const *histories;    // HISTORY values of each
  size_t size, blocks;
  std::uint64_t *touching, *before, *ended;    // a bit of each contact: see ContactList
  ActiveContacts *active;                      // room for all, of which active_count are
  size_t *active_count;
  Sides moves;

  // equal: radii (m) and masses (kg) are these for all contacts; otherwise each looks up its own
  bool equal;
  double radius_i, radius_j, mass_i, mass_j;
};

// Results of a second pass: the sum of the forces on the balls i, N; and each contact to
// visit(visitor, i, j, force on i, vector j -> i), if that is set
struct ContactTally {
  typedef void (*Visit)(void *, int, int, const Vector &, const Vector &);
  Vector force;
  Visit visit;
  void *visitor;
};

// scheme solved: balls whose velocities are to be found
struct BallSolve {
  double dt;
  const double *radius, *mass;
  const Vector *v, *omega, *field;    // velocities before the step's force; gravity, m/s2
  Vector *mean_v, *mean_omega;        // found so far, replaced
  BallDashpots *dashpots;
};

// The passes of scheme solved over a list, after find(), for one kind of partners
template <class Partners> struct SolvedPasses {
  // springs grow (not if repeat), dashpots and forces are summed for the balls
  void (*begin)(const ContactView &, const ContactLaw &, double dt, bool repeat,
                const MovingBalls &, const Partners &);

  // the sums of the forces once more, with the velocities that the balls have found
  void (*sweep)(const ContactView &, const ContactLaw &, double dt, const MovingBalls &,
                const Partners &);

  // adds the forces to the balls. tally: nullptr if not needed
  void (*finish)(const ContactView &, const ContactLaw &, double dt, const MovingBalls &,
                 const Partners &, ContactTally *tally);
};

// the passes compiled for one instruction set, for each kind of partners
struct ContactKernel {
  template <class Partners>
  using Find = void (*)(const ContactView &, bool repeat, bool first, const MovingBalls &,
                        const Partners &);
  template <class Partners>
  using Apply = void (*)(const ContactView &, const ContactLaw &, double dt, bool repeat,
                         const MovingBalls &, const Partners &, ContactTally *);

  Find<MovingPartners> find_moving;
  Find<FixedPartners> find_fixed;
  Apply<MovingPartners> apply_moving;
  Apply<FixedPartners> apply_fixed;
  SolvedPasses<MovingPartners> solved_moving;
  SolvedPasses<FixedPartners> solved_fixed;

  // the velocities of balls begin to end from the sums, which are cleared
  void (*solve)(const BallSolve &, int begin, int end);

  const SolvedPasses<MovingPartners> &solved(const MovingPartners &) const { return solved_moving; }
  const SolvedPasses<FixedPartners> &solved(const FixedPartners &) const { return solved_fixed; }

  // First pass: which contacts touch, as bits, and the balls' numbers of contacts. repeat: what touched in
  // the step that has just ended. first: the list is new, those of the step before are counted, too.
  void find(const ContactView &v, bool repeat, bool first, const MovingBalls &b,
            const MovingPartners &p) const
  {
    find_moving(v, repeat, first, b, p);
  }
  void find(const ContactView &v, bool repeat, bool first, const MovingBalls &b,
            const FixedPartners &p) const
  {
    find_fixed(v, repeat, first, b, p);
  }

  // Second pass: adds the forces to the balls, whose numbers of contacts are complete. tally: nullptr
  // if not needed
  void apply(const ContactView &v, const ContactLaw &law, double dt, bool repeat,
             const MovingBalls &b, const MovingPartners &p, ContactTally *tally) const
  {
    apply_moving(v, law, dt, repeat, b, p, tally);
  }
  void apply(const ContactView &v, const ContactLaw &law, double dt, bool repeat,
             const MovingBalls &b, const FixedPartners &p, ContactTally *tally) const
  {
    apply_fixed(v, law, dt, repeat, b, p, tally);
  }
};

namespace ContactKernels {

struct Choice {
  const char *name;
  bool runs_here;    // this processor has its instructions
  const ContactKernel *kernel;
};

// all of this program, the slowest first
const std::vector<Choice> &all();

// The number, in all(), of the one to use: that of this name, or if it is nullptr or empty the last one that
// runs here. Throws std::invalid_argument where there is none of that name, or it does not run here.
int choose(const char *name);

// name of the environment variable that overrides the choice
extern const char *const ENVIRONMENT;

// the one in use: choose(environment) until another one is set
const ContactKernel &current();
const char *current_name();
void set_current(int number);

}    // namespace ContactKernels

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The two passes of a step over a list of contacts, compiled for several instruction sets. The pair style chooses the
   best one that the processors of all ranks have, unless the environment names one; without it, the first
   use does. No LAMMPS.

   Results of one kernel are the same from run to run; those of two kernels differ by rounding, because some
   processors multiply and add without rounding in between. */

#ifndef SLOPE_CONTACT_KERNEL_H
#define SLOPE_CONTACT_KERNEL_H

#include "contact_balls.h"
#include "contact_step.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace Slope {

struct ContactEntry {
  int i, j;    // moving ball, partner
};

// what the contacts of a list have in common
struct ContactSizes {
  Sides moves;

  // equal: radii (m) and masses (kg) are these for all contacts; otherwise each looks up its own
  bool equal;
  double radius_i, radius_j, mass_i, mass_j;
};

// a bit of each of 64 contacts that follow one another
struct ContactBits {
  std::uint64_t touching;    // in the last step
  std::uint64_t before;      // in the one before, in the second pass
  std::uint64_t fresh;       // began in the last step
  std::uint64_t ended;       // came apart in the last step, and had a force in it
  std::uint64_t solved;      // has a row: see ContactView
};

// some contacts of a list: their numbers, and a copy of each; room for all, and three more
struct NearContacts {
  int *numbers;
  ContactEntry *entries;
  size_t size;
};

// a contact list as the kernels see it: pointers, so that no template of the standard library is compiled for an
// instruction set that the processor may not have, and then chosen by the linker for all
struct ContactView : ContactSizes {
  static constexpr int BLOCK = 64;
  static constexpr int NUMBERS = sizeof(ContactOwnOf<double>) / sizeof(double);
  static constexpr int ROW = (NUMBERS + 3) / 4 * 4;    // whole fours

  const ContactEntry *entries;
  double *const *histories;    // HISTORY values of each
  size_t size, blocks;
  ContactBits *bits;

  // what a first pass looks at: all; all, and notes those with a smaller gap than the room (m); these alone
  enum Look { ALL, NOTE, NOTED } look;
  double room;
  NearContacts *near;

  // Of equal balls that both move: what so many contacts of the two make of their dashpots, along and the numbers of
  // CompanyOf, for the step that it is of
  static constexpr int COMPANIES = 2 * 255 + 1;
  double *companies;
  ContactStep *of_step;

  // if not equal, the numbers of the row of each contact that has a force (contact_rows.h), and the contacts whose
  // row is still to be solved for
  const int *row_numbers;
  double *rows;
  const int *unsolved;
  size_t unsolved_size;
  double *row(int k) const { return rows + ROW * static_cast<size_t>(row_numbers[k]); }
};

// Results of a second pass: the sum of the forces on the balls i, N; and each contact to
// visit(visitor, i, j, force on i, vector j -> i), if that is set
struct ContactTally {
  typedef void (*Visit)(void *, int, int, const Vector &, const Vector &);
  Vector force;
  Visit visit;
  void *visitor;
};

// the passes with one kind of partners: find_contacts() and apply_contacts() of contact_passes.h
template <class Partners> struct PassesOf {
  // First pass: which contacts touch, as bits, and the balls' numbers of contacts. repeat: what touched in
  // the step that has just ended.
  void (*find_contacts)(const ContactView &, bool repeat, const MovingBalls &, const Partners &);

  // Second pass: adds the forces to the balls, whose numbers of contacts are complete. tally: nullptr
  // if not needed
  void (*apply_contacts)(const ContactView &, const ContactLaw &, double dt, bool repeat,
                         const MovingBalls &, const Partners &, ContactTally *);
};

// what is compiled for one instruction set
struct ContactKernel {
  PassesOf<MovingPartners> of_moving;
  PassesOf<FixedPartners> of_fixed;

  // whether one of n numbers differs from what it was by more than that
  bool (*any_moved)(const double *now, const double *was, size_t n, double most);

  const PassesOf<MovingPartners> &with(const MovingPartners &) const { return of_moving; }
  const PassesOf<FixedPartners> &with(const FixedPartners &) const { return of_fixed; }
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

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_RUN_CLOCK_H
#define SLOPE_RUN_CLOCK_H

#include <cstdint>

namespace Slope {

// Time that a fix counts from its first run on, whatever the deck does to steps and time step in
// between. A run that continues with the same time step counts from the same step as before, so that
// its times are those of the uncut run, to the bit.
class RunClock {
 public:
  RunClock() : base(0.0), base_step(0), last(-1), step_size(0.0), on(false) {}

  bool started() const { return on; }
  double dt() const { return step_size; }

  // Set-up of a run at a step. Returns true if it continues where the last one ended.
  bool begin(int64_t step, double dt)
  {
    const bool goes_on = on && step == last && dt == step_size;
    if (!goes_on) {
      base = on ? at(last) : 0.0;
      base_step = last = step;
      step_size = dt;
      on = true;
    }
    return goes_on;
  }

  // another time step, from this step on
  void change_step_size(int64_t step, double dt)
  {
    if (!on || dt == step_size) return;
    base = at(step);
    base_step = step;
    step_size = dt;
  }

  void pass(int64_t step) { last = step; }    // at the end of every step
  double at(int64_t step) const { return base + (step - base_step) * step_size; }
  double now() const { return on ? at(last) : 0.0; }

  // members of a restart file
  template <class Archive> void archive(Archive &a)
  {
    a.number("clock_base", base);
    a.number("clock_base_step", base_step);
    a.number("clock_last_step", last);
    a.number("clock_step_size", step_size);
    a.number("clock_on", on);
  }

 private:
  double base;    // time at base_step
  int64_t base_step, last;
  double step_size;
  bool on;
};

}    // namespace Slope

#endif

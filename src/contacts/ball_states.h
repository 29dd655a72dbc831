/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The balls as the contacts of a step see them, ghosts included: velocities of the middle of the step, those
   that normal dashpots act on, and the number of contacts of each ball, which all ranks that know a ball
   share. The pair style hands LAMMPS the buffers. */

#ifndef SLOPE_BALL_STATES_H
#define SLOPE_BALL_STATES_H

#include "pointers.h"

#include "contact_balls.h"
#include "contact_counts.h"
#include "continuation.h"

#include <vector>

namespace LAMMPS_NS {

class BallStates : protected Pointers {
 public:
  explicit BallStates(LAMMPS *lmp) :
      Pointers(lmp), continuation(nullptr), shared(false), on_fixed{nullptr, 0}, ahead_known(false)
  {
  }

  // of this step; repeat: of the last one, once more, at a set-up. exact: dashpots look ahead; held: some balls are
  void begin_step(Continuation &, bool repeat, bool exact, bool held);
  void share_counts(class Pair *);    // when this rank has counted; collective

  Slope::MovingBalls balls();
  Slope::MovingPartners partners(const Slope::MovingBalls &) const;

  // of the pair style that is handed over
  int pack_forward(int n, const int *list, double *buf) const;
  void unpack_forward(int n, int begin, const double *buf);
  int pack_reverse(int n, int begin, double *buf) const;
  void unpack_reverse(int n, const int *list, const double *buf);
  static constexpr int FORWARD = 8, REVERSE = 5;    // most values of a ball

  double memory_usage() const;

 private:
  void clear_fixed(bool held);

  Continuation *continuation;
  Slope::ContactCounts counts;
  std::vector<Slope::FixedContacts> fixed;    // of ghosts, too, if ranks share them:
  bool shared;                                // where balls are held, which may be another's
  std::vector<int> numbers_on_fixed;
  Slope::BallsOnFixed on_fixed;    // whose sums are to be cleared
  bool ahead_known;                // normal dashpots act on velocities of their own
};

}    // namespace LAMMPS_NS

#endif

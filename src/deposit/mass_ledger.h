// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_MASS_LEDGER_H
#define SLOPE_MASS_LEDGER_H

#include <string>
#include <vector>

namespace Slope {

// Where the released mass is: on the grid, off the grid, or lost, because it left the box. Every
// rank notes what leaves on it; sums over the ranks are the caller's.
class MassLedger {
 public:
  struct Mass {
    double number, volume;    // of balls; bulk
    Mass() : number(0.0), volume(0.0) {}
  };
  struct Loss {    // of one ball; numbers only, so that ranks can send them
    double tag, x[3], step;
  };
  static bool earlier(const Loss &a, const Loss &b)    // by step, then by ball
  {
    return a.step < b.step || (a.step == b.step && a.tag < b.tag);
  }
  static constexpr int MAXLOGGED = 5;          // lost balls that get a line in the log
  static constexpr double BALANCE = 1.0e-9;    // of the released volume

  MassLedger() : nlogged(0), outside_known(false) {}

  // --- on this rank ---

  void lose(const Mass &);
  void note(const Loss &);    // keeps the first MAXLOGGED since take_notes()

  // Balls that are outside of the box when a command begins may be gone when it ends, without a
  // word: what is still there then tells how many were lost in it.
  void begin_command(const Mass &outside);
  bool in_command() const { return outside_known; }
  void end_command(const Mass &still_outside);

  const Mass &lost_here() const { return here; }    // since take_here()
  std::vector<Loss> take_notes();

  // --- of all ranks ---

  void take_here(const Mass &of_all_ranks);    // the sum of all lost_here(), which restart at 0
  bool must_log() const { return nlogged < MAXLOGGED; }

  // Lines on the first balls that were lost: notes of all ranks, before: number lost until then.
  std::vector<std::string> lines(std::vector<Loss> notes, double before);

  double residual(double released, double on_grid, double off_grid) const
  {
    return released - on_grid - off_grid - lost.volume;
  }

  Mass lost;      // so far
  int nlogged;    // losses that got a line so far

 private:
  Mass here, outside;
  bool outside_known;
  std::vector<Loss> notes;
};

}    // namespace Slope

#endif

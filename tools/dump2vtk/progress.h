/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_PROGRESS_H
#define SLOPE_PROGRESS_H

#include <chrono>
#include <cstdio>
#include <string>
#include <unistd.h>

namespace Slope {

// A line of progress on a terminal, and warnings
class Progress {
 public:
  Progress() : tty(isatty(STDERR_FILENO)), shown(false) {}
  ~Progress() { clear(); }

  void say(const std::string &text)
  {
    const auto now = std::chrono::steady_clock::now();
    if (!tty || (shown && now - last < std::chrono::milliseconds(200))) return;
    fprintf(stderr, "\rdump2vtk: %s\033[K", text.c_str());
    fflush(stderr);
    last = now;
    shown = true;
  }

  void clear()
  {
    if (shown) fprintf(stderr, "\r\033[K");
    shown = false;
  }

  void warn(const std::string &text)
  {
    clear();
    fprintf(stderr, "dump2vtk: warning: %s\n", text.c_str());
  }

 private:
  bool tty, shown;
  std::chrono::steady_clock::time_point last;
};

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_INTERRUPT_H
#define SLOPE_INTERRUPT_H

namespace Slope {

// What a signal ends with, after the destructors have removed what was begun
class Interrupted {};

// From here on SIGINT, SIGTERM and SIGHUP end the program at the next check_interrupt()
void catch_signals();

// Throws Interrupted after such a signal
void check_interrupt();

}    // namespace Slope

#endif

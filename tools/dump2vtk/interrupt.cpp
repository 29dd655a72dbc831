/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "interrupt.h"

#include <csignal>
#include <initializer_list>

using namespace Slope;

static volatile std::sig_atomic_t interrupted = 0;

static void interrupt(int)
{
  interrupted = 1;
}

/* ---------------------------------------------------------------------- */

void Slope::catch_signals()
{
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, interrupt);
  std::signal(SIGXFSZ, SIG_IGN);    // a limit on file sizes is an error like a full disk
}

void Slope::check_interrupt()
{
  if (interrupted) throw Interrupted();
}

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#define SLOPE_INSTRUCTIONS baseline    // the compiler options of all other sources

#include "contact_passes.h"

namespace Slope {
extern const ContactKernel contact_kernel_baseline = SLOPE_CONTACT_KERNEL;
}

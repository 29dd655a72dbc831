// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef SLOPE_X86_KERNELS

#define SLOPE_INSTRUCTIONS x86_64_v2    // SSE4.2

#include "contact_passes.h"

namespace Slope {
extern const ContactKernel contact_kernel_x86_64_v2 = SLOPE_CONTACT_KERNEL;
}

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_FREE_MEMORY_H
#define SLOPE_FREE_MEMORY_H

#include <string>

namespace Slope {

// Bytes of memory that this machine can still give: what Linux says is available, and no more than
// the limits of the control groups (version 2: batch systems, containers) of this process leave; where
// that is not known, all memory of the machine. Linux gives more than there is, and kills who uses it:
// what cannot fit has to be refused before it is asked for.
//
// root: folder with proc/ and sys/, for tests
double free_memory(const std::string &root = "");

// Bytes that processes can still share: what is left in the folder that holds such memory, which
// containers often limit (64 MB). What does not fit there ends the process when it is written. Infinite
// where there is no such folder.
double free_shared_memory(const std::string &folder = "/dev/shm");

}    // namespace Slope

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_KERNEL_CHOICE_H
#define SLOPE_KERNEL_CHOICE_H

namespace LAMMPS_NS {

// Sets the contact kernel of this process: the best one that all ranks can run, so that a contact is the
// same sum on each. Ends the run on all ranks if the environment variable names none that runs. Collective.
void choose_contact_kernel(class LAMMPS *lmp);

}    // namespace LAMMPS_NS

#endif

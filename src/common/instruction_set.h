// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The contact kernels are compiled several times, for several instruction sets, and one is chosen when
   the pair style is defined (contact_kernel.h). What they are made of is therefore in an inline namespace of
   its own for each: the linker must never take one set's code for another's. */

#ifndef SLOPE_INSTRUCTION_SET_H
#define SLOPE_INSTRUCTION_SET_H

#ifndef SLOPE_INSTRUCTIONS
#define SLOPE_INSTRUCTIONS everywhere    // those of all other sources
#endif

// no copy of its own that the linker could share
#define SLOPE_INLINE inline __attribute__((always_inline))

#endif

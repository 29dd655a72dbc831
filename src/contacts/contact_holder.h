// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CONTACT_HOLDER_H
#define SLOPE_CONTACT_HOLDER_H

namespace LAMMPS_NS {

// Holders of contacts besides the pair style: the walls. Each registers in its
// init(); the pair style asks all of them for their contacts before any force is computed, and they ask it for laws: it
// knows no more of them, or there would be a circle.
class ContactHolder {
 public:
  // which contacts touch now (repeat: in the step that has just ended, at a set-up), counted with each ball
  virtual void find_contacts(bool repeat) = 0;

  // of the springs of this rank's contacts, J
  virtual double elastic_energy() const = 0;

  // balls have come, or changed their sizes: whether the wall is made for them; collective
  virtual void check_sizes() {}

 protected:
  ~ContactHolder() = default;    // not virtual: that of Fix may throw in some versions of LAMMPS
};

}    // namespace LAMMPS_NS

#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CONTACT_HISTORY_OWNER_H
#define SLOPE_CONTACT_HISTORY_OWNER_H

namespace LAMMPS_NS {

// What fix CONTACT_HISTORY asks of the pair style whose histories it keeps.
class ContactHistoryOwner {
 public:
  // histories from the contact lists to where the neighbor list has them
  virtual void store_flags() const = 0;

  // guards, see EnergyGuard: every EVERY steps, every FINITE_EVERY steps, and at the end of a run
  virtual void watch_energy() = 0;
  virtual void check_finite() const = 0;
  virtual void report_guards() = 0;

 protected:
  ~ContactHistoryOwner() = default;
};

}    // namespace LAMMPS_NS

#endif

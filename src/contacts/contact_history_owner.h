/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_CONTACT_HISTORY_OWNER_H
#define SLOPE_CONTACT_HISTORY_OWNER_H

namespace LAMMPS_NS {

// What fix CONTACT_HISTORY asks of the pair style whose histories it keeps, and which includes its header.
class ContactHistoryOwner {
 public:
  // which contacts have a history, to where LAMMPS keeps the histories, which are there already
  virtual void flag_histories() const = 0;

  // guards of a run: with the energy of all springs at the set-up, every EnergyGuard::EVERY steps and at the end
  virtual void watch_energy() = 0;
  virtual class ContactGuards &run_guards() = 0;

 protected:
  ~ContactHistoryOwner() = default;
};

}    // namespace LAMMPS_NS

#endif

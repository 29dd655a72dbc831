/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef LMP_FIX_CONTACT_WALL_H
#define LMP_FIX_CONTACT_WALL_H

#include "fix.h"

#include "contact_holder.h"
#include "contact_list.h"
#include "contact_records.h"
#include "restart_archive.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Common part of the walls: the law of pair gran/restitution, and contacts that are stored by atom
// between one neighbor list and the next, while atoms migrate or are sorted, and in restart files.
// In between they are in lists, which a wall fills in its post_neighbor().
class FixContactWall : public Fix, public ContactHolder {
 public:
  FixContactWall(class LAMMPS *, int, char **, int keys);    // of a contact's record
  ~FixContactWall() override;
  void init() override;
  void setup_post_neighbor() override { post_neighbor(); }
  void pre_exchange() override;
  void post_run() override { FixContactWall::pre_exchange(); }

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

  double elastic_energy() const override { return energy_beside(partners()); }

 protected:
  std::string caller;    // style and ID, for messages
  class PairGranRestitution *pair;
  int wall_type;                   // atom type that stands for the wall in pair_coeff
  std::vector<int> other_types;    // the same for parts of it
  Slope::ContactRecords records;
  std::vector<Slope::ContactList> lists;    // what may touch until the next neighbor list
  bool contacts_in_lists;    // contacts have been updated since they were last stored by atom

  // law of balls of a type on the wall
  const Slope::ContactLaw &law_of(int type) const { return law_of(type, wall_type); }
  const Slope::ContactLaw &law_of(int type, int wall) const;

  // the last call of a constructor: LAMMPS cannot undo it for a fix whose constructor has failed
  void keep_by_atom();

  // of a list; of all: what its balls meet
  virtual Slope::ContactLaw law_of_list(size_t) const = 0;
  virtual Slope::FixedPartners partners() const = 0;

  // of a partner: the numbers by which its contact is known in a record; its name
  virtual void key_of(int partner, double *key) const = 0;
  virtual std::string name_of(int partner) const = 0;

  // how deep a contact of this overlap is, and the radius that this is a part of, m
  struct Depth {
    double overlap, radius;
  };
  virtual Depth depth_of(const Slope::ContactEntry &, double overlap) const = 0;

  // which contacts touch now; at a set-up a run must not begin with deep overlaps, the remedy says what to do
  void find_touching(bool repeat, const std::string &remedy);
  double energy_beside(const Slope::FixedPartners &) const;    // of the springs, J

  // what a restart file has of the wall: to be written by rank 0, or read by all; collective. What is read must
  // be of this wall, or a std::runtime_error says why not.
  virtual void archive_wall(Slope::Archive &) = 0;

 private:
  bool kept_by_atom, emptiness_told;
  RestartExtra restart_extra;
  void check_group();
  void store_contacts();
  void restart_members(Slope::Archive &);
  void reserve();    // room for a ball's contacts in messages between ranks; collective
};

}    // namespace LAMMPS_NS

#endif

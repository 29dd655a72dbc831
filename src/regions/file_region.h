/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_FILE_REGION_H
#define SLOPE_FILE_REGION_H

#include "region.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// A region whose shape is in a file: region ID STYLE FILE keyword value ... It makes no wall.
class FileRegion : public Region {
 public:
  int surface_interior(double *, double) override { return no_contacts(); }
  int surface_exterior(double *, double) override { return no_contacts(); }

  const int
      number;    // of all that were ever defined: one that replaces another may have its address

 protected:
  const std::string caller;    // "Region terrain"

  // own: keywords beside those of every region, with one value each, > 0: given()
  FileRegion(class LAMMPS *, int narg, char **arg, const std::vector<std::string> &own = {});
  double given(const std::string &keyword, double otherwise) const;

 private:
  std::map<std::string, double> values;

  void check_keyword(class KeywordReader &) const;
  int no_contacts();
};

}    // namespace LAMMPS_NS

#endif

/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef COMMAND_CLASS
// clang-format off
CommandStyle(find_slip,FindSlip);
// clang-format on
#else

#ifndef LMP_FIND_SLIP_H
#define LMP_FIND_SLIP_H

#include "command.h"

#include <vector>

namespace Slope {
class ElevationGrid;
struct SlipBody;
class SlipBodyMaker;
}    // namespace Slope

namespace LAMMPS_NS {

class FindSlip : public Command {
 public:
  explicit FindSlip(class LAMMPS *lmp) : Command(lmp) {}
  void command(int, char **) override;

 private:
  void find(const class SlipOptions &);
  std::vector<Slope::SlipBody> given(const class SlipOptions &, Slope::SlipBodyMaker &) const;
  std::vector<Slope::SlipBody> search(const class SlipOptions &, Slope::SlipBodyMaker &,
                                      Slope::ElevationGrid &least) const;
  void report(const std::vector<Slope::SlipBody> &) const;
  void warn(const Slope::SlipBodyMaker &) const;
  void check_variables(const class SlipOptions &) const;
  void set_variables(const class SlipOptions &, const Slope::SlipBody &) const;
};

}    // namespace LAMMPS_NS

#endif
#endif

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef LMP_SURFACE_RECORDER_H
#define LMP_SURFACE_RECORDER_H

#include "pointers.h"

#include "prefix_lock.h"
#include "surface_loads.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Collects what the balls of all ranks do to a surface, and writes it: PREFIX.csv, PREFIX.triangles.csv,
// PREFIX.vtp. Ranks send what they have seen every so many steps, and when a row is due. The files are
// whole at any time; they are brought up to date when their rows have grown by half, and at the end
// of a run.
class SurfaceRecorder : protected Pointers {
 public:
  SurfaceRecorder(class LAMMPS *, const std::string &caller, const std::string &prefix,
                  const Slope::TouchedSurface &);

  const std::string prefix;

  // of this rank in this step: N, N s
  void add(int triangle, double force, double impulse);
  void end_step(const double *force_moment);    // collective

  void add_row(double time, const double *force_moment_impulse_contacts);    // on all ranks
  // collective; with a row of what came after the last one, which a longer run does not have
  void write_end(double time, const double *force_moment_impulse_contacts);

  std::vector<double> pack();    // collective; for rank 0
  void unpack(const std::vector<double> &numbers);

 private:
  static constexpr int SEND = 50;    // steps

  std::string caller;
  Slope::PrefixLock lock;    // on rank 0
  const Slope::TouchedSurface &surface;
  Slope::SurfaceLoads loads;                         // of all, on rank 0
  std::vector<Slope::SurfaceLoads::Record> fresh;    // of this rank, not sent yet
  std::vector<double> forces;                        // force and moment of each step
  double largest[2];                                 // their sizes since the last row
  double nrow, written;                              // rows
  double steps;     // made so far: their number in LAMMPS may come again, by reset_timestep
  double at_row;    // of the last row

  void send();
  Slope::SurfaceLoads::Row row_of(double time, const double *values) const;
  void write(const Slope::SurfaceLoads::Row *end);
};

}    // namespace LAMMPS_NS

#endif

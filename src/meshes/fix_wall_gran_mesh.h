/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(wall/gran/mesh,FixWallGranMesh);
// clang-format on
#else

#ifndef LMP_FIX_WALL_GRAN_MESH_H
#define LMP_FIX_WALL_GRAN_MESH_H

#include "fix_contact_wall.h"

#include "run_clock.h"
#include "surface_options.h"
#include "surface_recorder.h"
#include "surface_watch.h"

#include <array>
#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// The guard against balls so fast that they may pass through a surface. A ball that hits along
// the normal goes as deep as the spring lets it, undamped. Up to a quarter of its radius no ball
// passes, whatever the edges that it meets.
class SpeedGuard : protected Pointers {
 public:
  static constexpr double DEEPEST = 0.25;    // overlap over radius

  SpeedGuard(class LAMMPS *, const std::string &caller);

  void start();    // of a run
  void record(int i, double speed,
              const Slope::ContactLaw &);      // towards the surface; warns of the first one
  void report(class ContactGuards &guards);    // at the end of a run; collective

 private:
  std::string caller;
  struct Worst {
    double share;    // of the speed up to which no ball passes
    double speed, ball, step;
  } worst;
  bigint count;
};

class FixWallGranMesh : public FixContactWall {
 public:
  FixWallGranMesh(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_neighbor() override;
  void post_force(int) override;
  void end_of_step() override;
  void reset_dt() override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;

  double memory_usage() override;

  void find_contacts(bool repeat) override;
  double elastic_energy() const override;    // of phantoms where the springs are

 private:
  SurfaceOptions options;
  std::unique_ptr<Slope::TouchedSurface> surface;

  // The contacts of this rank's balls, by type of the ball. Each has a slot in watch, and in the
  // contact list a phantom ball as partner: a fixed ball of the same size, so placed that it touches the
  // ball where the surface does, and as deep.

  Slope::SurfaceWatch watch;
  std::vector<double> radii;    // of each slot's phantom
  std::deque<std::array<double, Slope::HISTORY>> history;
  std::vector<Slope::Vector> centres;    // of the phantoms

  // what the balls do to the surface: the force as the contact law has it, its moment, and the momentum
  // that it has got since the fix was defined

  enum { FORCE = 0, MOMENT = 3, IMPULSE = 6, CONTACTS = 9, NVALUE };
  double mine[NVALUE], all[NVALUE];
  bool all_ready;
  std::unique_ptr<SurfaceRecorder> recorder;    // nullptr without output
  Slope::RunClock clock;
  double given[3];    // momentum per time in this step, as velocity Verlet hands it over
  bool started;       // with the first run

  SpeedGuard fast;

  Slope::ContactLaw law_of_list(size_t type) const override;
  Slope::FixedPartners phantoms(const std::vector<Slope::Vector> &places) const
  {
    return {places.data(), radii.data(), Slope::FixedPartners::EACH};
  }
  Slope::FixedPartners partners() const override { return phantoms(centres); }
  void key_of(int slot, double *key) const override;
  std::string name_of(int slot) const override;
  Depth depth_of(const Slope::ContactEntry &, double overlap) const override;
  void add_contact(int slot, const double *from);
  void find_features();
  void warn_of_enclosed();
  void warn_of_rounding();
  void check_speed(int i, const Slope::Vector &normal);
  void archive_wall(Slope::Archive &) override;
  void apply(bool);
  void reduce();
};

}    // namespace LAMMPS_NS

#endif
#endif

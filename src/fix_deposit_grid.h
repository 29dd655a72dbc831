/* -*- c++ -*- ----------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(deposit/grid,FixDepositGrid);
// clang-format on
#else

#ifndef LMP_FIX_DEPOSIT_GRID_H
#define LMP_FIX_DEPOSIT_GRID_H

#include "fix.h"

#include "elevation_grid.h"

#include <memory>
#include <string>
#include <vector>

namespace Slope {
class AtomicFile;
}

namespace LAMMPS_NS {

class FixDepositGrid : public Fix {
 public:
  FixDepositGrid(class LAMMPS *, int, char **);
  ~FixDepositGrid() override;
  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup(int) override;
  void pre_exchange() override;
  void end_of_step() override;
  void post_run() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;

 private:
  // --- settings ---

  std::string region_id, prefix;
  int nfreq, window;
  bool series;
  double cell, bulk, motion;
  double cell_inv, side_factor;    // 1/cell; side of the cube of ground / diameter
  int n[2];                        // cells along x and y
  double lo[2], hi[2];             // their south-west and north-east corner

  double side_of(int i) const;
  double volume_of(int i) const;

  // --- what was released: the group at the first set-up ---

  struct Released {
    double number, volume, x, y;    // x y: centre of mass
    double top[3];                  // place of the highest ball
    double front;                   // plan distance of the farthest ball from there
  };
  Released released;
  bool started, fresh;    // fresh: nothing was sampled yet

  void start();
  void check_ground();

  // --- balls that LAMMPS deletes because they left the box ---

  struct Lost {
    double number, volume;
  };
  struct Loss {
    double tag, x[3], step;
  };
  Lost lost;                   // as of the last sample, all ranks
  Lost lost_here;              // since then, on this rank
  std::vector<Loss> losses;    // the first ones of them, for the log
  int nlogged;
  Lost outside;    // of the box, when the last command began
  bool outside_known;

  Lost count_outside(bool note);
  void settle_outside();
  void log_losses(double before);

  // --- sampling: every rank bins its balls in the window of cells that they occupy ---

  struct Window {
    int first[2], size[2];
    std::vector<double> values;

    Window() : first{0, 0}, size{0, 0} {}
    size_t index(int i, int j) const { return (size_t) j * size[0] + i; }
    size_t ncells() const { return (size_t) size[0] * size[1]; }
    double &volume(int i, int j) { return values[index(i, j)]; }
    double &speed(int i, int j) { return values[ncells() + index(i, j)]; }
    double &energy(int i, int j) { return values[2 * ncells() + index(i, j)]; }
    void clear();
    void cover(const Window &);
  };
  struct Shares {    // of one ball's square in the cells along one axis
    std::vector<int> cell;
    std::vector<double> part;
    int count;
  };
  Window bins;
  Shares shares[2];

  void sample(bool record);
  void place_window();
  double bin(int i);
  void cut(int dim, double centre, double side, Shares &, double &beyond) const;
  void cut_piece(int dim, double a, double b, double side, Shares &, double &beyond) const;
  void unwrap(int i, double *x) const;
  double wrap(int dim, double x) const;
  bool periodic(int dim) const;
  int cell_of(int dim, double x) const;
  bool farthest(double &distance, double &z) const;

  bigint sampled;       // step of the last sample
  double result[10];    // the fix's vector
  double present;       // number of balls
  bool warned;

  // --- rasters, on rank 0 only ---

  Slope::ElevationGrid base, thickness, max_thickness, max_speed, max_energy, arrival, last_motion;
  Slope::ElevationGrid snapshot;    // thickness when the window began
  Window filled;                    // cells of thickness that may not be 0
  bigint snapshot_step;
  double snapshot_time, change;

  void read_base();
  double add_windows(bool record);
  void add_window(Window &, bool record);
  void take_snapshot();

  // --- time since the first set-up, whatever the deck does to steps and time step ---

  double elapsed, offset;
  double clock() const;
  double now() const { return offset + clock(); }

  // --- files ---

  struct Motion {
    double largest, median, share;
  };

  std::vector<std::string> warnings;    // so far, on rank 0
  template <typename... Args> void warn(const char *format, const Args &...args);
  void check_folder();
  void write_files(const std::string &reason);
  Motion motion_of_balls() const;
  typedef std::vector<std::unique_ptr<Slope::AtomicFile>> Files;
  static Slope::AtomicFile &add_file(Files &, const std::string &path);
  void write_rasters(Files &, std::vector<std::string> &names) const;
  std::string guards() const;
  std::string summary(const std::string &reason, const Motion &, const std::string &guards,
                      const std::vector<std::string> &files) const;

  // --- restart: this, and the cells that the mass touched ---

  struct Key {
    double format, cell, nx, ny, xlo, ylo, bulk;
  };
  struct Saved {
    double started;
    Released released;
    Lost lost;
    double nlogged, elapsed, snapshot_step, snapshot_time, change;
  };
  Key restart_key() const;
};

}    // namespace LAMMPS_NS

#endif
#endif

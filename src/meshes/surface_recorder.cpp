/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "surface_recorder.h"

#include "atomic_file.h"
#include "large_messages.h"
#include "rank_zero.h"

#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace Slope;

static constexpr size_t HEAD = 5;       // numbers of pack() before those of the loads
static constexpr int BOTH = 6;          // numbers of a force and a moment
static constexpr double GROWN = 1.5;    // rows over those in the file that make it worth writing

/* ----------------------------------------------------------------------
   files that cannot be written are noticed here, not at the end of the run
------------------------------------------------------------------------- */

SurfaceRecorder::SurfaceRecorder(LAMMPS *lmp, const std::string &_caller,
                                 const std::string &_prefix, const TouchedSurface &_surface) :
    Pointers(lmp),
    prefix(_prefix), caller(_caller), surface(_surface), largest{0.0, 0.0}, nrow(0.0), written(0.0),
    steps(0.0), at_row(0.0)
{
  on_rank_zero(lmp, caller, [this, lmp]() {
    FileSet::probe({prefix + ".csv", prefix + ".triangles.csv", prefix + ".vtp"});
    lock.take(prefix, lmp);
  });
}

/* ---------------------------------------------------------------------- */

void SurfaceRecorder::add(int triangle, double force, double impulse)
{
  fresh.push_back({steps + 1.0, static_cast<double>(triangle), force, impulse});
}

void SurfaceRecorder::end_step(const double *force_moment)
{
  steps++;
  forces.insert(forces.end(), force_moment, force_moment + BOTH);
  if (forces.size() >= BOTH * SEND) send();
}

/* ----------------------------------------------------------------------
   to rank 0: what no rank alone knows are the sizes of force and moment, and what a triangle carries
------------------------------------------------------------------------- */

void SurfaceRecorder::send()
{
  std::vector<double> sums(forces.size());
  MPI_Reduce(forces.data(), sums.data(), static_cast<int>(forces.size()), MPI_DOUBLE, MPI_SUM, 0,
             world);
  for (size_t k = 0; k < sums.size() && comm->me == 0; k += 3) {
    double &most = largest[k % BOTH / 3];
    most = std::max(
        most, std::sqrt(sums[k] * sums[k] + sums[k + 1] * sums[k + 1] + sums[k + 2] * sums[k + 2]));
  }
  forces.clear();

  std::vector<SurfaceLoads::Record> all = gather_records(world, fresh);
  fresh.clear();
  loads.take(all);
}

/* ---------------------------------------------------------------------- */

void SurfaceRecorder::add_row(double time, const double *values)
{
  send();
  nrow++;
  at_row = steps;
  if (comm->me == 0) {
    loads.add_row(row_of(time, values));
    largest[0] = largest[1] = 0.0;
  }
  if (nrow > GROWN * written) write(nullptr);
}

SurfaceLoads::Row SurfaceRecorder::row_of(double time, const double *values) const
{
  SurfaceLoads::Row row = {};
  row.step = static_cast<double>(update->ntimestep);
  row.time = time;
  std::copy_n(values, 10, row.force);    // and what follows it
  std::copy_n(largest, 2, row.largest);
  return row;
}

void SurfaceRecorder::write_end(double time, const double *values)
{
  send();
  const SurfaceLoads::Row row = row_of(time, values);
  write(at_row == steps ? nullptr : &row);
}

/* ---------------------------------------------------------------------- */

void SurfaceRecorder::write(const SurfaceLoads::Row *end)
{
  send();
  written = nrow;
  on_rank_zero(lmp, caller, [this, end]() {
    FileSet files;
    files.add(prefix + ".csv").write(loads.series(end));
    files.add(prefix + ".triangles.csv").write(loads.triangles(surface, steps));
    files.add(prefix + ".vtp").write(loads.polydata(surface, steps));
    files.commit();
  });
}

/* ---------------------------------------------------------------------- */

std::vector<double> SurfaceRecorder::pack()
{
  send();
  std::vector<double> list = {nrow, largest[0], largest[1], steps, at_row};
  const std::vector<double> more = loads.pack();
  list.insert(list.end(), more.begin(), more.end());
  return list;
}

void SurfaceRecorder::unpack(const std::vector<double> &numbers)
{
  on_rank_zero(lmp, caller, [&]() {
    if (numbers.size() < HEAD)
      throw std::runtime_error("the restart file must have the series of the surface, got none");
    loads.unpack(numbers.data() + HEAD, numbers.size() - HEAD, surface.count());
  });
  nrow = written = numbers[0];
  steps = numbers[3];
  at_row = numbers[4];
  if (comm->me == 0) std::copy_n(&numbers[1], 2, largest);
}

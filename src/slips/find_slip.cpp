/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "find_slip.h"

#include "constants.h"
#include "prefix_lock.h"
#include "rank_zero.h"
#include "slip_body.h"
#include "slip_options.h"
#include "slip_search.h"

#include "comm.h"
#include "error.h"
#include "input.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

using namespace LAMMPS_NS;
using Slope::ElevationGrid;
using Slope::SlipBody;
using Slope::SlipBodyMaker;

static constexpr double DOUBTED = 0.05;     // of the weight
static constexpr double LEFT_OUT = 0.05;    // of the least factor, by how much it may be less
static constexpr double HUGE_FACTOR = 100.0;
static constexpr double TELL_EVERY = 10.0;    // s

static constexpr int NVARIABLE = 6;
static const char *const ENDS[] = {"_x", "_y", "_z", "_r", "_factor", "_yield"};
static_assert(sizeof(ENDS) / sizeof(*ENDS) == NVARIABLE, "one of each variable");

/* ----------------------------------------------------------------------
   find_slip REGION strength C PHI DENSITY keyword value ... output PREFIX
------------------------------------------------------------------------- */

void FindSlip::command(int narg, char **arg)
{
  try {
    find(SlipOptions(lmp, narg, arg));
  } catch (std::bad_alloc &) {    // on this rank, in the middle of a search that all share
    error->one(FLERR,
               "Find_slip: not enough memory for the terrain and the search: use a terrain with "
               "larger cells, or fewer ranks on a node");
  }
}

/* ---------------------------------------------------------------------- */

void FindSlip::find(const SlipOptions &options)
{
  check_variables(options);
  Slope::PrefixLock lock;
  on_rank_zero(lmp, "Find_slip", [&]() {
    Slope::SlipWriter::probe(options.output, options.lone ? 1 : options.limits.keep);
    lock.take(options.output, lmp);
  });
  const Slope::SlipSoil soil = options.soil();
  const std::vector<char> allowed = options.allowed();
  SlipBodyMaker maker(options.ground(), soil, allowed, options.task);

  ElevationGrid least(options.ground().nx, options.ground().ny, options.ground().xlo,
                      options.ground().ylo, options.ground().cell,
                      std::numeric_limits<double>::quiet_NaN());
  const std::vector<SlipBody> bodies = options.lone ? given(options, maker)
                                                    : search(options, maker, least);
  report(bodies);
  on_rank_zero(lmp, "Find_slip", [&]() {
    Slope::SlipWriter::write(options.output, least, bodies, maker);
  });
  set_variables(options, bodies[0]);
}

/* ---------------------------------------------------------------------- */

std::vector<SlipBody> FindSlip::given(const SlipOptions &options, SlipBodyMaker &maker) const
{
  SlipBody body;
  const std::string problem = maker.exact(options.surface, body);
  const Slope::SlipSurface &s = options.surface;
  if (!problem.empty())
    error->all(FLERR,
               "Find_slip surface must cut a body out of the terrain, got {} {:.8g} "
               "{:.8g} {:.8g} {:.8g}: {}",
               s.round() && s.along == 1.0 ? "sphere" : "ellipsoid", s.x, s.y, s.z, s.radius,
               problem);
  if (std::isnan(body.factor))
    error->all(FLERR,
               "Find_slip method spencer must find forces between columns of one inclination, at "
               "most 2, that "
               "balance the body, got none: use bishop");
  if (!std::isfinite(body.factor))
    error->all(FLERR,
               "Find_slip direction must be one in which the weight drives the body, got {:.6g}",
               body.surface.direction * 180.0 / Slope::PI);
  body.yield = maker.yield();
  warn(maker);
  return {body};
}

/* ---------------------------------------------------------------------- */

std::vector<SlipBody> FindSlip::search(const SlipOptions &options, SlipBodyMaker &maker,
                                       ElevationGrid &least) const
{
  const Slope::SlipLimits &limits = options.limits;
  const auto least_of_all = [this](double *values, size_t n) {
    const size_t most = MAXSMALLINT / 16;
    for (size_t k = 0; k < n; k += most)
      MPI_Allreduce(MPI_IN_PLACE, values + k, static_cast<int>(std::min(n - k, most)), MPI_DOUBLE,
                    MPI_MIN, world);
  };
  const double begun = MPI_Wtime();
  double stage_begun = begun, said = begun;
  const auto progress = [&](const char *stage, double share) {
    const double now = MPI_Wtime();
    if (share == 0.0) stage_begun = now;
    if (comm->me == 0 && now - said >= TELL_EVERY && share > 0.0) {
      utils::logmesg(lmp, "Find_slip: {}, {:.0f} % done, about {:.0f} s to go\n", stage,
                     100.0 * share, (now - stage_begun) * (1.0 / share - 1.0));
      if (screen) fflush(screen);
      if (logfile) fflush(logfile);
      said = now;
    }
  };
  const Slope::SlipRanks ranks = {comm->me, comm->nprocs, least_of_all, progress};
  Slope::SlipSearch search(options.ground(), limits, ranks, maker);
  const std::vector<SlipBody> bodies = search.run();
  if (bodies.empty() && search.least_left_out() < HUGE_VAL)
    error->all(FLERR,
               "Find_slip method spencer must balance a surface within the limits, got none, where "
               "bishop has {:.4g} "
               "at least: use bishop",
               search.least_left_out());
  if (bodies.empty())
    error->all(
        FLERR,
        "Find_slip limits must leave a sphere inside the terrain, volume {:g} to {:g}, depth "
        "{:g} to {:g}, got none of {} that were tried",
        limits.volume_lo, limits.volume_hi, limits.depth_lo, limits.depth_hi, search.surfaces());
  least = search.least();
  if (comm->me) return bodies;
  SlipBody first;
  maker.exact(bodies[0].surface, first);
  warn(maker);
  utils::logmesg(lmp, "Find_slip: lattice of {} spheres, {:.3g} s\n", search.surfaces(),
                 MPI_Wtime() - begun);
  if (search.least_left_out() < (1.0 - LEFT_OUT) * bodies[0].factor)
    error->warning(
        FLERR,
        "Find_slip method spencer has no factor for surfaces that bishop gives {:.4g}, where "
        "the least that it has is {:.4g}: these may be the first to slide, use bishop",
        search.least_left_out(), bodies[0].factor);
  if (bodies.size() < static_cast<size_t>(limits.keep))
    error->warning(FLERR, "Find_slip keep: only {} of {} bodies that differ were found",
                   bodies.size(), limits.keep);
  return bodies;
}

/* ---------------------------------------------------------------------- */

void FindSlip::report(const std::vector<SlipBody> &bodies) const
{
  if (comm->me) return;
  if (bodies[0].factor > HUGE_FACTOR)
    error->warning(
        FLERR, "Find_slip: factor of safety {:.4g}: is the strength in Pa, the density in kg/m3?",
        bodies[0].factor);
  for (const SlipBody &body : bodies)
    utils::logmesg(lmp,
                   "Find_slip: factor {:.5f}, yield coefficient {:.4f}, direction {:.2f}, volume "
                   "{:.6g}, area {:.6g}, depth {:.5g}\n",
                   body.factor, body.yield, body.surface.direction * 180.0 / Slope::PI, body.volume,
                   body.area, body.depth);
}

/* ---------------------------------------------------------------------- */

void FindSlip::warn(const SlipBodyMaker &maker) const
{
  if (comm->me) return;
  if (maker.share_bounded() > DOUBTED)
    error->warning(FLERR, "Find_slip: m_alpha is at its bound below {:.3g} of the weight",
                   maker.share_bounded());
  if (maker.share_pulled() > DOUBTED)
    error->warning(FLERR, "Find_slip: normal forces pull below {:.3g} of the weight",
                   maker.share_pulled());
}

/* ----------------------------------------------------------------------
   Internal variables: ${PREFIX_x} and v_PREFIX_x. A later find_slip replaces their values by internal_set(): in
   LAMMPS, set() of an internal variable that is there stores the value where the next new one would be, and
   takes no nan.
------------------------------------------------------------------------- */

static std::string variable(const SlipOptions &options, const char *end)
{
  return options.variable() + end;
}

void FindSlip::check_variables(const SlipOptions &options) const
{
  for (const char *end : ENDS) {
    const std::string name = variable(options, end);
    const int n = input->variable->find(name.c_str());
    if (n >= 0 && !input->variable->internalstyle(n))
      error->all(
          FLERR,
          "Find_slip output must not begin the names of variables that are not of a find_slip, got "
          "{}, and there is a variable {}: use another PREFIX, or delete the variable",
          options.output, name);
  }
}

void FindSlip::set_variables(const SlipOptions &options, const SlipBody &body) const
{
  const Slope::SlipSurface &s = body.surface;
  const double values[] = {s.x, s.y, s.z, s.radius, body.factor, body.yield};
  Variable *variables = input->variable;
  for (int k = 0; k < NVARIABLE; k++) {
    std::string name = variable(options, ENDS[k]), style = "internal", value = "0";
    char *words[3] = {&name[0], &style[0], &value[0]};
    if (variables->find(words[0]) < 0) variables->set(3, words);
    variables->internal_set(variables->find(words[0]), values[k]);
  }
}

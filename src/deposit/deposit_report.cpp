/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "deposit_report.h"

#include "atomic_file.h"
#include "deposit_balls.h"
#include "lammps_compat.h"
#include "rank_zero.h"
#include "slope_version.h"

#include "comm.h"
#include "error.h"
#include "timer.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using Slope::DepositRasters;
using Slope::DepositSummary;
using Slope::FileSet;
typedef DepositResults Result;

static const std::string LEFT = ".left.csv";    // the balls that left the ground

/* ---------------------------------------------------------------------- */

DepositReport::DepositReport(LAMMPS *lmp, const std::string &id, const DepositOptions &options_in,
                             const DepositBalls &balls_in) :
    Pointers(lmp),
    fix_id(id), options(options_in), balls(balls_in), limit(0.0), limit_set(0.0), before(), last()
{
}

/* ---------------------------------------------------------------------- */

void DepositReport::begin_run()
{
  on_rank_zero(lmp, "Fix deposit/grid", [this]() {
    std::vector<std::string> paths = {options.prefix + ".summary.yaml", options.prefix + LEFT};
    for (const DepositRasters::File &file : DepositRasters::files(options.prefix, ""))
      paths.push_back(file.path);
    FileSet::probe(paths);
    lock.take(options.prefix, lmp);
  });
  limit = timer->get_timeout_remain();    // fix halt ends a run as a time limit does
  limit_set = MPI_Wtime();
}

/* ----------------------------------------------------------------------
   fix halt and a time limit leave the loop before the last step, or in it, and look alike then,
   but a time limit takes its time
------------------------------------------------------------------------- */

std::string DepositReport::reason() const
{
  if (update->ntimestep == update->laststep && !timer->is_timeout()) return "run completed";
  const bool limited = limit != 0.0 && MPI_Wtime() - limit_set >= limit;
  return limited || compat::fixes_of_style(lmp, "halt").empty() ? "time limit" : "halted";
}

/* ---------------------------------------------------------------------- */

void DepositReport::warn(const std::string &line)
{
  if (comm->me > 0) return;
  warnings.push_back(fmt::format("Fix deposit/grid {}: {}", fix_id, line));
  error->warning(FLERR, warnings.back());
}

/* ---------------------------------------------------------------------- */

void DepositReport::write(const std::string &why, const DepositResults &results,
                          const DepositRasters &rasters, const std::string &left,
                          const ContactGuards *guards)
{
  DepositSummary about = summary(why, results);
  note_guards(guards);
  ContactGuards::Found found = before;
  found.add(last);
  about.guards = {guards != nullptr, found.deepest, found.energy_growth, found.deep,
                  found.dangerous_builds};
  about.warnings = of_guards;
  about.warnings.insert(about.warnings.end(), warnings.begin(), warnings.end());
  add_lost(about);
  const std::string number = options.series ? std::to_string(update->ntimestep) : std::string();
  on_rank_zero(lmp, "Fix deposit/grid", [&]() {
    about.largest = {
        rasters.largest(DepositRasters::THICKNESS), rasters.largest(DepositRasters::MAX_THICKNESS),
        rasters.largest(DepositRasters::MAX_SPEED), rasters.largest(DepositRasters::MAX_ENERGY)};
    FileSet files;
    for (const DepositRasters::File &file : DepositRasters::files(options.prefix, number))
      rasters.write(files.add(file.path), file);
    files.add(options.prefix + LEFT).write(left);
    about.files = files.names();
    files.add(options.prefix + ".summary.yaml").write(about.text());
    files.commit();
  });
}

/* ----------------------------------------------------------------------
   all but what the rasters hold
------------------------------------------------------------------------- */

DepositSummary DepositReport::summary(const std::string &why, const DepositResults &results) const
{
  const DepositRelease::Released &released = results.released;
  const double *value = results.vector;
  DepositSummary s = DepositSummary();
  s.slope_version = SLOPE_VERSION;
  s.lammps_version = lmp->version;
  s.fix = fix_id;
  s.step = update->ntimestep;
  s.time = results.time;
  s.dt = update->dt;
  s.ranks = comm->nprocs;
  s.reason = why;
  s.grid = options.grid;
  s.released = released;
  s.region = options.body;
  s.bulk_factor = balls.bulk();
  s.present = results.present;
  s.lost = value[Result::NLOST];
  s.volume = {value[Result::ON_GRID], value[Result::OFF_GRID], value[Result::LOST],
              value[Result::RESIDUAL]};
  s.travel = {value[Result::CENTROID],
              {value[Result::FRONT], value[Result::REACH]},
              balls.quantiles(released.mass.top, value[Result::LOST])};

  double moving;
  s.motion = balls.motion(options.motion, moving);
  const double left = released.volume - value[Result::LOST];
  s.motion.moving_share = results.present > 0.0 ? moving / left : 0.0;
  s.motion.fast_share = s.motion.fast_volume / released.volume;
  s.change_rate = value[Result::CHANGE];
  s.rest_share = options.rest;
  return s;
}

/* ---------------------------------------------------------------------- */

void DepositReport::begin_guards()
{
  before.add(last);
  last = ContactGuards::Found();
}

void DepositReport::note_guards(const ContactGuards *guards)
{
  if (!guards) return;
  last = guards->found();
  for (const std::string &text : guards->warnings)
    if (std::find(of_guards.begin(), of_guards.end(), text) == of_guards.end())
      of_guards.push_back(text);
}

/* ---------------------------------------------------------------------- */

void DepositReport::archive(Slope::Archive &archive)
{
  ContactGuards::Found found = before;
  found.add(last);
  archive.number("deepest_contact", found.deepest);
  archive.number("deep_contacts", found.deep);
  archive.number("energy_growth", found.energy_growth);
  archive.number("dangerous_builds", found.dangerous_builds);
  archive.lines("warnings_of_guards", of_guards);
  archive.lines("warnings", warnings);
  if (!archive.reads()) return;
  before = found;
  last = ContactGuards::Found();
}

/* ----------------------------------------------------------------------
   of these results, so not among the warnings that stay; before those of single balls
------------------------------------------------------------------------- */

void DepositReport::add_lost(DepositSummary &s) const
{
  if (s.lost == 0.0) return;
  const std::string text = fmt::format(
      "Fix deposit/grid {}: the released volume must stay in the box: {:.3g} % of it "
      "left, in {:.0f} of {:.0f} balls, and lies beyond what is written here; use a "
      "larger box",
      fix_id, 100.0 * s.volume.lost / s.released.volume, s.lost, s.released.mass.number);
  s.warnings.insert(s.warnings.begin(), text);
}

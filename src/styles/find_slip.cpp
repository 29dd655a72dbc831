/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "find_slip.h"

#include "constants.h"
#include "rank_zero.h"
#include "slip_body.h"
#include "slip_options.h"
#include "slip_writer.h"

#include "comm.h"
#include "error.h"
#include "input.h"
#include "variable.h"

using namespace LAMMPS_NS;
using Slope::SlipBody;
using Slope::SlipBodyMaker;

static constexpr double DOUBTED = 0.05;    // of the weight
static constexpr double HUGE_FACTOR = 100.0;

/* ----------------------------------------------------------------------
   find_slip REGION strength C PHI DENSITY keyword value ... output PREFIX
------------------------------------------------------------------------- */

void FindSlip::command(int narg, char **arg)
{
  const SlipOptions options(lmp, narg, arg);
  on_rank_zero(lmp, "Find_slip", [&]() {
    Slope::SlipWriter::probe(options.output, 1);
  });
  const Slope::SlipSoil soil = options.soil();
  const std::vector<char> allowed = options.allowed();
  SlipBodyMaker maker(options.ground(), soil, allowed, options.task);

  SlipBody body;
  compute(options, maker, body);
  on_rank_zero(lmp, "Find_slip", [&]() {
    Slope::SlipWriter::write(options.output, options.ground(), {body}, maker);
  });
  set_variables(options, body);
}

/* ---------------------------------------------------------------------- */

void FindSlip::compute(const SlipOptions &options, SlipBodyMaker &maker, SlipBody &body) const
{
  const std::string problem = maker.exact(options.surface, body);
  const Slope::SlipSurface &s = options.surface;
  if (!problem.empty())
    error->all(FLERR,
               "Find_slip surface must cut a body out of the terrain, got sphere {:.8g} "
               "{:.8g} {:.8g} {:.8g}: {}",
               s.x, s.y, s.z, s.radius, problem);
  if (!std::isfinite(body.factor))
    error->all(FLERR,
               "Find_slip direction must be one in which the weight drives the body, got {:.6g}",
               body.surface.direction * 180.0 / Slope::PI);
  body.yield = maker.yield();
  warn(maker);
  if (comm->me) return;
  if (body.factor > HUGE_FACTOR)
    error->warning(FLERR,
                   "Find_slip: factor of safety {:.4g}: is the strength in Pa, the density in "
                   "kg/m3?",
                   body.factor);
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
   internal variables: ${PREFIX_x} and v_PREFIX_x, and a later find_slip replaces them
------------------------------------------------------------------------- */

void FindSlip::set_variables(const SlipOptions &options, const SlipBody &body) const
{
  const Slope::SlipSurface &s = body.surface;
  const struct {
    const char *name;
    double value;
  } all[] = {
      {"_x", s.x},           {"_y", s.y}, {"_z", s.z}, {"_r", s.radius}, {"_factor", body.factor},
      {"_yield", body.yield}};
  for (const auto &one : all) {
    std::string name = options.variable() + one.name, style = "internal",
                value = fmt::format("{:.17g}", one.value);
    char *words[3] = {&name[0], &style[0], &value[0]};
    input->variable->set(3, words);
  }
}

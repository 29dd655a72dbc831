/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* The package as a plugin: registers its styles with an lmp that was built without them. The
   build writes the lists of styles, style_*.h, as LAMMPS' own build does. */

#include "lammpsplugin.h"

#include "error.h"
#include "lammps.h"
#include "library.h"
#include "slope_version.h"
#include "version.h"

#include "style_command.h"
#include "style_fix.h"
#include "style_pair.h"
#include "style_region.h"

#include <mpi.h>
#include <string>

using namespace LAMMPS_NS;

template <typename Base, typename Style> static Base *make(LAMMPS *lmp)
{
  return new Style(lmp);
}

template <typename Base, typename Style>
static Base *make_by_args(LAMMPS *lmp, int narg, char **arg)
{
  return new Style(lmp, narg, arg);
}

/* ----------------------------------------------------------------------
   an lmp of another version, with other sizes or without MPI has its classes laid out in
   another way: it is asked by its C interface, before anything can crash
------------------------------------------------------------------------- */

static void check_host(LAMMPS *lmp)
{
#ifdef MPI_STUBS
  const int has_mpi = 0;
#else
  const int has_mpi = 1;
#endif
  struct {
    const char *what;
    int built_for, got;
  } const checks[] = {
      {"LAMMPS version", SLOPE_LAMMPS_VERSION, lammps_version(lmp)},
      {"bytes of a tagint (LAMMPS_SIZES)", sizeof(tagint), lammps_extract_setting(lmp, "tagint")},
      {"bytes of a bigint (LAMMPS_SIZES)", sizeof(bigint), lammps_extract_setting(lmp, "bigint")},
      {"MPI (BUILD_MPI)", has_mpi, lammps_config_has_mpi_support() ? 1 : 0},
  };
  for (const auto &check : checks)
    if (check.built_for != check.got)
      lmp->error->all(FLERR, "Plugin slope: {} must be {}, for which it was built, got {}",
                      check.what, check.built_for, check.got);
}

/* ---------------------------------------------------------------------- */

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *register_style)
{
  check_host(static_cast<LAMMPS *>(lmp));

  lammpsplugin_t plugin;
  plugin.version = LAMMPS_VERSION;
  plugin.author = "the SLOPE package";
  plugin.handle = handle;

  auto add = [&](const char *style, const char *name) {
    const std::string info = fmt::format("SLOPE {}, {} {}", SLOPE_VERSION, style, name);
    plugin.style = style;
    plugin.name = name;
    plugin.info = info.c_str();
    reinterpret_cast<lammpsplugin_regfunc>(register_style)(&plugin, lmp);
  };
  auto add1 = [&](const char *style, const char *name, lammpsplugin_factory1 *factory) {
    plugin.creator.v1 = factory;
    add(style, name);
  };
  auto add2 = [&](const char *style, const char *name, lammpsplugin_factory2 *factory) {
    plugin.creator.v2 = factory;
    add(style, name);
  };

#define COMMAND_CLASS
#define CommandStyle(key, Class) \
  add1("command", #key, (lammpsplugin_factory1 *) &make<Command, Class>)
#include "style_command.h"

#define FIX_CLASS
#define FixStyle(key, Class) add2("fix", #key, (lammpsplugin_factory2 *) &make_by_args<Fix, Class>)
#include "style_fix.h"

#define PAIR_CLASS
#define PairStyle(key, Class) add1("pair", #key, (lammpsplugin_factory1 *) &make<Pair, Class>)
#include "style_pair.h"

#define REGION_CLASS
#define RegionStyle(key, Class) \
  add2("region", #key, (lammpsplugin_factory2 *) &make_by_args<Region, Class>)
#include "style_region.h"
}

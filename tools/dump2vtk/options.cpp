/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "options.h"

#include "line_reader.h"
#include "numbers.h"

#include <cmath>
#include <map>
#include <stdexcept>

using namespace Slope;

const char Slope::HELP[] =
    R"(Usage: dump2vtk DUMP... [--terrain TERRAIN.asc] -o OUT [options]

Makes files for ParaView from text dumps of LAMMPS (dump styles atom and custom, plain or .gz),
and from the terrain, rasters and fixed balls of the same run. Lengths are metres, times seconds
and speeds m/s where the run is in units si; the values are not converted.

  DUMP...             dumps, with one or several snapshots each, in any order
  -o OUT              start of the names of all files, may contain a folder that exists

  --deposit PREFIX    what fix deposit/grid wrote: as --terrain PREFIX.base.asc (the ground without
                      the body: the scar shows) --raster PREFIX.thickness.asc
                      --surface PREFIX.surface.asc, and the time step of PREFIX.summary.yaml
  --dt DT             time = step * DT; without it the dump's ITEM: TIME, or else the step number
  --terrain FILE.asc  the ground, at its cell centres
  --raster FILE.asc...  rasters, such as PREFIX.thickness.asc, laid on the ground
  --surface FILE.asc  lay the rasters on these heights, such as PREFIX.surface.asc, instead
  --balls FILE...     fixed balls, "x y z" lines as fix wall/gran/balls writes them
  --diameter D        of the fixed balls, and of dumped ones without a column diameter or radius
  --single            values with 7 digits instead of 16: half the size
  --skip-truncated    leave out snapshots that are cut short, with a warning
  --help

Writes OUT.pvd (the time series: open this one), OUT/OUT_STEP.vtp, OUT.terrain.vts, OUT.NAME.vts
for each raster, OUT.balls.vtp. Either all files are written or none.

Example:
  dump2vtk embankment.*.dump --deposit embankment -o embankment
)";

namespace {

double positive(const std::string &name, const std::string &word)
{
  double value;
  if (!to_number(word, value) || !(value > 0.0) || !std::isfinite(value))
    throw std::runtime_error(name + " must be a number > 0, got " + word);
  return value;
}

// time step in the summary that fix deposit/grid wrote

double time_step_of(const std::string &path)
{
  LineReader file(path);
  while (file.next()) {
    const auto &words = file.words();
    double value;
    if (words.size() < 2 || words[0] != "dt:") continue;
    if (!to_number(words[1], value) || !(value > 0.0) || !std::isfinite(value))
      file.fail("dt must be a number > 0, got " + std::string(words[1].substr(0, 40)));
    return value;
  }
  throw std::runtime_error(path +
                           " must be a summary of fix deposit/grid, with a line dt:, got none");
}

// what --deposit stands for, where the command line does not say it otherwise

void add_deposit(Options &options)
{
  if (options.terrain.empty()) options.terrain = options.deposit + ".base.asc";
  if (options.surface.empty()) options.surface = options.deposit + ".surface.asc";
  options.rasters.insert(options.rasters.begin(), options.deposit + ".thickness.asc");
  if (!options.dumps.empty() && options.dt == 0.0)
    options.run_dt = time_step_of(options.deposit + ".summary.yaml");
}

// what must be given together

void check(const Options &options, const std::string &out)
{
  if (options.dumps.empty() && options.terrain.empty() && options.rasters.empty() &&
      options.balls.empty())
    throw std::runtime_error(
        "no input: give dumps, --deposit, --terrain, --raster or --balls; see --help");
  if (out.empty()) throw std::runtime_error("-o OUT is missing; see --help");
  if (!options.balls.empty() && options.diameter == 0.0)
    throw std::runtime_error("--balls needs --diameter");
  if (!options.rasters.empty() && options.terrain.empty() && options.surface.empty())
    throw std::runtime_error("--raster needs --terrain or --surface to lie on");
  if (options.rasters.empty() && !options.surface.empty())
    throw std::runtime_error("--surface needs --raster");
}

}    // namespace

/* ---------------------------------------------------------------------- */

Options Slope::parse_options(const std::vector<std::string> &words)
{
  Options options;
  std::string out;
  std::map<std::string, std::string *> one = {{"--terrain", &options.terrain},
                                              {"--surface", &options.surface},
                                              {"--deposit", &options.deposit},
                                              {"-o", &out}};
  std::map<std::string, std::vector<std::string> *> many = {{"--raster", &options.rasters},
                                                            {"--balls", &options.balls}};
  std::map<std::string, double *> numbers = {{"--dt", &options.dt},
                                             {"--diameter", &options.diameter}};
  std::map<std::string, bool *> flags = {{"--single", &options.single},
                                         {"--skip-truncated", &options.skip}};

  bool plain = false;    // after --
  for (size_t i = 0; i < words.size(); i++) {
    std::string name = words[i];
    if (plain || name.size() < 2 || name[0] != '-') {
      options.dumps.push_back(name);
      continue;
    }
    if (name == "--") {
      plain = true;
      continue;
    }

    // values: the words up to the next option, or what follows the = sign

    std::vector<std::string> values;
    const size_t equal = name.find('=');
    if (equal != std::string::npos) {
      values.push_back(name.substr(equal + 1));
      name.erase(equal);
    }
    if (name == "--output") name = "-o";
    if (flags.count(name)) {
      if (!values.empty()) throw std::runtime_error(name + " takes no value, got " + values[0]);
      *flags[name] = true;
      continue;
    }
    if (!one.count(name) && !many.count(name) && !numbers.count(name))
      throw std::runtime_error("unknown option " + name + "; see --help");
    auto is_value = [&](const std::string &word) {
      double value;
      return word.empty() || word[0] != '-' || to_number(word, value);
    };
    if (values.empty())
      while (i + 1 < words.size() && is_value(words[i + 1]) && (values.empty() || many.count(name)))
        values.push_back(words[++i]);
    if (values.empty() || values[0].empty()) throw std::runtime_error(name + " must have a value");

    if (many.count(name)) {
      many[name]->insert(many[name]->end(), values.begin(), values.end());
    } else if (numbers.count(name)) {
      if (*numbers[name] > 0.0) throw std::runtime_error(name + " is given twice");
      *numbers[name] = positive(name, values[0]);
    } else {
      if (!one[name]->empty()) throw std::runtime_error(name + " is given twice");
      *one[name] = values[0];
    }
  }

  if (!options.deposit.empty()) add_deposit(options);
  check(options, out);

  options.out = out;
  if (options.out.extension() == ".pvd") options.out.replace_extension();
  const std::string name = options.out.filename();
  if (name.empty() || name == "." || name == "..")
    throw std::runtime_error("-o must end in a name, got " + out);
  return options;
}

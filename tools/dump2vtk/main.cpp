/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2

   dump2vtk: dumps, terrain, rasters and fixed balls as files for ParaView.
   See doc/src/tool_dump2vtk.rst.
------------------------------------------------------------------------- */

#include "dump_reader.h"

#include "atomic_file.h"
#include "elevation_grid.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStructuredGrid.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLStructuredGridWriter.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <unistd.h>

using namespace Slope;
namespace fs = std::filesystem;

static constexpr int COMPRESSION = 1;    // of zlib; VTK's 5 costs a third more time and saves 1 %
static constexpr int STEP_DIGITS = 8;
static const double NaN = std::numeric_limits<double>::quiet_NaN();

static const char HELP[] =
    R"(Usage: dump2vtk DUMP... [--terrain TERRAIN.asc] -o OUT [options]

Makes files for ParaView from text dumps of LAMMPS (dump styles atom and custom, plain or .gz),
and from the terrain, rasters and fixed balls of the same run. Lengths are metres, times seconds
and speeds m/s where the run is in units si; the values are not converted.

  DUMP...             dumps, with one or several snapshots each, in any order
  -o OUT              begin of the names of all files, may contain a folder that exists

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

volatile std::sig_atomic_t interrupted = 0;

// what a signal ends with, after the destructors have removed what was begun
class Interrupted {};

void check_interrupt()
{
  if (interrupted) throw Interrupted();
}

// with 15 digits: step * dt is 3.024 and not 3.0239999999999996

std::string to_text(double value)
{
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value, std::chars_format::general, 15);
  return std::string(text, end.ptr);
}

std::string reason(const std::error_code &error)
{
  return error.default_error_condition().message();
}

/* ---------------------------------------------------------------------- */

struct Options {
  std::vector<std::string> dumps, rasters, balls;
  std::string terrain, surface, deposit;
  fs::path out;            // without the ending of any file
  double dt = 0.0;         // 0: not given
  double run_dt = 0.0;     // of the deposit's summary, for dumps without a time
  double diameter = 0.0;
  bool single = false, skip = false;
};

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
  throw std::runtime_error(path + " must be a summary of fix deposit/grid, with a line dt:, got none");
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

Options parse(const std::vector<std::string> &words)
{
  Options options;
  std::string out;
  std::map<std::string, std::string *> one = {
      {"--terrain", &options.terrain}, {"--surface", &options.surface},
      {"--deposit", &options.deposit}, {"-o", &out}};
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

  options.out = out;
  if (options.out.extension() == ".pvd") options.out.replace_extension();
  const std::string name = options.out.filename();
  if (name.empty() || name == "." || name == "..")
    throw std::runtime_error("-o must end in a name, got " + out);
  return options;
}

/* ----------------------------------------------------------------------
   A line of progress on a terminal
------------------------------------------------------------------------- */

class Progress {
 public:
  Progress() : tty(isatty(STDERR_FILENO)), shown(false) {}
  ~Progress() { clear(); }

  void say(const std::string &text)
  {
    const auto now = std::chrono::steady_clock::now();
    if (!tty || (shown && now - last < std::chrono::milliseconds(200))) return;
    fprintf(stderr, "\rdump2vtk: %s\033[K", text.c_str());
    fflush(stderr);
    last = now;
    shown = true;
  }

  void clear()
  {
    if (shown) fprintf(stderr, "\r\033[K");
    shown = false;
  }

  void warn(const std::string &text)
  {
    clear();
    fprintf(stderr, "dump2vtk: warning: %s\n", text.c_str());
  }

 private:
  bool tty, shown;
  std::chrono::steady_clock::time_point last;
};

/* ----------------------------------------------------------------------
   All output files. They are written in a folder of their own beside OUT, and get their names when
   the last one is complete; without commit() nothing is left behind.
------------------------------------------------------------------------- */

class Output {
 public:
  explicit Output(const fs::path &_out) : out(_out), name(_out.filename())
  {
    std::error_code error;
    if (fs::exists(out, error) && !fs::is_directory(out, error))
      throw std::runtime_error("cannot write " + out.string() + "/: a file has this name");
    std::string pattern = out.string() + ".tmp.XXXXXX";
    if (!mkdtemp(pattern.data()))
      throw std::runtime_error("cannot write " + out.string() + ".*: " + strerror(errno));
    beside = pattern;
  }

  ~Output()
  {
    std::error_code error;
    fs::remove_all(beside, error);
  }

  // where to write a file; its name is relative to OUT's folder
  std::string path(const fs::path &file)
  {
    if (files.empty() || files.back() != file) files.push_back(file);
    return (beside / file.filename()).string();
  }

  // OUT/OUT_STEP.vtp: many files, so they have a folder of their own
  fs::path snapshot(int64_t step) const
  {
    std::string digits = std::to_string(step);
    digits.insert(0, std::max<int>(0, STEP_DIGITS - digits.size()), '0');
    return fs::path(name) / (name + "_" + digits + ".vtp");
  }

  fs::path single(const std::string &ending) const { return name + "." + ending; }

  void commit(bool series)
  {
    check_interrupt();
    std::error_code error;
    if (series) {
      fs::create_directory(out, error);
      if (error) fail(out, error);
      remove_old();
    }
    for (const auto &file : files) {
      const fs::path target = out.parent_path() / file;
      fs::rename(beside / file.filename(), target, error);
      if (error) fail(target, error);
    }
  }

 private:
  fs::path out, beside;
  std::string name;
  std::vector<fs::path> files;

  Output(const Output &) = delete;
  Output &operator=(const Output &) = delete;

  [[noreturn]] void fail(const fs::path &target, const std::error_code &error) const
  {
    throw std::runtime_error("cannot write " + target.string() + ": " + reason(error));
  }

  // Snapshots of an earlier call: ParaView would take them for part of the series

  void remove_old() const
  {
    std::error_code error;
    for (const auto &entry : fs::directory_iterator(out, error)) {
      const std::string file = entry.path().filename(), begin = name + "_";
      if (file.compare(0, begin.size(), begin) != 0 || entry.path().extension() != ".vtp") continue;
      const std::string digits = file.substr(begin.size(), file.size() - begin.size() - 4);
      if (digits.size() < STEP_DIGITS || digits.find_first_not_of("0123456789") != digits.npos)
        continue;
      fs::remove(entry.path(), error);
      if (error) fail(entry.path(), error);
    }
  }
};

/* ---------------------------------------------------------------------- */

template <class Writer, class Data> void write(Data *data, const std::string &path)
{
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetFileName(path.c_str());
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();    // arrays above 4 GB
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(COMPRESSION);
  const bool written = writer->Write() && writer->GetErrorCode() == vtkErrorCode::NoError;

  // VTK does not look at what the last flush of the file says, so look at the file's end

  const std::string ending = "</VTKFile>\n";
  std::string tail(ending.size(), ' ');
  if (written) {
    std::ifstream file(path, std::ios::binary);
    file.seekg(-(std::streamoff) ending.size(), std::ios::end);
    file.read(tail.data(), tail.size());
  }
  if (tail != ending) {
    const auto code = writer->GetErrorCode();
    throw std::runtime_error("cannot write " + path + ": " +
                             (code == vtkErrorCode::NoError
                                  ? "the file is incomplete, is the disk full?"
                                  : vtkErrorCode::GetStringFromErrorCode(code)));
  }
}

// n tuples of value(i,k), in double or single precision

template <class Value>
vtkSmartPointer<vtkDataArray> make_array(const char *name, vtkIdType n, int ncomponents,
                                         bool single, Value value)
{
  auto fill = [&](auto array) {
    array->SetName(name);
    array->SetNumberOfComponents(ncomponents);
    array->SetNumberOfTuples(n);
    auto *at = array->GetPointer(0);
    for (vtkIdType i = 0; i < n; i++)
      for (int k = 0; k < ncomponents; k++) *at++ = value(i, k);
    return vtkSmartPointer<vtkDataArray>(array);
  };
  if (single) return fill(vtkSmartPointer<vtkFloatArray>::New());
  return fill(vtkSmartPointer<vtkDoubleArray>::New());
}

template <class Value>
vtkSmartPointer<vtkDataArray> make_integers(const char *name, vtkIdType n, Value value)
{
  auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
  array->SetName(name);
  array->SetNumberOfTuples(n);
  for (vtkIdType i = 0; i < n; i++) array->SetValue(i, value(i));
  return array;
}

// Points with one vertex each: filters and selections of ParaView work on cells

vtkSmartPointer<vtkPolyData> make_balls(const std::vector<double> &xyz, bool single)
{
  const vtkIdType n = xyz.size() / 3;
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(make_array("Points", n, 3, single, [&](vtkIdType i, int k) {
    return xyz[3 * i + k];
  }));
  data->SetPoints(points);
  vtkNew<vtkCellArray> verts;
  verts->AllocateExact(n, n);
  for (vtkIdType i = 0; i < n; i++) verts->InsertNextCell(1, &i);
  data->SetVerts(verts);
  return data;
}

/* ----------------------------------------------------------------------
   A snapshot's columns as point arrays
------------------------------------------------------------------------- */

struct Vector {
  const char *columns[3], *name, *magnitude;
};

static const Vector VECTORS[] = {{{"vx", "vy", "vz"}, "velocity", "speed"},
                                 {{"omegax", "omegay", "omegaz"}, "omega", "spin"},
                                 {{"fx", "fy", "fz"}, "force", nullptr},
                                 {{"tqx", "tqy", "tqz"}, "torque", nullptr}};

// columns that are whole numbers, whatever they hold in a snapshot: an array must not change its
// type from one time step to the next
bool is_whole(const std::string &name)
{
  for (const char *whole : {"id", "mol", "type", "proc", "procp1", "ix", "iy", "iz"})
    if (name == whole) return true;
  return false;
}

void convert(const Snapshot &snapshot, const LineReader &file, const Options &options, double time,
             const std::string &path)
{
  std::vector<double> xyz;
  std::array<int, 3> coordinates;
  positions(snapshot, file, xyz, coordinates);
  auto data = make_balls(xyz, options.single);
  const vtkIdType n = snapshot.count;
  std::vector<double>().swap(xyz);

  auto add = [&](vtkSmartPointer<vtkDataArray> array) {
    data->GetPointData()->AddArray(array);
  };
  std::vector<bool> done(snapshot.names.size());
  for (const int k : coordinates) done[k] = true;

  // diameter

  const int radius = snapshot.find("radius");
  if (snapshot.find("diameter") < 0 && radius >= 0) {
    const auto &values = snapshot.columns[radius];
    add(make_array("diameter", n, 1, options.single, [&](vtkIdType i, int) {
      return 2.0 * values[i];
    }));
  } else if (snapshot.find("diameter") < 0 && options.diameter > 0.0) {
    add(make_array("diameter", n, 1, options.single, [&](vtkIdType, int) {
      return options.diameter;
    }));
  }

  // vectors; a column of the dump goes before an array of ours of the same name

  for (const auto &vector : VECTORS) {
    int column[3];
    for (int k = 0; k < 3; k++) column[k] = snapshot.find(vector.columns[k]);
    if (*std::min_element(column, column + 3) < 0 || snapshot.find(vector.name) >= 0) continue;
    auto component = [&](vtkIdType i, int k) {
      return snapshot.columns[column[k]][i];
    };
    add(make_array(vector.name, n, 3, options.single, component));
    for (const int k : column) done[k] = true;
    if (vector.magnitude && snapshot.find(vector.magnitude) < 0)
      add(make_array(vector.magnitude, n, 1, options.single, [&](vtkIdType i, int) {
        return std::hypot(component(i, 0), component(i, 1), component(i, 2));
      }));
  }

  // all others by name

  for (size_t k = 0; k < snapshot.names.size(); k++) {
    const std::string &name = snapshot.names[k];
    const auto &values = snapshot.columns[k];
    if (done[k] || !snapshot.numeric[k]) continue;
    if (!is_whole(name)) {
      add(make_array(name.c_str(), n, 1, options.single, [&](vtkIdType i, int) {
        return values[i];
      }));
      continue;
    }
    for (vtkIdType i = 0; i < n; i++)
      if (!(std::fabs(values[i]) < 9e15) || values[i] != std::floor(values[i]))
        throw std::runtime_error(file.name() + ", line " +
                                 std::to_string(snapshot.atoms_line + 1 + i) + ": column " + name +
                                 " must be a whole number, got " + to_text(values[i]));
    add(make_integers(name.c_str(), n, [&](vtkIdType i) {
      return (vtkTypeInt64) values[i];
    }));
  }
  data->GetPointData()->SetActiveScalars("speed");
  data->GetPointData()->SetActiveVectors("velocity");

  // ParaView takes the time of a file that is opened without the .pvd from here

  data->GetFieldData()->AddArray(make_array("TimeValue", 1, 1, false, [&](vtkIdType, int) {
    return time;
  }));
  data->GetFieldData()->AddArray(make_integers("step", 1, [&](vtkIdType) {
    return (vtkTypeInt64) snapshot.step;
  }));
  write<vtkXMLPolyDataWriter>(data.Get(), path);
}

/* ---------------------------------------------------------------------- */

std::string xml_text(const std::string &text)
{
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

struct Entry {
  double time;
  std::string source;    // file and line of the snapshot
  bool has_time;
  size_t count;
  fs::file_time_type written;    // the file
};

void convert_dumps(const Options &options, Output &output, Progress &progress, std::string &report)
{
  int64_t total = 0, before = 0;
  for (const auto &path : options.dumps) {
    LineReader check(path);    // a misspelt name shows now and not after an hour
    total += fs::file_size(path);
  }

  std::map<int64_t, Entry> series;    // by step
  Snapshot snapshot;
  for (const auto &path : options.dumps) {
    DumpReader reader(path);
    size_t dropped = 0;
    std::string first, word;
    while (true) {
      check_interrupt();
      try {
        if (!reader.next(snapshot)) break;
      } catch (CutShort &error) {
        if (!options.skip) throw;
        progress.warn(std::string(error.what()) + "; skipped");
        continue;
      }
      const std::string source = path + ", line " + std::to_string(snapshot.first_line);
      const auto known = series.find(snapshot.step);
      if (known != series.end()) {
        if (dropped++ == 0)
          first = source + ": step " + std::to_string(snapshot.step) + " is dropped, it is in " +
              known->second.source;
        continue;
      }
      for (size_t k = 0; k < snapshot.names.size() && word.empty(); k++)
        if (!snapshot.numeric[k]) word = snapshot.names[k];

      const double time = options.dt > 0.0 ? snapshot.step * options.dt
          : snapshot.has_time              ? snapshot.time
          : options.run_dt > 0.0           ? snapshot.step * options.run_dt
                                           : snapshot.step;
      const Entry &other = series.empty() ? Entry{} : series.begin()->second;
      if (options.dt == 0.0 && !series.empty() && other.has_time != snapshot.has_time)
        throw std::runtime_error(source + ": ITEM: TIME must be in all snapshots or in none, " +
                                 "the one of " + other.source + " is different; give --dt");

      const fs::path file = output.snapshot(snapshot.step);
      convert(snapshot, reader.file(), options, time, output.path(file));
      series[snapshot.step] = {time, source, snapshot.has_time, snapshot.count,
                               fs::last_write_time(path)};
      progress.say(
          std::to_string(100 * (before + reader.file().bytes()) / std::max<int64_t>(1, total)) +
          " %, " + std::to_string(series.size()) + " snapshots, step " +
          std::to_string(snapshot.step));
    }
    before += fs::file_size(path);
    if (dropped > 1) first += "; so are " + std::to_string(dropped - 1) + " more of this file";
    if (dropped) progress.warn(first);
    if (!word.empty()) progress.warn(path + ": column " + word + " holds words and is left out");
  }
  if (series.empty()) throw std::runtime_error("the dumps have no complete snapshot");

  // what a longer run before left in the folder comes after the last step of this one

  auto other = series.begin();
  for (auto one = std::next(other); one != series.end(); other = one++)
    if (other->second.written - one->second.written > std::chrono::seconds(1)) {
      progress.warn(one->second.source + ": step " + std::to_string(one->first) +
                    " was written before step " + std::to_string(other->first) + " of " +
                    other->second.source + ": is it of another run?");
      break;
    }

  // after the snapshots, so that it gets its name last

  const fs::path pvd = output.single("pvd");
  AtomicFile file(output.path(pvd));
  file.write("<?xml version=\"1.0\"?>\n"
             "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
             "  <Collection>\n");
  for (const auto &[step, entry] : series)
    file.write("    <DataSet timestep=\"" + to_text(entry.time) +
               "\" group=\"\" part=\"0\" file=\"" + xml_text(output.snapshot(step).string()) +
               "\"/>\n");
  file.write("  </Collection>\n</VTKFile>\n");
  file.commit();

  const Entry &start = series.begin()->second, &end = series.rbegin()->second;
  report += (options.out.parent_path() / pvd).string() + ": " + std::to_string(series.size()) +
      " snapshots, step " + std::to_string(series.begin()->first) + " to " +
      std::to_string(series.rbegin()->first) + ", time " + to_text(start.time) + " to " +
      to_text(end.time) + ", " + std::to_string(end.count) + " balls in the last\n";
}

/* ----------------------------------------------------------------------
   The cell centres of a raster as points at given heights, with its values; hidden where either is
   NaN. Cells with a hidden corner are hidden too: some filters look at points only, some at cells.
   Returns the number of points that show.
------------------------------------------------------------------------- */

template <class Height>
size_t write_grid(const ElevationGrid &raster, const std::string &name, Height height, bool single,
                  const std::string &path)
{
  const int nx = raster.nx, ny = raster.ny;
  const vtkIdType n = (vtkIdType) nx * ny;
  std::vector<double> z(n);
  std::vector<bool> hidden(n);
  double lowest = NaN;
  size_t showing = 0;
  for (int j = 0; j < ny; j++) {
    check_interrupt();
    for (int i = 0; i < nx; i++) {
      const size_t k = (size_t) j * nx + i;
      z[k] = height(i, j);
      hidden[k] = std::isnan(z[k]) || std::isnan(raster.z[k]);
      if (!hidden[k]) showing++;
      if (!hidden[k] && !(z[k] >= lowest)) lowest = z[k];
    }
  }
  if (showing == 0) return 0;

  // Hidden points need a place too: the ground, so that a program that draws them hides nothing

  for (double &height : z)
    if (std::isnan(height)) height = lowest;

  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(nx, ny, 1);
  vtkNew<vtkPoints> points;
  points->SetData(make_array("Points", n, 3, single, [&](vtkIdType i, int k) {
    if (k == 0) return raster.xlo + (i % nx + 0.5) * raster.cell;
    if (k == 1) return raster.ylo + (i / nx + 0.5) * raster.cell;
    return z[i];
  }));
  grid->SetPoints(points);
  grid->GetPointData()->SetScalars(make_array(name.c_str(), n, 1, single, [&](vtkIdType i, int) {
    return hidden[i] ? NaN : raster.z[i];
  }));

  if ((vtkIdType) showing < n) {
    vtkNew<vtkUnsignedCharArray> point_ghosts, cell_ghosts;
    point_ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    point_ghosts->SetNumberOfTuples(n);
    for (vtkIdType i = 0; i < n; i++)
      point_ghosts->SetValue(i, hidden[i] ? vtkDataSetAttributes::HIDDENPOINT : 0);
    grid->GetPointData()->AddArray(point_ghosts);

    const int cx = std::max(1, nx - 1), cy = std::max(1, ny - 1);
    cell_ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    cell_ghosts->SetNumberOfTuples((vtkIdType) cx * cy);
    for (int j = 0; j < cy; j++)
      for (int i = 0; i < cx; i++) {
        bool any = false;
        for (int dj = 0; dj < std::min(2, ny); dj++)
          for (int di = 0; di < std::min(2, nx); di++)
            any = any || hidden[(size_t) (j + dj) * nx + i + di];
        cell_ghosts->SetValue((vtkIdType) j * cx + i, any ? vtkDataSetAttributes::HIDDENCELL : 0);
      }
    grid->GetCellData()->AddArray(cell_ghosts);
  }
  write<vtkXMLStructuredGridWriter>(grid.Get(), path);
  return showing;
}

std::string size_text(const ElevationGrid &raster, size_t showing)
{
  return std::to_string(raster.nx) + " x " + std::to_string(raster.ny) + " points, " +
      std::to_string((size_t) raster.nx * raster.ny - showing) + " of them hidden\n";
}

std::string extent_text(const ElevationGrid &raster)
{
  return "x " + to_text(raster.xlo) + " to " + to_text(raster.xhi()) + ", y " +
      to_text(raster.ylo) + " to " + to_text(raster.yhi());
}

// embankment.thickness.asc -> thickness, embankment.00000900.thickness.asc -> 00000900.thickness

std::string raster_name(const std::string &path)
{
  fs::path stem = fs::path(path).filename();
  if (stem.extension() == ".asc") stem = stem.stem();
  std::string name = stem.extension().string();
  if (name.size() < 2) return stem.string();
  const std::string before = stem.stem().extension().string();
  if (before.size() > 1 && before.find_first_not_of("0123456789", 1) == before.npos)
    name = before + name;
  return name.substr(1);
}

void convert_rasters(const Options &options, Output &output, Progress &progress,
                     std::string &report)
{
  const fs::path folder = options.out.parent_path();
  std::map<std::string, std::string> sources;    // of names that are taken
  if (!options.terrain.empty()) sources["terrain"] = options.terrain;
  for (const auto &path : options.rasters) {
    const std::string name = raster_name(path);
    if (sources.count(name))
      throw std::runtime_error("--raster: " + sources[name] + " and " + path +
                               " would both become " +
                               (folder / output.single(name + ".vts")).string());
    sources[name] = path;
  }

  ElevationGrid ground;
  if (!options.terrain.empty()) {
    progress.say("terrain");
    ground = ElevationGrid::read(options.terrain);
    const fs::path file = output.single("terrain.vts");
    auto height = [&](int i, int j) {
      return ground.at(i, j);
    };
    const size_t showing = write_grid(ground, "height", height, options.single, output.path(file));
    report += (folder / file).string() + ": " + size_text(ground, showing);
  }
  if (!options.surface.empty()) ground = ElevationGrid::read(options.surface);
  const std::string &base = options.surface.empty() ? options.terrain : options.surface;

  for (const auto &path : options.rasters) {
    const std::string name = raster_name(path);
    progress.say(name);
    const ElevationGrid raster = ElevationGrid::read(path);
    const fs::path file = output.single(name + ".vts");

    // On a centre of the ground's cells its height, also where rounding would put a little weight
    // on a NODATA neighbour

    auto height = [&](int i, int j) {
      const double x = raster.xlo + (i + 0.5) * raster.cell,
                   y = raster.ylo + (j + 0.5) * raster.cell;
      const double u = (x - ground.xlo) / ground.cell - 0.5,
                   v = (y - ground.ylo) / ground.cell - 0.5;
      const double column = std::round(u), row = std::round(v);
      if (std::fabs(u - column) < 1e-6 && std::fabs(v - row) < 1e-6 && column >= 0.0 &&
          row >= 0.0 && column < ground.nx && row < ground.ny)
        return ground.at(column, row);
      return ground.height(x, y);
    };
    const std::string array = name.substr(name.find('.') == name.npos ? 0 : name.find('.') + 1);
    const size_t showing = write_grid(raster, array, height, options.single, output.path(file));
    if (showing == 0)
      throw std::runtime_error(path + " must have a value somewhere on " + base + ", which is " +
                               extent_text(ground) + ", got " + extent_text(raster));
    report += (folder / file).string() + ": " + size_text(raster, showing);
  }
}

/* ---------------------------------------------------------------------- */

void convert_balls(const Options &options, Output &output, Progress &progress, std::string &report)
{
  std::vector<double> xyz;
  std::vector<size_t> ends;    // of each file's balls
  progress.say("fixed balls");
  for (const auto &path : options.balls) {
    LineReader file(path);
    while (file.next()) {
      auto words = file.words();
      const auto comment = std::find_if(words.begin(), words.end(), [](auto word) {
        return word[0] == '#';
      });
      words.erase(comment, words.end());
      if (words.empty()) continue;
      if (words.size() != 3)
        file.fail("must be x y z of a ball, got " + std::to_string(words.size()) + " words");
      for (const auto &word : words) {
        double value;
        if (!to_number(word, value) || !std::isfinite(value))
          file.fail("must be three finite numbers x y z, got " + std::string(word.substr(0, 40)));
        xyz.push_back(value);
      }
    }
    ends.push_back(xyz.size() / 3);
    if (ends.back() == (ends.size() > 1 ? ends[ends.size() - 2] : 0))
      throw std::runtime_error(path + " must have lines x y z, got none");
  }

  auto data = make_balls(xyz, options.single);
  const vtkIdType n = xyz.size() / 3;
  data->GetPointData()->AddArray(make_array("diameter", n, 1, options.single, [&](vtkIdType, int) {
    return options.diameter;
  }));
  data->GetPointData()->AddArray(make_integers("file", n, [&](vtkIdType i) {
    return 1 + (std::upper_bound(ends.begin(), ends.end(), (size_t) i) - ends.begin());
  }));
  const fs::path file = output.single("balls.vtp");
  write<vtkXMLPolyDataWriter>(data.Get(), output.path(file));
  report +=
      (options.out.parent_path() / file).string() + ": " + std::to_string(n) + " fixed balls\n";
}

int run(const std::vector<std::string> &words)
{
  for (const auto &word : words)
    if (word == "--help" || word == "-h") {
      fputs(HELP, stdout);
      return 0;
    }
  const Options options = parse(words);

  vtkObject::GlobalWarningDisplayOff();    // write() tells, in one line
  std::string report;
  Output output(options.out);
  {
    Progress progress;
    if (!options.terrain.empty() || !options.rasters.empty())
      convert_rasters(options, output, progress, report);
    if (!options.balls.empty()) convert_balls(options, output, progress, report);
    if (!options.dumps.empty()) convert_dumps(options, output, progress, report);
    output.commit(!options.dumps.empty());
  }
  fputs(report.c_str(), stdout);
  return 0;
}

void interrupt(int)
{
  interrupted = 1;
}

}    // namespace

/* ---------------------------------------------------------------------- */

int main(int narg, char **arg)
{
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, interrupt);
  std::signal(SIGXFSZ, SIG_IGN);    // a limit on file sizes is an error like a full disk

  std::string message;
  try {
    return run(std::vector<std::string>(arg + 1, arg + narg));
  } catch (Interrupted &) {
    fputs("dump2vtk: interrupted, nothing is written\n", stderr);
    return 130;
  } catch (std::bad_alloc &) {
    message = "not enough memory for one snapshot or raster";
  } catch (std::exception &error) {
    message = error.what();
  }
  fprintf(stderr, "dump2vtk: %s\n", message.c_str());
  return 2;
}

/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#include "ball_placement.h"

#include "atom.h"
#include "atomic_file.h"
#include "ball_ground.h"
#include "comm.h"
#include "constants.h"
#include "error.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "number_rows.h"
#include "rank_zero.h"
#include "requirements.h"
#include "style_argument.h"
#include "surface_closer.h"
#include "text_file.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

using namespace LAMMPS_NS;
using Slope::FARTHEST;
using Slope::PlacedBall;
using Slope::SurfaceCounts;

static constexpr double COUNTED = 131072.0;     // plan nodes of a ground that is counted at once
static constexpr double TAKES = 32.0;           // a scattered ball to make, in plan nodes
static constexpr int MARKS = 4096;              // columns that tell one ground from another
static constexpr double SAME_PLACE = 1.0e-6;    // in diameters
static constexpr double IN_ORDER = 1.0e-8;      // of a file's balls, in diameters, in the mean

static std::string line_of(const PlacedBall &b)
{
  return fmt::format("{:.15g} {:.15g} {:.15g}\n", b.x, b.y, b.z);
}

static bigint common_divisor(bigint a, bigint b)
{
  return b == 0 ? a : common_divisor(b, a % b);
}

// places from 0 to 1 that repeat no grid
static double part(bigint k)
{
  const double turns = Slope::GOLDEN * static_cast<double>(k + 1);
  return turns - std::floor(turns);
}

/* ---------------------------------------------------------------------- */

BallPlacement::BallPlacement(LAMMPS *lmp, const std::string &caller_in, double diameter,
                             double smallest_in, int narg, char **arg, bool of_wall) :
    Pointers(lmp),
    caller(caller_in), arguments(lmp, caller_in, diameter, smallest_in, narg, arg, of_wall),
    dropped(0), counted(-1)
{
  ground.reset(new BallGround(lmp, arguments));
  if (arguments.region.empty())
    place_file();
  else
    place_surface();
}

BallPlacement::~BallPlacement() = default;

std::vector<int> BallPlacement::zone_types() const
{
  std::vector<int> types;
  for (const PlacementArguments::Zone &zone : arguments.zones) types.push_back(zone.type);
  return types;
}

double BallPlacement::smallest_ball(LAMMPS *lmp, int groupbit)
{
  const Atom *atom = lmp->atom;
  if (!atom->radius_flag) return 0.0;
  double mine = HUGE_VAL, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) mine = std::min(mine, 2.0 * atom->radius[i]);
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MIN, lmp->world);
  return all < HUGE_VAL ? all : 0.0;
}

void BallPlacement::check_regions() const
{
  std::string changed;
  if (!ground->stands(changed))
    error->all(FLERR, "{}: region {} must not change after these balls are defined", caller,
               changed);
}

/* ---------------------------------------------------------------------- */

void BallPlacement::place_file()
{
  on_rank_zero(lmp, caller, [this]() {
    read_file();
  });
  broadcast(world, from_file);
  find_sums();
  counted = from_file.size();
  if (counted == 0) error->all(FLERR, "{}: file {} holds no balls", caller, arguments.file);
  SurfaceCounts counts;
  counts.base = counted;
  if (comm->me == 0) report(counts, true);
  if (arguments.write.empty()) return;
  std::vector<std::string> text(1);
  if (comm->me == 0)
    for (const PlacedBall &b : from_file) text[0] += line_of(b);
  write_file(text, counted);
}

void BallPlacement::place_surface()
{
  double nodes = 0.0;
  on_all_ranks(lmp, caller, [&]() {
    if (!ground->build()) return;
    nodes = Slope::count_nodes(ground->grid());
    if (!(nodes < Slope::MOST_COUNTED))
      throw std::runtime_error(fmt::format(
          "spacing must give fewer than 2^31 balls, got {:.3g} with {}", nodes, arguments.spacing));
    if (nodes > 0.0) sampler = ground->new_sampler();
  });
  if (comm->me == 0 && !arguments.scattered) warn_of_spacing();
  if (!any())
    error->all(FLERR, "{}: the surface of region {} holds no balls", caller, arguments.region);

  std::vector<std::string> text(2);
  SurfaceCounts counts;
  const double most = arguments.scattered ? COUNTED / TAKES : COUNTED;
  const bool writing = !arguments.write.empty(), known = writing || nodes <= most;
  if (known) {
    counts = count_all(writing ? &text : nullptr);
    counted = counts.base + counts.extra;
  }
  if (comm->me == 0) report(counts, known);
  if (writing) write_file(text, counted);
}

/* ----------------------------------------------------------------------
   balls on a plan grid, and more where the surface is steep: how far a point of the surface may be
   from the nearest ball, from the plan grid alone on level ground, with extra balls where it is
   steep. The smallest ball touches one whose centre is contact away: what is said of equal balls
   holds with half of that for their radius.
------------------------------------------------------------------------- */

void BallPlacement::warn_of_spacing() const
{
  const double contact = 0.5 * (arguments.diameter + arguments.smallest), half = 0.5 * contact;
  const double spacing = arguments.spacing;
  const bool leaks = spacing / std::sqrt(2.0) >= contact;
  if (leaks || spacing >= Slope::widest_spacing(half))
    error->warning(
        FLERR, "{} spacing {} lets a ball of diameter {} through {}: spacing must be < {:.4g}",
        caller, spacing, arguments.smallest, leaks ? "even on level ground" : "on steep ground",
        leaks ? contact * std::sqrt(2.0) : Slope::widest_spacing(half));
}

/* ----------------------------------------------------------------------
   tile by tile
------------------------------------------------------------------------- */

Slope::TilePlan BallPlacement::tiles() const
{
  if (!sampler) return {0.0, 0.0, HUGE_VAL, 1, 1};
  Slope::TilePlan plan = sampler->tiles();
  if (arguments.angle != 0.0) plan.turn(arguments.angle, arguments.origin);
  return plan;
}

void BallPlacement::make(int tile, std::vector<PlacedBall> &balls)
{
  if (!sampler) {
    balls.swap(from_file);    // once: a single tile is kept
    return;
  }
  std::string changed;
  if (!ground->stands(changed))
    error->one(FLERR, "{}: region {} must not change after these balls are defined", caller,
               changed);
  SurfaceCounts unused;
  try {
    ground->sample(*sampler, tile, balls, unused);
  } catch (std::exception &e) {
    error->one(FLERR, "{}: {}", caller, e.what());
  }
}

void BallPlacement::forget()
{
  if (sampler) sampler->forget();
}

/* ---------------------------------------------------------------------- */

// does any node have a ball? Asked of a few tiles of each rank first, then of more; inside a region there
// are none beyond its box. All of a large ground may take minutes.

bool BallPlacement::any() const
{
  static constexpr double TELL_EVERY = 10.0;    // s
  if (!sampler) return false;
  const Slope::TilePlan plan = sampler->tiles();
  int lo[2] = {0, 0}, hi[2] = {plan.nx - 1, plan.ny - 1};
  const auto narrow = [&plan](int &first, int &last, double from, double to) {
    first = static_cast<int>(std::max(first + 0.0, std::min(from / plan.size - 1.0, last + 1.0)));
    last = static_cast<int>(std::min(last + 0.0, std::max(to / plan.size + 1.0, first - 1.0)));
  };
  if (!arguments.inside.empty() && arguments.angle == 0.0) {
    const Region *box = compat::find_region(lmp, arguments.inside);
    narrow(lo[0], hi[0], box->extent_xlo - plan.xlo, box->extent_xhi - plan.xlo);
    narrow(lo[1], hi[1], box->extent_ylo - plan.ylo, box->extent_yhi - plan.ylo);
  }
  const bigint across = hi[0] - lo[0] + 1, tiles = across * (hi[1] - lo[1] + 1);
  if (tiles == 0) return false;

  bigint step = 1 + 618 * tiles / 1000, at = comm->me;    // every tile comes once, far ones in turn
  while (common_divisor(step, tiles) > 1) step++;
  int mine = 0, found = 0, left = 1;
  double said = MPI_Wtime();
  for (int some = 16; !found && left; some *= 8) {
    on_all_ranks(lmp, caller, [&]() {
      const auto looks = ground->new_sampler();
      for (int k = 0; k < some && at < tiles && !mine; k++, at += comm->nprocs) {
        const bigint tile = at * step % tiles;
        mine = looks->has_balls(
            static_cast<int>((lo[1] + tile / across) * plan.nx + lo[0] + tile % across));
        if (comm->me > 0 || MPI_Wtime() - said < TELL_EVERY) continue;
        said = MPI_Wtime();
        utils::logmesg(lmp, "{}: no balls on the first {:.0f} % of the surface of region {}\n",
                       caller, 100.0 * at / tiles, arguments.region);
        if (screen) fflush(screen);
      }
    });
    int mine_left = at < tiles;
    MPI_Allreduce(&mine, &found, 1, MPI_INT, MPI_MAX, world);
    MPI_Allreduce(&mine_left, &left, 1, MPI_INT, MPI_MAX, world);
  }
  return found;
}

bigint BallPlacement::count()
{
  if (counted < 0) {
    check_regions();
    const SurfaceCounts counts = count_all(nullptr);
    counted = counts.base + counts.extra;
  }
  return counted;
}

/* ----------------------------------------------------------------------
   the whole ground: each rank makes some rows of tiles, appended; after_tile(whether its row ends with it) may
   take and forget them
------------------------------------------------------------------------- */

template <typename Use>
SurfaceCounts BallPlacement::make_share(std::vector<PlacedBall> &balls, Use after_tile) const
{
  SurfaceCounts counts;
  on_all_ranks(lmp, caller, [&]() {
    const auto share = ground->new_sampler();
    const Slope::TilePlan plan = share->tiles();
    const bigint rows = plan.ny;
    const int end = static_cast<int>(rows * (comm->me + 1) / comm->nprocs) * plan.nx;
    for (int tile = static_cast<int>(rows * comm->me / comm->nprocs) * plan.nx; tile < end;) {
      ground->sample(*share, tile++, balls, counts);
      after_tile(tile % plan.nx == 0);
    }
  });
  return counts;
}

SurfaceCounts BallPlacement::count_all(std::vector<std::string> *text) const
{
  std::vector<PlacedBall> balls;
  const SurfaceCounts mine = make_share(balls, [&](bool row_ends) {
    if (text && !row_ends) return;
    if (text) Slope::in_order(balls);
    for (size_t k = 0; text && k < balls.size(); k++)
      (*text)[!balls[k].first_of_cell()] += line_of(balls[k]);
    balls.clear();
  });
  bigint numbers[4] = {mine.without_surface, mine.dropped, mine.base, mine.extra};
  bigint totals[4];
  MPI_Allreduce(numbers, totals, 4, MPI_LMP_BIGINT, MPI_SUM, world);
  SurfaceCounts all;
  all.without_surface = totals[0];
  all.dropped = totals[1];
  all.base = totals[2];
  all.extra = totals[3];
  return all;
}

std::vector<PlacedBall> BallPlacement::all()
{
  if (!sampler) return std::move(from_file);
  check_regions();
  std::vector<PlacedBall> mine;
  make_share(mine, [](bool) {
  });
  std::vector<PlacedBall> together = gather_records(world, mine);
  broadcast(world, together);
  Slope::in_order(together);
  return together;
}

/* ----------------------------------------------------------------------
   the message on the ground, printed by rank 0
------------------------------------------------------------------------- */

void BallPlacement::report(const SurfaceCounts &counts, bool known) const
{
  const PlacementArguments &a = arguments;
  std::string where;
  if (!a.inside.empty()) where = "inside region " + a.inside;
  if (!a.outside.empty()) where += (where.empty() ? "" : " and ") + ("outside region " + a.outside);
  std::string text = fmt::format("{}: ", caller);
  if (a.region.empty()) {
    text +=
        fmt::format("{} fixed balls of diameter {} (from file {}", counts.base, a.diameter, a.file);
    if (!where.empty()) text += fmt::format(", {} not {}", dropped, where);
  } else {
    const double nodes = Slope::count_nodes(ground->grid());
    const std::string turned =
        a.angle == 0.0 ? "" : fmt::format(", turned by {:.6g} degrees", a.angle / Slope::DEGREE);
    const std::string scattered =
        fmt::format("scattered with seed {}, one for each square of {}", a.seed, a.spacing);
    if (!known)
      text += fmt::format("fixed balls of diameter {} ({}, made where balls come near", a.diameter,
                          a.scattered ? scattered
                                      : fmt::format("on a plan grid of {:.0f} nodes every {}{}",
                                                    nodes, a.spacing, turned));
    else if (a.scattered)
      text += fmt::format("{} fixed balls of diameter {} ({}", counts.base, a.diameter, scattered);
    else
      text += fmt::format("{} fixed balls of diameter {} ({} on the plan grid every {}{}, {} extra "
                          "where the surface is steep or ends",
                          counts.base + counts.extra, a.diameter, counts.base, a.spacing, turned,
                          counts.extra);
    if (counts.without_surface)
      text += fmt::format(", {} plan nodes without surface", counts.without_surface);
    if (!where.empty() && known && !a.scattered)
      text += fmt::format(", {} plan nodes not", counts.dropped);
    if (!where.empty()) text += (known && !a.scattered ? " " : ", ") + where;
  }
  for (size_t k = 0; k < ground->bodies.size(); k++)
    text += fmt::format("{} sunk by {}", k ? "," : "", ground->bodies[k]->sink);
  for (const PlacementArguments::Zone &zone : a.zones) {
    text += fmt::format(", type {} in region {}", zone.type, zone.region);
    if (zone.spacing != a.spacing)
      text += fmt::format(" and one for each square of {}", zone.spacing);
  }
  if (ground->sunk) {
    text += fmt::format(", sunk by {}", a.sink);
    if (!ground->sunk->ground.empty())
      text += " and continued up to region " + ground->sunk->ground;
  }
  if (a.smallest > 0.0 && a.smallest < a.diameter)
    text += fmt::format(", tight for balls of diameter {}", a.smallest);
  utils::logmesg(lmp, "{})\n", text);
}

/* ----------------------------------------------------------------------
   numbers that tell one ground from another: of a file the places in their order, of a surface the
   plan grid and the balls on some of its nodes
------------------------------------------------------------------------- */

const std::vector<double> &BallPlacement::fingerprint()
{
  check_regions();
  if (!marks.empty()) return marks;
  marks = {static_cast<double>(counted), arguments.diameter};
  if (!sampler) {
    marks.insert(marks.end(), sums, sums + 3);
    return marks;
  }
  const Slope::PlanNodes plan(ground->grid(), ground->looked_at());
  const double nodes = static_cast<double>(plan.nx) * plan.ny;
  for (const double value :
       {plan.grid.spacing, plan.xfirst, plan.yfirst, plan.nx + 0.0, plan.ny + 0.0})
    marks.push_back(value);
  const bool several = ground->spacings().size() > 1;
  for (int k = 0; k < std::min(nodes, MARKS + 0.0); k++) {
    const bigint node = static_cast<bigint>(nodes <= MARKS ? k : part(k) * nodes);
    const int i = static_cast<int>(node % plan.nx), j = static_cast<int>(node / plan.nx);
    marks.push_back(plan.probe(i, j));
    if (several) marks.push_back(spacing_around(plan.x(i), plan.y(j)));
  }
  if (arguments.sink > 0.0) marks.push_back(arguments.sink);
  if (arguments.angle != 0.0) marks.insert(marks.end(), {arguments.angle, 0.0});
  if (arguments.scattered) marks.push_back(arguments.seed);    // the last, see unlike()
  return marks;
}

// -infinite where rounding may decide on it

double BallPlacement::spacing_around(double x, double y) const
{
  const double its = ground->spacing(x, y), off = SAME_PLACE * arguments.spacing;
  for (double dx : {-off, off})
    for (double dy : {-off, off})
      if (ground->spacing(x + dx, y + dy) != its) return -HUGE_VAL;
  return its;
}

std::string BallPlacement::unlike(const std::vector<double> &there)
{
  const std::vector<double> &here = fingerprint();
  const double d = arguments.diameter;
  if (there.size() < 2) return "no data of them";
  if (sampler && arguments.scattered && there.size() == here.size() && there.back() != here.back())
    return fmt::format("seed {:.0f} there, {:.0f} here", there.back(), here.back());
  if (there[0] >= 0.0 && here[0] >= 0.0 && there[0] != here[0])
    return fmt::format("{:.0f} there, {:.0f} here", there[0], here[0]);
  if (std::fabs(there[1] - d) > 1.0e-9 * d)
    return fmt::format("diameter {:.15g} there, {:.15g} here", there[1], d);
  if (there.size() != here.size()) return "another pattern or plan grid";
  if (!sampler) {
    for (size_t k = 2; k < here.size(); k++)
      if (!(std::fabs(there[k] - here[k]) <= IN_ORDER * d * here[0]))
        return fmt::format("other places, or another order, of {:.0f}", here[0]);
    return "";
  }
  for (size_t k = 2; k < 7; k++)
    if (!(std::fabs(there[k] - here[k]) <= SAME_PLACE * d)) return "another plan grid";
  for (size_t k = 7; k < here.size(); k++) {
    if (std::isinf(here[k]) || std::isinf(there[k])) continue;    // rounding may decide there
    if (std::isnan(here[k]) != std::isnan(there[k]) ||
        std::fabs(here[k] - there[k]) > SAME_PLACE * d)
      return arguments.zones.empty() ? "another surface" : "another surface, or other zones";
  }
  return "";
}

/* ----------------------------------------------------------------------
   file of positions: x y z per line, # starts a comment
------------------------------------------------------------------------- */

void BallPlacement::read_file()
{
  const std::string &file = arguments.file;
  Slope::read_number_rows(
      file, {"xyz", "x y z", in_si(lmp), 1.0}, [&](const Slope::NumberRow &row) {
        const std::vector<double> &x = row.values;
        for (int d = 0; d < 3; d++)
          if (std::fabs(x[d]) > FARTHEST)
            throw Slope::line_error(
                file, row.line,
                fmt::format("{} must be within +-{:g}, got {:g}", "xyz"[d], FARTHEST, x[d]));
        if (ground->keep(x[0], x[1]))
          from_file.push_back(
              {x[0], x[1], x[2], static_cast<int64_t>(from_file.size()), ground->zone(x[0], x[1])});
        else
          dropped++;
        if (from_file.size() > Slope::MOST_COUNTED)
          throw Slope::line_error(file, row.line, "must be fewer than 2^31 balls, got more");
      });
}

// sums: of the coordinates with a weight of -1 to 1 that each ball's number decides on: two balls that
// change places change them

void BallPlacement::find_sums()
{
  long double sum[3] = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < from_file.size(); k++) {
    const double x[3] = {from_file[k].x, from_file[k].y, from_file[k].z};
    for (int d = 0; d < 3; d++) sum[d] += (2.0 * part(k) - 1.0) * x[d];
  }
  for (int d = 0; d < 3; d++) sums[d] = static_cast<double>(sum[d]);
}

/* ----------------------------------------------------------------------
   the same kind of file, of all balls in order: rank 0 writes what each rank has made of its rows,
   the balls on nodes of all ranks first
------------------------------------------------------------------------- */

void BallPlacement::write_file(std::vector<std::string> &text, bigint n) const
{
  std::unique_ptr<Slope::AtomicFile> out;
  on_rank_zero(lmp, caller, [&]() {
    out.reset(new Slope::AtomicFile(arguments.write));
    out->write(fmt::format("# {}: {} fixed balls of diameter {}, units {}\n# x y z\n", caller, n,
                           arguments.diameter, update->unit_style));
  });
  for (std::string &lines : text)
    for (int from = 0; from < comm->nprocs; from++) {
      bigint size = lines.size();
      if (from > 0) MPI_Bcast(&size, 1, MPI_LMP_BIGINT, from, world);
      if (from > 0 && comm->me == from) send_bytes(world, lines.data(), size, 0);
      if (from > 0 && comm->me == 0) {
        lines.resize(size);
        receive_bytes(world, &lines[0], size, from);
      }
      on_rank_zero(lmp, caller, [&]() {
        out->write(lines);
      });
    }
  on_rank_zero(lmp, caller, [&]() {
    out->commit();
  });
}

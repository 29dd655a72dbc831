/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* A surface of triangles as a smooth wall. Balls near it are listed when LAMMPS rebuilds its neighbor
   list; each step finds the points that they touch (surface_watch.h). At each of these a ball touches a
   fixed phantom ball of its own size, so that law, impacts, guards and energies are those of balls. */

#include "fix_wall_gran_mesh.h"

#include "atom.h"
#include "comm.h"
#include "contact_guards.h"
#include "error.h"
#include "lammps_compat.h"
#include "large_messages.h"
#include "neighbor.h"
#include "pair_gran_restitution.h"
#include "rank_zero.h"
#include "text_file.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace Slope;

static constexpr double SAME_SURFACE = 1.0e-9;
static constexpr double COARSE = 0.05;    // largest rounding of a file, in smallest radii

static Vector vector_of(const double *x)
{
  return {x[0], x[1], x[2]};
}

/* ----------------------------------------------------------------------
   fix ID group wall/gran/mesh TYPE FILE.stl|terrain FILE.asc keyword value ...
------------------------------------------------------------------------- */

FixWallGranMesh::FixWallGranMesh(LAMMPS *lmp, int narg, char **arg) :
    FixContactWall(lmp, narg, arg, 3), options(lmp, caller, narg - 3, arg + 3),
    surface(options.surface()), all_ready(false), started(false), fast(lmp, caller)
{
  wall_type = options.type;
  size_vector = IMPULSE + 3;

  std::fill(mine, mine + NVALUE, 0.0);
  std::fill(all, all + NVALUE, 0.0);
  for (int d = 0; d < 3; d++) given[d] = 0.0;
  if (options.every) {
    nevery = options.every;
    recorder.reset(new SurfaceRecorder(lmp, caller, options.output, *surface));
  }
  keep_by_atom();
}

/* ---------------------------------------------------------------------- */

int FixWallGranMesh::setmask()
{
  return PRE_EXCHANGE | POST_NEIGHBOR | POST_FORCE | (recorder ? END_OF_STEP : 0);
}

/* ---------------------------------------------------------------------- */

void FixWallGranMesh::init()
{
  FixContactWall::init();
  for (Fix *fix : compat::fixes_of_style(lmp, style)) {
    const auto other = static_cast<FixWallGranMesh *>(fix);
    if (other != this && recorder && other->recorder && other->recorder->prefix == recorder->prefix)
      error->all(FLERR, "{} output must differ from that of fix {}, got {}", caller, fix->id,
                 recorder->prefix);
  }
  fast.start();
}

/* ----------------------------------------------------------------------
   law for balls of a type on the surface, where the rolling radius is the ball's
------------------------------------------------------------------------- */

ContactLaw FixWallGranMesh::law_of_list(size_t type) const
{
  ContactLaw smooth = law_of(static_cast<int>(type));
  smooth.rolling_factor = 2.0;    // of the two radii's r r/(r + r)
  return smooth;
}

void FixWallGranMesh::key_of(int slot, double *key) const
{
  memcpy(key, &watch.slots[slot].contact.at.normal, sizeof(Vector));
}

std::string FixWallGranMesh::name_of(int slot) const
{
  return fmt::format("triangle {}", watch.slots[slot].contact.at.triangle + 1);
}

FixContactWall::Depth FixWallGranMesh::depth_of(const ContactEntry &e, double) const
{
  return {watch.slots[e.j].depth(), atom->radius[e.i]};
}

/* ----------------------------------------------------------------------
   list the triangles near each moving ball, and the contacts that it has
   LAMMPS rebuilds when a ball has moved by half the skin; the surface does not move
------------------------------------------------------------------------- */

void FixWallGranMesh::post_neighbor()
{
  lists.resize(atom->ntypes + 1);
  for (ContactList &l : lists) l.clear(true, false);
  watch.clear();
  radii.clear();
  history.clear();

  const Vector &low = surface->low(), &high = surface->high();
  std::vector<int> near;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const Vector x = vector_of(atom->x[i]);
    const double r = atom->radius[i];
    const double reach = r + 0.5 * neighbor->skin + size_of(vector_of(atom->v[i])) * update->dt;
    if (x.x < low.x - reach || x.x > high.x + reach || x.y < low.y - reach ||
        x.y > high.y + reach || x.z < low.z - reach || x.z > high.z + reach)
      continue;
    near.clear();
    surface->find_near(x, reach, near);
    SurfacePoint nearest;
    nearest.distance = HUGE_VAL;
    size_t n = 0;
    for (const int number : near) {
      const SurfacePoint p = nearest_point(surface->triangle(number), number, x);
      if (p.distance < nearest.distance) nearest = p;
      if (p.distance < reach) near[n++] = number;
    }
    near.resize(n);
    if (n == 0) continue;
    const int ball = watch.add_ball(i, near);
    if (nearest.distance > r) check_speed(i, nearest.normal);
    for (int k = 0; k < records.contacts(i); k++)
      add_contact(watch.add_slot(ball, vector_of(records.key(i, k))), records.history(i, k));
  }
}

/* ----------------------------------------------------------------------
   a slot's contact to the lists; from: its history, if it has one
------------------------------------------------------------------------- */

void FixWallGranMesh::add_contact(int slot, const double *from)
{
  history.emplace_back();
  double *values = history.back().data();
  std::fill_n(values, HISTORY, 0.0);
  if (from) std::copy_n(from, HISTORY, values);
  const int i = watch.number_of(watch.slots[slot].ball);
  const double r = atom->radius[i];
  radii.push_back(r);
  ContactList &l = lists[atom->type[i]];
  l.add(i, slot, values, from != nullptr, r, r, atom->rmass[i], 1.0);
  if (pair->sizes_vary) l.let_vary();
}

/* ----------------------------------------------------------------------
   what each ball near the surface touches now
------------------------------------------------------------------------- */

void FixWallGranMesh::find_features()
{
  const MovingBalls moving = pair->moving_balls();
  for (int b = 0; b < watch.balls(); b++) {
    const int i = watch.number_of(b);
    const double step = size_of(moving.v[i]) * update->dt;
    watch.find_features(b, vector_of(atom->x[i]), atom->radius[i], step, *surface);
  }
  const size_t before = radii.size(), n = watch.slots.size();
  for (size_t s = before; s < n; s++) add_contact(static_cast<int>(s), nullptr);

  centres.reserve(n + 1);    // contacts are read 32 bytes at a time, 8 beyond a vector
  centres.resize(n);
  for (size_t s = 0; s < n; s++) {
    const SurfaceWatch::Slot &slot = watch.slots[s];
    const Vector &normal = slot.contact.at.normal;
    centres[s] = moved(slot.centre, slot.radius - radii[s], normal);    // fix adapt
    if (slot.touches) check_speed(watch.number_of(slot.ball), normal);
  }
}

/* ---------------------------------------------------------------------- */

void FixWallGranMesh::check_speed(int i, const Vector &normal)
{
  const double towards = -dot(vector_of(atom->v[i]), normal);
  const ContactLaw *law = pair->law(atom->type[i], wall_type);
  if (law && towards > 0.0) fast.record(i, towards, *law);
}

/* ----------------------------------------------------------------------
   balls inside a closed surface stay there: intended in a container, a mistake in a structure
------------------------------------------------------------------------- */

void FixWallGranMesh::warn_of_enclosed()
{
  int held = 0;
  for (Fix *fix : compat::fixes_of_style(lmp, "freeze")) held |= fix->groupbit;
  const Vector &low = surface->low(), &high = surface->high();
  std::vector<Vector> near;
  for (int i = 0; i < atom->nlocal; i++) {
    const Vector x = vector_of(atom->x[i]);
    if ((atom->mask[i] & groupbit) && !(atom->mask[i] & held) && x.x > low.x && x.x < high.x &&
        x.y > low.y && x.y < high.y && x.z > low.z && x.z < high.z)
      near.push_back(x);
  }
  bigint found = near.size(), total;
  MPI_Allreduce(&found, &total, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (total == 0) return;

  int closed = 0;
  on_rank_zero(lmp, caller, [&]() {
    closed = surface->closed();
  });
  MPI_Bcast(&closed, 1, MPI_INT, 0, world);
  if (!closed) return;
  found = std::count_if(near.begin(), near.end(), [this](const Vector &x) {
    return surface->encloses(x);
  });
  MPI_Allreduce(&found, &total, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (total)
    pair->guards.say(
        fmt::format("{}: a closed surface should hold no balls at the start, unless it is a "
                    "container, got {} inside: move it, or remove them with delete_atoms region",
                    caller, counted(total, "ball")));
}

/* ----------------------------------------------------------------------
   a binary STL file has seven digits: far from the origin they are no longer enough
------------------------------------------------------------------------- */

void FixWallGranMesh::warn_of_rounding()
{
  double radius = HUGE_VAL, smallest;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) radius = std::min(radius, atom->radius[i]);
  MPI_Allreduce(&radius, &smallest, 1, MPI_DOUBLE, MPI_MIN, world);
  if (surface->rounding > COARSE * smallest)
    pair->guards.say(fmt::format(
        "{}: a binary STL file should round coordinates by at most {:g} % of the smallest "
        "radius, {:.4g}, got {:.4g}: write it about an origin of its own, and move it, or "
        "write it as text",
        caller, 100.0 * COARSE, smallest, surface->rounding));
}

/* ---------------------------------------------------------------------- */

void FixWallGranMesh::setup(int)
{
  clock.begin(update->ntimestep, update->dt);
  if (!started) {
    warn_of_enclosed();
    warn_of_rounding();
  }
  started = true;
  apply(true);
}

void FixWallGranMesh::post_force(int)
{
  double before[3];
  std::copy(given, given + 3, before);
  apply(false);
  for (int d = 0; d < 3; d++) mine[IMPULSE + d] += 0.5 * update->dt * (before[d] + given[d]);
  clock.pass(update->ntimestep);
  if (recorder) recorder->end_step(mine + FORCE);
}

void FixWallGranMesh::reset_dt()
{
  // between runs, where newer LAMMPS calls this too, the next set-up sees the change
  if (update->whichflag == 1) clock.change_step_size(update->ntimestep, update->dt);
}

/* ---------------------------------------------------------------------- */

void FixWallGranMesh::end_of_step()
{
  reduce();
  recorder->add_row(clock.at(update->ntimestep), all);
}

/* ----------------------------------------------------------------------
   called by the pair style before it computes forces
------------------------------------------------------------------------- */

void FixWallGranMesh::find_contacts(bool repeat)
{
  find_features();
  find_touching(repeat, "move the surface, or remove the balls there with delete_atoms region");
}

/* ----------------------------------------------------------------------
   contact forces of the surface on the balls
------------------------------------------------------------------------- */

void FixWallGranMesh::apply(bool repeat)
{
  const MovingBalls moving = pair->moving_balls();
  Vector force = {0.0, 0.0, 0.0}, moment = force, momentum = force;
  int contacts = 0;

  // torques of the rolling resistance act on the surface, too: the sum of what the balls get, less that
  // of the forces

  auto torque_of_balls = [&](double sign) {
    for (int b = 0; b < watch.balls(); b++)
      if (watch.has_slots(b)) moment = moved(moment, sign, moving.torque[watch.number_of(b)]);
  };
  torque_of_balls(1.0);

  for (size_t type = 1; type < lists.size(); type++) {
    if (lists[type].entries.empty()) continue;
    const ContactLaw law = law_of_list(type);
    auto add = [&](int i, int j, const Vector &f, const Vector &d) {
      const SurfaceWatch::Slot &slot = watch.slots[j];
      if (pair->works.wanted) {
        const double r = atom->radius[i], apart = 2.0 * r - touching(r, r);
        const double overlap = std::max(slot.contact.overlap - apart, 0.0);
        pair->works.add(i, ContactWorks::FIXED, r, r, law, 1.0, f, d, overlap,
                        overlap > 0.0 ? slot.contact.spring - apart : 0.0);
      }
      // of a contact that began in the step, f is the force of more or less than a step

      const double age = history[j][AGE];
      const double share = has_ended(age) ? 0.0 : is_new(age) ? 1.0 / (age + 0.5) : 1.0;
      const Vector shown = {share * f.x, share * f.y, share * f.z};
      const SurfacePoint &touched = slot.contact.at;
      const Vector arm = moved({0.0, 0.0, 0.0}, -slot.radius, touched.normal);
      const Vector at = moved(vector_of(atom->x[i]), 1.0, arm);
      const Vector torque = cross(arm, f);    // on the ball
      momentum = moved(momentum, -1.0, f);
      force = moved(force, -1.0, shown);
      moment = moved(moment, -1.0, cross(minus(at, options.point), shown));
      moment = moved(moment, 1.0, torque);
      contacts += !has_ended(age);
      if (recorder && !repeat)
        recorder->add(touched.triangle, dot(shown, touched.normal),
                      dot(f, touched.normal) * update->dt);
    };
    ContactTally tally = tally_of(add);
    lists[type].apply(law, update->dt, repeat, moving, partners(), &tally);
  }
  torque_of_balls(-1.0);

  const Vector sums[2] = {force, moment};
  memcpy(mine, sums, sizeof(sums));
  memcpy(given, &momentum, sizeof(momentum));
  mine[CONTACTS] = contacts;
  all_ready = false;
  contacts_in_lists = true;
}

/* ---------------------------------------------------------------------- */

double FixWallGranMesh::elastic_energy() const
{
  // phantoms where each overlaps as far as the contact's spring is compressed

  std::vector<Vector> places;
  places.reserve(centres.size() + 1);    // as centres
  for (size_t k = 0; k < centres.size(); k++) {
    const SurfaceContact &c = watch.slots[k].contact;
    places.push_back(moved(centres[k], c.spring - c.overlap, c.at.normal));
  }
  return energy_beside(phantoms(places));
}

/* ---------------------------------------------------------------------- */

void FixWallGranMesh::post_run()
{
  FixContactWall::post_run();
  if (recorder && update->whichflag == 1) {
    reduce();
    recorder->write_end(clock.at(update->ntimestep), all);
  }
  fast.report(pair->guards);
}

/* ----------------------------------------------------------------------
   number of contacts; force on the surface, its moment, impulse
------------------------------------------------------------------------- */

void FixWallGranMesh::reduce()
{
  if (all_ready) return;
  MPI_Allreduce(mine, all, NVALUE, MPI_DOUBLE, MPI_SUM, world);
  all_ready = true;
}

double FixWallGranMesh::compute_scalar()
{
  reduce();
  return all[CONTACTS];
}

double FixWallGranMesh::compute_vector(int n)
{
  reduce();
  return all[n];
}

/* ---------------------------------------------------------------------- */

double FixWallGranMesh::memory_usage()
{
  return FixContactWall::memory_usage() + surface->memory_usage() + watch.memory_usage() +
      history.size() * sizeof(history[0]) + centres.capacity() * sizeof(Vector) +
      radii.capacity() * sizeof(double);
}

/* ----------------------------------------------------------------------
   restart file: what identifies the surface, and sums so far
------------------------------------------------------------------------- */

void FixWallGranMesh::archive_wall(Slope::Archive &archive)
{
  double triangles = surface->count(), checksum = surface->checksum();
  std::vector<double> recorded;
  if (!archive.reads()) {
    reduce();
    if (recorder) recorded = recorder->pack();
  }
  archive.number("triangles", triangles);
  archive.number("checksum", checksum);
  archive.numbers("impulse", archive.reads() && comm->me == 0 ? &mine[IMPULSE] : &all[IMPULSE], 3);
  clock.archive(archive);
  archive.list("recorded", recorded);
  if (!archive.reads()) return;

  if (triangles != surface->count() ||
      std::fabs(checksum - surface->checksum()) > SAME_SURFACE * std::fabs(surface->checksum()))
    throw std::runtime_error(
        fmt::format("the restart file was written with another surface ({} there, {} here)",
                    counted(triangles, "triangle"), counted(surface->count(), "triangle")));
  all_ready = false;
  if (recorder && !recorded.empty()) recorder->unpack(recorded);
}

/* ---------------------------------------------------------------------- */

SpeedGuard::SpeedGuard(LAMMPS *lmp, const std::string &_caller) : Pointers(lmp), caller(_caller)
{
  start();
}

void SpeedGuard::start()
{
  worst = {0.0, 0.0, 0.0, 0.0};
  count = 0;
}

/* ---------------------------------------------------------------------- */

void SpeedGuard::record(int i, double speed, const Slope::ContactLaw &law)
{
  const double radius = atom->radius[i], deep = law.depth(atom->rmass[i], speed);
  const double share = deep / (DEEPEST * radius);
  if (!(share > 1.0)) return;
  if (count++ == 0)
    error->warning(
        FLERR,
        "{}: ball {} hits at {:.4g} m/s at step {}, {:.3g} times the speed up to which no ball "
        "passes, {:g} R sqrt(kn/m): the contacts need a larger stiffness",
        caller, atom->tag[i], speed, update->ntimestep, share, +DEEPEST);
  if (share > worst.share)
    worst = {share, speed, static_cast<double>(atom->tag[i]),
             static_cast<double>(update->ntimestep)};
}

/* ---------------------------------------------------------------------- */

void SpeedGuard::report(ContactGuards &guards)
{
  bigint all;
  MPI_Allreduce(&count, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all == 0) return;
  with_largest(world, worst.share, worst);
  guards.say(fmt::format(
      "{}: balls hit it too fast {} times, the worst at {:.4g} m/s (ball {:.0f}, step "
      "{:.0f}), {:.3g} times the speed up to which no ball passes, {:g} R sqrt(kn/m): the "
      "contacts need a larger stiffness",
      caller, all, worst.speed, worst.ball, worst.step, worst.share, +DEEPEST));
}

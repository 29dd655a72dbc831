/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Fixed balls as a wall. They are no atoms: sorted once into plan cells, listed for the
   moving balls close to them when LAMMPS rebuilds its neighbor list, so that a step costs
   what the contacts cost, whatever the size of the terrain. */

#include "fix_wall_gran_balls.h"

#include "atom.h"
#include "ball_placement.h"
#include "comm.h"
#include "contact_energy.h"
#include "error.h"
#include "force.h"
#include "initial_overlap.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_gran_restitution.h"
#include "style_argument.h"
#include "sunk_region.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace Slope;

static constexpr int MAX_PARTNERS = 1024;    // fixed balls that one ball can touch
static constexpr double SAME_SIZE = 1.0e-9;
static constexpr double SAME_PLACE = 1.0e-8;    // in diameters, in the mean
static constexpr int RESTART_SIZE = 6;
static constexpr double RESTART_FORMAT = -2.0;    // in place of the number of balls of the first one

/* ----------------------------------------------------------------------
   fix ID group wall/gran/balls TYPE DIAMETER surface|file ...
------------------------------------------------------------------------- */

FixWallGranBalls::FixWallGranBalls(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), pair(nullptr), sunk_released(false), smallest(0.0), lists_newer(false),
    npartner(nullptr), partner(nullptr), values(nullptr)
{
  caller = fmt::format("Fix wall/gran/balls {}", id);
  if (narg < 6)
    error->all(FLERR, "{}: needs TYPE DIAMETER and surface or file, got {} arguments", caller,
               narg - 3);

  wall_type = whole_number_argument(lmp, caller + " type", arg[3]);
  if (wall_type < 1 || wall_type > atom->ntypes)
    error->all(FLERR, "{} type must be 1 to {} (the atom types of the box), got {}", caller,
               atom->ntypes, wall_type);
  diameter = number_argument(lmp, caller + " diameter", arg[4]);
  if (!(diameter > 0.0))
    error->all(FLERR, "{} diameter must be > 0, got {}", caller, arg[4]);
  radius = 0.5 * diameter;

  const double moving = BallPlacement::smallest_ball(lmp, groupbit);
  BallPlacement placement(lmp, caller, diameter, moving, narg - 5, &arg[5], true);
  sort_balls(placement.xyz);
  sunk = placement.sunk;
  outside = placement.outside;
  smallest = placement.smallest;

  scalar_flag = vector_flag = 1;
  size_vector = 3;
  extscalar = extvector = 1;
  global_freq = 1;
  restart_global = restart_peratom = 1;
  create_attribute = 1;
  maxexchange_dynamic = 1;

  for (int k = 0; k < 3; k++) force_mine[k] = force_all[k] = 0.0;
  force_ready = 0;

  ipage.init(MAX_PARTNERS, 64 * MAX_PARTNERS);
  dpage.init(MAX_PARTNERS * HISTORY, 64 * MAX_PARTNERS * HISTORY);
  FixWallGranBalls::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) npartner[i] = 0;
}

/* ---------------------------------------------------------------------- */

FixWallGranBalls::~FixWallGranBalls()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(npartner);
  memory->sfree(partner);
  memory->sfree(values);
}

/* ----------------------------------------------------------------------
   sums of the coordinates with a weight of -1 to 1 that each ball's number decides on: two balls that
   change places change them
------------------------------------------------------------------------- */

void FixWallGranBalls::add_up(const std::vector<double> &xyz)
{
  long double sum[3] = {0.0, 0.0, 0.0};
  for (size_t k = 0; k < xyz.size(); k++) {
    const double turns = 0.6180339887498949 * static_cast<double>(k / 3 + 1);
    sum[k % 3] += (2.0 * (turns - std::floor(turns)) - 1.0) * xyz[k];
  }
  for (int d = 0; d < 3; d++) checksum[d] = static_cast<double>(sum[d]);
}

/* ----------------------------------------------------------------------
   counting sort into plan cells of one diameter
------------------------------------------------------------------------- */

void FixWallGranBalls::sort_balls(const std::vector<double> &xyz)
{
  const size_t n = xyz.size() / 3;
  double xhi = -HUGE_VAL, yhi = -HUGE_VAL;
  xlo = ylo = HUGE_VAL;
  add_up(xyz);
  for (size_t k = 0; k < n; k++) {
    xlo = std::min(xlo, xyz[3 * k]);
    xhi = std::max(xhi, xyz[3 * k]);
    ylo = std::min(ylo, xyz[3 * k + 1]);
    yhi = std::max(yhi, xyz[3 * k + 1]);
  }

  // larger cells where the balls are so sparse that empty cells would outnumber them, in plan or in
  // a long row

  const double area = (xhi - xlo + diameter) * (yhi - ylo + diameter);
  const double longest = std::max(xhi - xlo, yhi - ylo);
  const double cell = std::max({diameter, std::sqrt(area / (2.0 * n)), longest / n});
  cell_inv = 1.0 / cell;
  ncx = static_cast<int>((xhi - xlo) * cell_inv) + 1;
  ncy = static_cast<int>((yhi - ylo) * cell_inv) + 1;

  auto cell_of = [&](size_t k) {
    return static_cast<size_t>((xyz[3 * k + 1] - ylo) * cell_inv) * ncx +
        static_cast<size_t>((xyz[3 * k] - xlo) * cell_inv);
  };
  const size_t ncell = static_cast<size_t>(ncx) * ncy;
  first.assign(ncell + 1, 0);
  top.assign(ncell, -HUGE_VALF);
  for (size_t k = 0; k < n; k++) first[cell_of(k) + 1]++;
  for (size_t c = 0; c < ncell; c++) first[c + 1] += first[c];
  balls.reserve(n + 1);    // contacts are read 32 bytes at a time, 8 beyond a vector
  balls.resize(n);
  number.resize(n);
  std::vector<int> next(first.begin(), first.end() - 1);
  for (size_t k = 0; k < n; k++) {
    const size_t c = cell_of(k);
    number[next[c]] = static_cast<int>(k);
    balls[next[c]++] = {xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2]};
    top[c] = std::max(top[c], std::nextafter(static_cast<float>(xyz[3 * k + 2]), HUGE_VALF));
  }
}

/* ----------------------------------------------------------------------
   call visit(k, distance^2) for every fixed ball k closer to x than reach
------------------------------------------------------------------------- */

template <typename Visit>
void FixWallGranBalls::visit_near(const double *x, double reach, Visit visit) const
{
  const double ulo = (x[0] - reach - xlo) * cell_inv, uhi = (x[0] + reach - xlo) * cell_inv;
  const double vlo = (x[1] - reach - ylo) * cell_inv, vhi = (x[1] + reach - ylo) * cell_inv;
  if (!(uhi >= 0.0 && ulo < ncx && vhi >= 0.0 && vlo < ncy)) return;
  const int ilo = ulo > 0.0 ? static_cast<int>(ulo) : 0;
  const int jlo = vlo > 0.0 ? static_cast<int>(vlo) : 0;
  const int ihi = uhi < ncx ? static_cast<int>(uhi) : ncx - 1;
  const int jhi = vhi < ncy ? static_cast<int>(vhi) : ncy - 1;
  const double reach2 = reach * reach, lowest = x[2] - reach;

  for (int j = jlo; j <= jhi; j++)
    for (int i = ilo; i <= ihi; i++) {
      const size_t c = static_cast<size_t>(j) * ncx + i;
      if (top[c] < lowest) continue;    // a ball high above the ground
      for (int k = first[c]; k < first[c + 1]; k++) {
        const double dx = x[0] - balls[k].x, dy = x[1] - balls[k].y, dz = x[2] - balls[k].z;
        const double d2 = dx * dx + dy * dy + dz * dz;
        if (d2 < reach2) visit(k, d2);
      }
    }
}

/* ---------------------------------------------------------------------- */

double FixWallGranBalls::deepest_overlap(const double *x, double r) const
{
  double deepest = 0.0;
  visit_near(x, r + radius, [&](int, double d2) {
    deepest = std::max(deepest, r + radius - std::sqrt(d2));
  });
  return deepest;
}

/* ---------------------------------------------------------------------- */

int FixWallGranBalls::setmask()
{
  return PRE_EXCHANGE | POST_NEIGHBOR | POST_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixWallGranBalls::init()
{
  pair = dynamic_cast<PairGranRestitution *>(force->pair_match("gran/restitution", 1));
  if (!pair)
    error->all(FLERR, "{}: requires pair_style gran/restitution, which holds its coefficients",
               caller);
  pair->announce_wall(this, wall_type, groupbit);

  // contacts must be stored by atom before any fix migrates atoms

  for (int i = 0; i < modify->nfix; i++) {
    if (modify->fix[i] == this) break;
    if (modify->fix[i]->pre_exchange_migrate)
      error->all(FLERR, "{}: must come before fix {} {}, which moves atoms between ranks", caller,
                 modify->fix[i]->id, modify->fix[i]->style);
  }

  check_sizes();
  if (sunk) sunk->release();    // its memory
  sunk_released = true;
}

/* ----------------------------------------------------------------------
   were the balls that this ground was made for the smallest?
------------------------------------------------------------------------- */

void FixWallGranBalls::check_sizes()
{
  if (smallest == 0.0) return;
  const double moving = BallPlacement::smallest_ball(lmp, groupbit);
  if (moving == 0.0 || moving > smallest * (1.0 - SAME_SIZE)) return;
  if (comm->me == 0)
    error->warning(FLERR,
                   "{}: balls of diameter {} may pass between these, placed for {} and larger, on steep "
                   "ground: define the fix after the balls, or with smallest {}",
                   caller, moving, smallest, moving);
  smallest = 0.0;
}

/* ---------------------------------------------------------------------- */

std::shared_ptr<SunkRegion> FixWallGranBalls::body() const
{
  if (!sunk || sunk->side == RegionSurface::UPPER) return nullptr;
  if (!sunk_released) return sunk;
  return std::make_shared<SunkRegion>(lmp, caller, sunk->region, sunk->side, sunk->sink,
                                      sunk->diameter);
}

/* ----------------------------------------------------------------------
   contacts from the lists to storage by atom: before atoms migrate or are sorted, before a
   restart file, at the end of a run
------------------------------------------------------------------------- */

void FixWallGranBalls::store_contacts()
{
  if (!lists_newer) return;
  lists_newer = false;

  ipage.reset();
  dpage.reset();
  std::fill(npartner, npartner + atom->nlocal, 0);
  int most = 0;
  for (const ContactList &l : lists)
    for (size_t k = 0, end; k < l.entries.size(); k = end) {
      const int i = l.entries[k].i;    // its entries follow one another
      int n = 0;
      for (end = k; end < l.entries.size() && l.entries[end].i == i; end++) n += l.has_history(end);
      if (n == 0 || i >= atom->nlocal) continue;    // the last ones may have been deleted
      if (n > MAX_PARTNERS)
        error->one(FLERR, "{}: ball {} touches {} fixed balls, the most is {}", caller,
                   atom->tag[i], n, MAX_PARTNERS);
      partner[i] = ipage.get(n);
      values[i] = dpage.get(n * HISTORY);
      for (; k < end; k++)
        if (l.has_history(k)) {
          partner[i][npartner[i]] = number[l.entries[k].j];
          memcpy(&values[i][npartner[i]++ * HISTORY], l.histories[k],
                 HISTORY * sizeof(double));
        }
      most = std::max(most, n);
    }
  maxexchange = 1 + (1 + HISTORY) * most;
}

void FixWallGranBalls::pre_exchange()
{
  store_contacts();
}

void FixWallGranBalls::post_run()
{
  store_contacts();
}

/* ----------------------------------------------------------------------
   list the fixed balls near each moving ball, with the history of those that touch
   LAMMPS rebuilds when a ball has moved by half the skin; fixed balls do not move
------------------------------------------------------------------------- */

void FixWallGranBalls::setup_post_neighbor()
{
  post_neighbor();
}

void FixWallGranBalls::post_neighbor()
{
  lists.resize(atom->ntypes + 1);
  for (ContactList &l : lists) l.clear(true, false);

  double **x = atom->x;
  const double *r = atom->radius;
  const int *mask = atom->mask, *type = atom->type;
  const double beyond = radius + 0.5 * neighbor->skin;
  size_t total = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    ContactList &l = lists[type[i]];
    const size_t before = l.entries.size();
    visit_near(x[i], r[i] + beyond, [&](int k, double) {
      l.add(i, k, nullptr, false, r[i], radius, atom->rmass[i], 1.0);
    });
    total += l.entries.size() - before;
  }

  history.assign(total * HISTORY, 0.0);
  double *next = history.data();
  for (ContactList &l : lists) {
    for (size_t k = 0; k < l.entries.size(); k++, next += HISTORY) {
      const ContactList::Entry &e = l.entries[k];
      l.histories[k] = next;
      for (int p = 0; p < npartner[e.i]; p++)
        if (partner[e.i][p] == number[e.j]) {
          memcpy(next, &values[e.i][p * HISTORY], HISTORY * sizeof(double));
          l.set_history(k);
        }
    }
    if (pair->sizes_vary) l.equal = false;
  }
}

/* ---------------------------------------------------------------------- */

void FixWallGranBalls::setup(int)
{
  apply(true);
}

void FixWallGranBalls::post_force(int)
{
  apply(false);
}

/* ----------------------------------------------------------------------
   called by the pair style before it computes forces
------------------------------------------------------------------------- */

void FixWallGranBalls::find_contacts(bool starting, bool lists_new)
{
  const MovingBalls moving = pair->moving_balls();
  const FixedPartners fixed(balls.data(), radius);
  InitialOverlap initial(lmp);
  for (ContactList &l : lists) {
    if (starting)
      l.start(moving, fixed, [&](const ContactList::Entry &e, double overlap) {
        const Vector &ball = balls[e.j];
        initial.look(overlap, std::min(atom->radius[e.i], radius), atom->tag[e.i], atom->x[e.i],
                     fmt::format("the fixed ball at {:.6g} {:.6g} {:.6g},", ball.x, ball.y, ball.z));
      });
    l.find(starting, lists_new, moving, fixed);
  }
  if (starting) initial.check(caller);
}

/* ----------------------------------------------------------------------
   contact forces of the fixed balls on the moving ones
------------------------------------------------------------------------- */

void FixWallGranBalls::apply(bool starting)
{
  const MovingBalls moving = pair->moving_balls();
  const FixedPartners fixed(balls.data(), radius);
  ContactTally tally = ContactTally();

  for (int type = 1; type <= atom->ntypes; type++) {
    ContactList &l = lists[type];
    if (l.entries.empty()) continue;
    const ContactLaw *law = pair->law(type, wall_type);
    if (!law)    // a type that came after init(), by fix pour or fix deposit
      error->one(FLERR, "{}: pair_coeff {} {} is not set (moving type {}, wall type {})", caller,
                 std::min(type, wall_type), std::max(type, wall_type), type, wall_type);
    l.apply(*law, update->dt, starting, moving, fixed, &tally);
  }

  force_mine[0] = -tally.force.x;
  force_mine[1] = -tally.force.y;
  force_mine[2] = -tally.force.z;
  force_ready = 0;
  lists_newer = true;
}

/* ---------------------------------------------------------------------- */

double FixWallGranBalls::elastic_energy() const
{
  const MovingBalls moving = pair->moving_balls();
  const FixedPartners fixed(balls.data(), radius);
  double energy = 0.0;
  for (size_t type = 1; type < lists.size(); type++)
    if (!lists[type].entries.empty())
      energy += Slope::elastic_energy(
          lists[type], *pair->law(type, wall_type), moving, fixed,
          [this](const ContactList::Entry &e, double overlap) {
            pair->guards.see_overlap(e.i, overlap, std::min(atom->radius[e.i], radius));
          });
  return energy;
}

/* ----------------------------------------------------------------------
   number of fixed balls; total force on them
------------------------------------------------------------------------- */

double FixWallGranBalls::compute_scalar()
{
  return static_cast<double>(balls.size());
}

double FixWallGranBalls::compute_vector(int n)
{
  if (!force_ready) {
    MPI_Allreduce(force_mine, force_all, 3, MPI_DOUBLE, MPI_SUM, world);
    force_ready = 1;
  }
  return force_all[n];
}

/* ---------------------------------------------------------------------- */

double FixWallGranBalls::memory_usage()
{
  double bytes = balls.capacity() * sizeof(Vector) +
      (first.capacity() + number.capacity()) * sizeof(int) + top.capacity() * sizeof(float) +
      history.capacity() * sizeof(double);
  for (const ContactList &l : lists) bytes += l.memory_usage();
  bytes += static_cast<double>(atom->nmax) * (sizeof(int) + sizeof(int *) + sizeof(double *));
  bytes += ipage.size() + dpage.size();
  return bytes;
}

/* ----------------------------------------------------------------------
   storage by atom
------------------------------------------------------------------------- */

void FixWallGranBalls::grow_arrays(int nmax)
{
  memory->grow(npartner, nmax, "wall/gran/balls:npartner");
  partner = (int **) memory->srealloc(partner, nmax * sizeof(int *), "wall/gran/balls:partner");
  values = (double **) memory->srealloc(values, nmax * sizeof(double *), "wall/gran/balls:values");
}

void FixWallGranBalls::copy_arrays(int i, int j, int /*delflag*/)
{
  // a fix before this one deletes atoms before they migrate: the lists still hold the old indices

  store_contacts();

  // the chunks stay where they are until the next store_contacts()

  npartner[j] = npartner[i];
  partner[j] = partner[i];
  values[j] = values[i];
}

void FixWallGranBalls::set_arrays(int i)
{
  npartner[i] = 0;
}

int FixWallGranBalls::pack_exchange(int i, double *buf)
{
  int m = 0;
  buf[m++] = npartner[i];
  for (int p = 0; p < npartner[i]; p++) {
    buf[m++] = partner[i][p];
    memcpy(&buf[m], &values[i][p * HISTORY], HISTORY * sizeof(double));
    m += HISTORY;
  }
  return m;
}

int FixWallGranBalls::unpack_exchange(int i, double *buf)
{
  int m = 0;
  const int n = static_cast<int>(buf[m++]);
  npartner[i] = n;
  partner[i] = ipage.get(n);
  values[i] = dpage.get(n * HISTORY);
  for (int p = 0; p < n; p++) {
    partner[i][p] = static_cast<int>(buf[m++]);
    memcpy(&values[i][p * HISTORY], &buf[m], HISTORY * sizeof(double));
    m += HISTORY;
  }
  maxexchange = std::max(maxexchange, m);
  return m;
}

/* ----------------------------------------------------------------------
   restart file: what identifies the balls, and the contacts of each atom
------------------------------------------------------------------------- */

void FixWallGranBalls::write_restart(FILE *fp)
{
  const bool in_use = lists_newer;
  store_contacts();
  lists_newer = in_use;    // the run goes on with the lists
  if (comm->me == 0) {
    const double list[RESTART_SIZE] = {RESTART_FORMAT, static_cast<double>(balls.size()),
                                       diameter,       checksum[0],
                                       checksum[1],    checksum[2]};
    const int size = sizeof(list);
    fwrite(&size, sizeof(int), 1, fp);
    fwrite(list, sizeof(double), RESTART_SIZE, fp);
  }
}

void FixWallGranBalls::restart(char *buf)
{
  const double *list = reinterpret_cast<double *>(buf);
  if (list[0] != RESTART_FORMAT)
    error->all(FLERR,
               "{}: the restart file must be of this version of the fix, got one of an older version, "
               "whose contacts may be those of other balls: run from the start again",
               caller);
  if (list[1] != static_cast<double>(balls.size()))
    error->all(FLERR,
               "{}: the restart file was written with other fixed balls ({:.0f} there, {} here)",
               caller, list[1], balls.size());
  if (std::fabs(list[2] - diameter) > SAME_SIZE * diameter)
    error->all(FLERR,
               "{}: the restart file was written with other fixed balls (diameter {:.15g} there, "
               "{:.15g} here)",
               caller, list[2], diameter);
  for (int d = 0; d < 3; d++)
    if (!(std::fabs(list[3 + d] - checksum[d]) <= SAME_PLACE * diameter * balls.size()))
      error->all(FLERR,
                 "{}: the restart file was written with other fixed balls (other places, or another "
                 "order, of {})",
                 caller, balls.size());
}

int FixWallGranBalls::pack_restart(int i, double *buf)
{
  const int m = 1 + pack_exchange(i, &buf[1]);
  buf[0] = m;
  return m;
}

void FixWallGranBalls::unpack_restart(int i, int nth)
{
  double *extra = atom->extra[i];
  int m = 0;
  for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
  unpack_exchange(i, &extra[m + 1]);
}

int FixWallGranBalls::size_restart(int i)
{
  return 2 + npartner[i] * (1 + HISTORY);
}

int FixWallGranBalls::maxsize_restart()
{
  // over all ranks: rank 0 writes it, and read_restart sizes its buffer by it

  int mine = 0, most;
  for (int i = 0; i < atom->nlocal; i++) mine = std::max(mine, npartner[i]);
  MPI_Allreduce(&mine, &most, 1, MPI_INT, MPI_MAX, world);
  return 2 + most * (1 + HISTORY);
}

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
#include "error.h"
#include "force.h"
#include "initial_overlap.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "pair_gran_restitution.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace Slope;

static constexpr int MAX_PARTNERS = 1024;    // fixed balls that one ball can touch

/* ----------------------------------------------------------------------
   fix ID group wall/gran/balls TYPE DIAMETER surface|file ...
------------------------------------------------------------------------- */

FixWallGranBalls::FixWallGranBalls(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), pair(nullptr), lists_newer(false), npartner(nullptr), partner(nullptr),
    values(nullptr)
{
  caller = fmt::format("Fix wall/gran/balls {}", id);
  if (narg < 6)
    error->all(FLERR, "{}: needs TYPE DIAMETER and surface or file, got {} arguments", caller,
               narg - 3);

  wall_type = utils::inumeric(FLERR, arg[3], false, lmp);
  if (wall_type < 1 || wall_type > atom->ntypes)
    error->all(FLERR, "{} type must be 1 to {} (the atom types of the box), got {}", caller,
               atom->ntypes, wall_type);
  diameter = utils::numeric(FLERR, arg[4], false, lmp);
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    error->all(FLERR, "{} diameter must be > 0, got {}", caller, arg[4]);
  radius = 0.5 * diameter;

  BallPlacement placement(lmp, caller, diameter, narg - 5, &arg[5], true);
  sort_balls(placement.xyz);

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
   counting sort into plan cells of one diameter
------------------------------------------------------------------------- */

void FixWallGranBalls::sort_balls(const std::vector<double> &xyz)
{
  const size_t n = xyz.size() / 3;
  double xhi = -HUGE_VAL, yhi = -HUGE_VAL;
  xlo = ylo = HUGE_VAL;
  checksum = 0.0;
  for (size_t k = 0; k < n; k++) {
    xlo = std::min(xlo, xyz[3 * k]);
    xhi = std::max(xhi, xyz[3 * k]);
    ylo = std::min(ylo, xyz[3 * k + 1]);
    yhi = std::max(yhi, xyz[3 * k + 1]);
    checksum += xyz[3 * k] + 3.0 * xyz[3 * k + 1] + 7.0 * xyz[3 * k + 2];
  }

  // larger cells where the balls are so sparse that empty cells would outnumber them

  const double area = (xhi - xlo + diameter) * (yhi - ylo + diameter);
  const double cell = std::max(diameter, std::sqrt(area / (2.0 * n)));
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
  balls.resize(n);
  std::vector<int> next(first.begin(), first.end() - 1);
  for (size_t k = 0; k < n; k++) {
    const size_t c = cell_of(k);
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
  pair->announce_wall(wall_type, groupbit);

  // contacts must be stored by atom before any fix migrates atoms

  for (int i = 0; i < modify->nfix; i++) {
    if (modify->fix[i] == this) break;
    if (modify->fix[i]->pre_exchange_migrate)
      error->all(FLERR, "{}: must come before fix {} {}, which moves atoms between ranks", caller,
                 modify->fix[i]->id, modify->fix[i]->style);
  }
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
  for (size_t a = 0; a < near.size(); a++) {
    const int i = near[a];
    int n = 0;
    for (int k = offset[a]; k < offset[a + 1]; k++) n += touch[k];
    if (n == 0) continue;
    if (n > MAX_PARTNERS)
      error->one(FLERR, "{}: ball {} touches {} fixed balls, the most is {}", caller,
                 atom->tag[i], n, MAX_PARTNERS);
    partner[i] = ipage.get(n);
    values[i] = dpage.get(n * HISTORY);
    for (int k = offset[a]; k < offset[a + 1]; k++)
      if (touch[k]) {
        partner[i][npartner[i]] = wall[k];
        memcpy(&values[i][npartner[i]++ * HISTORY], &history[static_cast<size_t>(k) * HISTORY],
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
  near.clear();
  offset.clear();
  wall.clear();

  double **x = atom->x;
  const double *r = atom->radius;
  const int *mask = atom->mask;
  const double beyond = radius + 0.5 * neighbor->skin;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const size_t before = wall.size();
    visit_near(x[i], r[i] + beyond, [&](int k, double) { wall.push_back(k); });
    if (wall.size() > before) {
      near.push_back(i);
      offset.push_back(before);
    }
  }
  offset.push_back(wall.size());

  touch.assign(wall.size(), 0);
  history.assign(wall.size() * HISTORY, 0.0);
  for (size_t a = 0; a < near.size(); a++) {
    const int i = near[a];
    for (int p = 0; p < npartner[i]; p++)
      for (int k = offset[a]; k < offset[a + 1]; k++)
        if (wall[k] == partner[i][p]) {
          touch[k] = 1;
          memcpy(&history[static_cast<size_t>(k) * HISTORY], &values[i][p * HISTORY],
                 HISTORY * sizeof(double));
        }
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
   contact forces of the fixed balls on the moving ones: touching contacts are gathered into a
   block per type of the moving ball, as in the pair style
------------------------------------------------------------------------- */

void FixWallGranBalls::apply(bool starting)
{
  InitialOverlap initial(lmp);
  double **x = atom->x;
  double **v = atom->v;
  double **omega = atom->omega;
  const double *r = atom->radius;
  const int *type = atom->type;

  force_mine[0] = force_mine[1] = force_mine[2] = 0.0;
  force_ready = 0;
  blocks.resize(atom->ntypes + 1);

  for (size_t a = 0; a < near.size(); a++) {
    const int i = near[a];
    const double radsum = r[i] + radius;

    for (int k = offset[a]; k < offset[a + 1]; k++) {
      const Ball &ball = balls[wall[k]];
      double *values = &history[static_cast<size_t>(k) * HISTORY];
      const double delx = x[i][0] - ball.x;
      const double dely = x[i][1] - ball.y;
      const double delz = x[i][2] - ball.z;
      const double rsq = delx * delx + dely * dely + delz * delz;
      if (rsq >= radsum * radsum) {
        if (touch[k]) {
          touch[k] = 0;
          memset(values, 0, HISTORY * sizeof(double));
        }
        continue;
      }

      const double distance = std::sqrt(rsq);
      const bool fresh = !touch[k] && !starting;
      if (starting && !touch[k])
        initial.look(radsum - distance, std::min(r[i], radius), atom->tag[i], x[i],
                     fmt::format("the fixed ball at {:.6g} {:.6g} {:.6g},", ball.x, ball.y, ball.z));
      touch[k] = 1;

      const ContactLaw *found = pair->law(type[i], wall_type);
      if (!found)    // a type that came after init(), by fix pour or fix deposit
        error->one(FLERR, "{}: pair_coeff {} {} is not set (moving type {}, wall type {})", caller,
                   std::min(type[i], wall_type), std::max(type[i], wall_type), type[i], wall_type);
      const ContactLaw &law = *found;
      if (!blocks[type[i]]) blocks[type[i]].reset(new ContactBlock);
      ContactBlock &b = *blocks[type[i]];
      const int c = b.count++;
      const double rinv = 1.0 / distance;
      b.i[c] = i;
      b.radius_i[c] = r[i];
      b.n[0][c] = delx * rinv;
      b.n[1][c] = dely * rinv;
      b.n[2][c] = delz * rinv;
      b.overlap[c] = radsum - distance;
      for (int d = 0; d < 3; d++) {
        b.v[d][c] = v[i][d];
        b.rw[d][c] = r[i] * omega[i][d];
        b.w[d][c] = omega[i][d];
      }
      b.rolling_radius[c] = law.rolling_factor * r[i] * radius / radsum;
      b.mass[c] = law.mass_fixed(atom->rmass[i]);
      b.inverse_mass[c] = 1.0 / atom->rmass[i];
      b.fresh[c] = fresh;
      b.history_of[c] = values;
      for (int h = 0; h < HISTORY; h++) b.history[h][c] = values[h];
      if (b.count == ContactBlock::SIZE) finish(b, law, starting);
    }
  }
  for (int t = 1; t <= atom->ntypes; t++)
    if (blocks[t] && blocks[t]->count) finish(*blocks[t], *pair->law(t, wall_type), starting);

  lists_newer = true;
  if (starting) initial.check(caller);
}

/* ----------------------------------------------------------------------
   evaluate a block, add its forces to the balls, empty it
------------------------------------------------------------------------- */

void FixWallGranBalls::finish(ContactBlock &b, const ContactLaw &law, bool starting)
{
  // at set-up the springs keep their length: the step that ends here has grown them already

  b.evaluate(law, starting ? 0.0 : update->dt);
  if (!starting) b.store_history();

  for (int c = 0; c < b.count; c++) {
    double *f = atom->f[b.i[c]], *torque = atom->torque[b.i[c]];
    for (int d = 0; d < 3; d++) {
      f[d] += b.f[d][c];
      torque[d] += b.m[d][c] - b.radius_i[c] * b.t[d][c];
      force_mine[d] -= b.f[d][c];
    }
  }
  b.count = 0;
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
  double bytes = balls.capacity() * sizeof(Ball) + first.capacity() * sizeof(int) +
      top.capacity() * sizeof(float);
  bytes += (near.capacity() + offset.capacity() + wall.capacity()) * sizeof(int);
  bytes += touch.capacity() + history.capacity() * sizeof(double);
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
    const double list[2] = {static_cast<double>(balls.size()), checksum};
    const int size = sizeof(list);
    fwrite(&size, sizeof(int), 1, fp);
    fwrite(list, sizeof(double), 2, fp);
  }
}

void FixWallGranBalls::restart(char *buf)
{
  const double *list = reinterpret_cast<double *>(buf);
  if (list[0] != static_cast<double>(balls.size()) ||
      std::fabs(list[1] - checksum) > 1.0e-9 * std::fabs(checksum))
    error->all(FLERR,
               "{}: the restart file was written with other fixed balls ({:.0f} there, {} here)",
               caller, list[0], balls.size());
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

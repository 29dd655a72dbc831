// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* What a body takes of a vertical line, as intervals of z, and the algebra of sets on them. And the
   interval that a sphere, a cylinder, or a half-space takes of the line at x,y. No LAMMPS. */

#ifndef SLOPE_INTERVALS_H
#define SLOPE_INTERVALS_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace Slope {

struct Interval {
  double lo, hi;    // nothing unless lo < hi; NaN: nothing

  bool empty() const { return !(lo < hi); }
  static Interval none() { return {1.0, -1.0}; }
  static Interval all() { return {-HUGE_VAL, HUGE_VAL}; }
};

// Intervals from below, none empty, none touching the next one. Ends do not count: a set and its
// complement have nothing in common.
class Intervals {
 public:
  bool empty() const { return parts.empty(); }
  size_t size() const { return parts.size(); }
  const Interval &operator[](size_t k) const { return parts[k]; }
  const Interval &lowest() const { return parts.front(); }
  const Interval &topmost() const { return parts.back(); }

  void set(const Interval &only)
  {
    parts.clear();
    if (!only.empty()) parts.push_back(only);
  }

  void append(const Interval &above)    // above all that there is
  {
    if (!above.empty()) parts.push_back(above);
  }

  double length() const
  {
    double sum = 0.0;
    for (const Interval &part : parts) sum += part.hi - part.lo;
    return sum;
  }

  void intersect(const Interval &with)
  {
    size_t left = 0;
    for (const Interval &part : parts) {
      const Interval common = {std::max(part.lo, with.lo), std::min(part.hi, with.hi)};
      if (!with.empty() && !common.empty()) parts[left++] = common;
    }
    parts.resize(left, Interval::none());
  }

  void intersect(const Intervals &with)
  {
    if (with.size() == 1) return intersect(with[0]);
    std::vector<Interval> common;
    size_t a = 0, b = 0;
    while (a < parts.size() && b < with.size()) {
      const Interval both = {std::max(parts[a].lo, with[b].lo), std::min(parts[a].hi, with[b].hi)};
      if (!both.empty()) common.push_back(both);
      if (parts[a].hi < with[b].hi)
        a++;
      else
        b++;
    }
    parts.swap(common);
  }

  void unite(const Intervals &with)
  {
    if (with.empty()) return;
    const size_t mine = parts.size();
    parts.insert(parts.end(), with.parts.begin(), with.parts.end());
    if (mine == 0) return;
    std::inplace_merge(parts.begin(), parts.begin() + mine, parts.end(),
                       [](const Interval &a, const Interval &b) {
                         return a.lo < b.lo;
                       });
    close_gaps(0.0);
  }

  void complement()
  {
    double lo = -HUGE_VAL;
    for (Interval &part : parts) {
      const double hi = part.hi;
      part = {lo, part.lo};
      lo = hi;
    }
    parts.push_back({lo, HUGE_VAL});
    if (parts.back().empty()) parts.pop_back();
    if (!parts.empty() && parts.front().empty()) parts.erase(parts.begin());
  }

  // without gaps of at most this height, then without parts of at most this height
  void ignore(double thin)
  {
    close_gaps(thin);
    parts.erase(std::remove_if(parts.begin(), parts.end(),
                               [=](const Interval &p) {
                                 return p.hi - p.lo <= thin;
                               }),
                parts.end());
  }

 private:
  std::vector<Interval> parts;

  void close_gaps(double most)
  {
    size_t last = 0;
    for (size_t k = 1; k < parts.size(); k++) {
      if (parts[k].lo - parts[last].hi <= most)
        parts[last].hi = std::max(parts[last].hi, parts[k].hi);
      else
        parts[++last] = parts[k];
    }
    if (!parts.empty()) parts.resize(last + 1, Interval::none());
  }
};

// the line at dx, dy from the centre of a sphere at height z
inline Interval column_of_sphere(double dx, double dy, double z, double radius)
{
  const double half2 = radius * radius - dx * dx - dy * dy;
  if (!(half2 > 0.0)) return Interval::none();
  const double half = std::sqrt(half2);
  return {z - half, z + half};
}

// the side of a plane that its normal nx,ny,nz points to; the line at dx, dy from a point of the
// plane at height z
inline Interval column_of_half_space(double dx, double dy, double z, double nx, double ny,
                                     double nz)
{
  const double side = dx * nx + dy * ny;
  if (nz == 0.0) return side >= 0.0 ? Interval::all() : Interval::none();
  const double end = z - side / nz;
  return nz > 0.0 ? Interval{end, HUGE_VAL} : Interval{-HUGE_VAL, end};
}

}    // namespace Slope

#endif

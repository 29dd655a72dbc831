// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Which of the points that a ball touches belong to one smooth surface, and are one contact. No LAMMPS.
   Derivation: doc/src/theory.rst, Surfaces of triangles. */

#ifndef SLOPE_ONE_SURFACE_H
#define SLOPE_ONE_SURFACE_H

#include "surface_contact.h"
#include "way_out.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace Slope {

class OneSurface {
 public:
  // Contacts, the nearest one first, that turn little from a nearer one are one with it, and its overlap
  // is the shortest way of the ball out of all of them. So are two nearest ones with another one between
  // them that is almost as near. Leaves the nearest one of each surface; returns the ways, m.
  static std::vector<Vector> join(std::vector<SurfaceContact> &contacts, double radius)
  {
    OneSurface all(contacts);
    for (size_t k = 0; k < contacts.size(); k++) all.add(k);
    std::vector<SurfaceContact> nearest;
    std::vector<Vector> ways;
    for (const Surface &s : all.surfaces) {
      if (s.members.empty()) continue;
      nearest.push_back(contacts[s.members[0]]);
      SurfaceContact &c = nearest.back();
      c.joined = s.members.size() > 1;
      ways.push_back(moved({0.0, 0.0, 0.0}, c.overlap, c.at.normal));
      const std::vector<OverlappedFace> faces = all.overlapped(s);
      if (faces.size() < 2) continue;
      ways.back() = WayOut::of(faces, radius);
      c.overlap = c.spring = size_of(ways.back());
    }
    contacts = nearest;
    return ways;
  }

 private:
  static constexpr double COS_NEIGHBORS = 0.8660254;    // 30 degrees
  static constexpr double COS_OF_MEAN = 0.25;    // least, of a member and the mean of the normals
  static constexpr double ALMOST = 0.9;          // of an overlap

  struct Surface {
    std::vector<size_t> members;    // the nearest one first; none: it is part of another one
    Vector sum;                     // of their normals
  };

  const std::vector<SurfaceContact> &contacts;
  std::vector<Surface> surfaces;
  std::vector<size_t> of;    // of each contact, its surface

  explicit OneSurface(const std::vector<SurfaceContact> &list) : contacts(list) {}

  const Vector &normal(size_t k) const { return contacts[k].at.normal; }
  static bool faces_mean(const Vector &n, const Vector &sum)
  {
    return dot(n, sum) >= COS_OF_MEAN * size_of(sum);
  }

  // to the surface of the nearer contact whose normal is nearest, or to one of its own
  void add(size_t k)
  {
    size_t best = surfaces.size();
    double most = COS_NEIGHBORS;
    for (size_t m = 0; m < k; m++) {
      const double cosine = dot(normal(k), normal(m));
      if (cosine < most || !faces_mean(normal(k), surfaces[of[m]].sum)) continue;
      most = cosine;
      best = of[m];
    }
    if (best == surfaces.size()) surfaces.push_back({{}, {0.0, 0.0, 0.0}});
    surfaces[best].members.push_back(k);
    surfaces[best].sum = moved(surfaces[best].sum, 1.0, normal(k));
    of.push_back(best);
    for (size_t m = 0; m < k; m++)
      if (of[m] != of[k] && dot(normal(k), normal(m)) >= COS_NEIGHBORS) unite(of[m], of[k], k);
  }

  // two surfaces beside contact k
  void unite(size_t a, size_t b, size_t k)
  {
    if (a > b) std::swap(a, b);    // a has the nearest contact of both
    Surface &to = surfaces[a], &from = surfaces[b];
    if (contacts[k].overlap < ALMOST * contacts[from.members[0]].overlap) return;
    const Vector sum = moved(to.sum, 1.0, from.sum);
    for (const Surface *s : {&to, &from})
      for (const size_t m : s->members)
        if (!faces_mean(normal(m), sum)) return;
    for (const size_t m : from.members) of[m] = a;
    to.members.insert(to.members.end(), from.members.begin(), from.members.end());
    to.sum = sum;
    from.members.clear();
  }

  std::vector<OverlappedFace> overlapped(const Surface &s) const
  {
    std::vector<OverlappedFace> list;
    for (const size_t m : s.members)
      if (contacts[m].overlap > 0.0) list.push_back({normal(m), contacts[m].overlap});
    return list;
  }
};

}    // namespace Slope

#endif

// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

#ifndef SLOPE_SURFACE_WATCH_H
#define SLOPE_SURFACE_WATCH_H

#include "touched_surface.h"

#include <cstddef>
#include <vector>

namespace Slope {

// Which points of a surface balls touch, followed from step to step.
//
// A ball's contacts are the nearest point of the surface, and such others as stand out from those
// that are nearer: see choose(). So a face, an edge or a corner counts once, and only where it
// faces the ball, whatever triangles it is made of. Each contact of a ball has a slot, which keeps
// it while it moves over the surface, from face to face.
class SurfaceWatch {
 public:
  struct Slot {
    SurfaceContact contact;
    Vector centre;     // of a phantom ball of the ball's size that overlaps it as the contact does
    double radius;     // of the ball, m
    int ball, next;    // next slot of the ball, -1: none
    bool touches;      // the ball touches the contact's point now

    double depth() const { return radius - contact.at.distance; }    // of the point in the ball, m
  };

  SurfaceWatch() { clear(); }
  void clear();

  // A ball, number i elsewhere, that can reach these triangles until the next list; returns its
  // number here. What it touched a step ago, or has just left, gets a slot, by its normal.
  int add_ball(int i, const std::vector<int> &triangles);
  int add_slot(int ball, const Vector &normal);

  // The contacts of a ball now, at x; step: a distance that it does not exceed in one step. Slots
  // that it needs beyond those that there are come at the end of slots.
  void find_features(int ball, const Vector &x, double radius, double step,
                     const TouchedSurface &surface);

  // Of points, which it sorts by distance: those that are contacts of their own, the nearest one first.
  // A point is none if a nearer one has it on or below its tangent plane: then the ball's cap beyond
  // that plane holds it already. This removes every point that is no local minimum of the distance: a
  // triangle that extends beyond it has a nearer point, and lies below the tangent plane of that.
  static void choose(std::vector<SurfacePoint> &points, double radius,
                     std::vector<SurfaceContact> &own);

  std::vector<Slot> slots;
  int balls() const { return static_cast<int>(watched.size()); }
  int number_of(int ball) const { return watched[ball].i; }
  bool has_slots(int ball) const { return watched[ball].first_slot >= 0; }
  double memory_usage() const;    // bytes

 private:
  struct Near {
    Triangle triangle;
    int number;
  };
  struct Ball {
    int i;
    size_t first, last;    // of listed
    int first_slot;
    Vector seen;    // place at which what follows was found
    double free;    // distance from it within which only near can be touched, m
    std::vector<Near> near;
  };

  std::vector<int> listed;
  std::vector<Ball> watched;
  std::vector<SurfacePoint> points;    // of one ball, while it is looked at
  std::vector<SurfaceContact> own;
  std::vector<char> taken;

  void find_near(Ball &ball, const Vector &x, double radius, double step,
                 const TouchedSurface &surface);
  void hand_out(int ball, const Vector &x, double radius);
  static SurfaceContact followed(SurfaceContact now, const Vector &normal);
  void set(Slot &slot, const SurfaceContact &contact, const Vector &x, double radius);
  int new_slot(int ball);
};

}    // namespace Slope

#endif

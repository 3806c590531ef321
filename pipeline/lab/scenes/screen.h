// A vibrating screen that sorts spheres by size.
#pragma once
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/spheres.h"

namespace gonogo::lab {

struct ScreenSpec {
  Spheres of{.count = 3000};  // small and large ones together; the diameter is that of the small ones
  double large_share = 0.5;   // of the feed's volume, as it lies loosely
  double throw_number = 3;    // largest acceleration of the deck at right angles to it, in g
  double shaken = 10;         // [s]

  double width() const;        // of the deck [m]
  double length() const;       // [m]
  double crank() const;        // radius of the crank: half of the deck's stroke [m]
  double crank_speed() const;  // [rad/s]
};

/// Bodies of the machine, behind the spheres.
struct ScreenParts {
  sim::BodyIndex ground, deck, crank, rod;
  Vec3d stroke;       // unit, the way the deck is thrown
  double rod_length;  // pin to pin [m]
};

/// Large spheres, twice as wide as the small ones, and eight small ones in the place of each of the others, lie over
/// the rear of a deck of bars that leave 1.4 small diameters between them. A crank, turned by a motor, moves a rod, and
/// the rod the deck, which slides at 45 degrees upward and forward (linear-motion screen: B. A. Wills & J. Finch,
/// Mineral Processing Technology, 8th ed., ch. 8). What falls through lies before a wall below the front edge, what
/// travels over the deck behind it. Watched: shares of the small and of the large spheres that are through, share of
/// the large ones that are over, and Newton's efficiency, the first less the second: 1 for a perfect screen, 0 for one
/// that splits the feed without sorting.
ManyScene screen_scene(const ScreenSpec& spec, const RunOn& on);

ScreenParts screen_parts(const ScreenSpec& spec);

}  // namespace gonogo::lab

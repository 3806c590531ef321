// A vibrating screen that sorts spheres by size.
#pragma once
#include "pipeline/lab/scenes/scene.h"

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

/// The feed lies over the rear of a deck of bars 1.4 small diameters apart. Large spheres are twice as wide as small
/// ones. A motor turns a crank, whose rod moves the deck at 45 degrees upward and forward (linear-motion screen: B. A.
/// Wills & J. Finch, Mineral Processing Technology, 8th ed., ch. 8). Spheres that fall through end before a wall below
/// the front edge, the others behind it. Watched: shares of the small and of the large spheres that are through, share
/// of the large ones that are over, and Newton's efficiency. That is the share of the small ones through less that of
/// the large ones: 1 for a perfect screen, 0 for one that does not sort.
ManyScene screen_scene(const ScreenSpec& spec, const RunOn& on);

ScreenParts screen_parts(const ScreenSpec& spec);

}  // namespace gonogo::lab

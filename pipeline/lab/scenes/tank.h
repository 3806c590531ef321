// A tank full of any number of spheres, made in seconds. A tile of spheres is settled once between periodic sides.
// Copies of it are laid side by side, and walls are put around them.
#pragma once
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/spheres.h"

namespace gonogo::lab {

struct TankSpec {
  Spheres of{.count = 100'000};
  int layers = 50;               // of spheres, fewer where there are few: the tank's depth does not grow with its floor
  double length_over_width = 1;  // of the floor, x over y, about
  double seconds = 0.12;         // shaken before anything is timed: the spheres meet the walls [s]
};

/// Bodies 0 .. spheres - 1 are the spheres. The next body is the tank: a floor at z = 0 and four walls, planes of one
/// fixed body. The surface is flat except where spheres were taken off for an exact count. Spheres beside a wall are up
/// to a radius away from it until the first steps. Settled on the backend of `on`. Throws DeviceError when settling
/// failed.
sim::SceneWorld tank_world(const TankSpec& spec, const RunOn& on);

/// Share of the volume that spheres fill, measured two spheres away from floor, surface and walls [-].
double solid_fraction(const TankSpec& spec, const sim::SceneWorld& world);

/// Shaken along x with half of gravity at 2 Hz, in the tank's frame: gravity leans to and fro.
ManyScene shaken_tank(const TankSpec& spec, const RunOn& on);

}  // namespace gonogo::lab

// A tank full of spheres, made in seconds for any number of them: a block of spheres is settled once between periodic
// sides, many of it are laid side by side, and walls are put around them.
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

/// Bodies 0 .. spheres - 1 are the spheres, the next one is the tank: a floor at z = 0 and four walls, planes of one
/// fixed body. The surface is flat but for spheres taken off the top to leave the number that was asked for. Spheres
/// beside a wall have up to a radius of room from it until the first steps have been taken. Settled where `on` says.
/// Throws DeviceError when settling failed.
sim::SceneWorld tank_world(const TankSpec& spec, const RunOn& on);

/// Share of the tank that spheres fill between two spheres above the floor and two below the surface, away from the
/// walls [-].
double solid_fraction(const TankSpec& spec, const sim::SceneWorld& world);

/// Shaken along x with half of gravity, two times a second. It is watched from inside of the tank, so gravity leans to
/// and fro.
ManyScene shaken_tank(const TankSpec& spec, const RunOn& on);

}  // namespace gonogo::lab

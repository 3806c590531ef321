// A tracked vehicle that drives over pebbles.
#pragma once
#include <filesystem>

#include "pipeline/lab/scenes/tank.h"

namespace gonogo::lab {

struct PebblesSpec {
  /// The floor is three times as long as it is wide.
  TankSpec tank{.of = {.count = 15'000, .diameter = 0.1, .size_spread = 0.3, .friction = 0.6},
                .layers = 5,
                .length_over_width = 3};
  std::filesystem::path vehicle;  // a tracked vehicle's file
  double belt_friction = 0.8;     // of shoes on pebbles [-]
  double rolling_friction = 0.3;  // of pebbles, which are not round [-]
  double speed = 1.5;             // that its driver holds [m/s]
  double driven = 3;              // after the brakes have been released [s]
};

/// The vehicle is let down onto a settled tank of pebbles near its end at low x. It stands with its brakes on for a
/// second and drives off along x. Its belts are shoes on pins, each shoe a body. Watched: way, speed, slip of the
/// sprockets (1 - way over turn times rolling radius), load of the pebbles over the vehicle's weight. Throws InputError
/// for a vehicle without tracks and for a tank too small for it.
ManyScene pebbles_scene(const PebblesSpec& spec, const RunOn& on);

}  // namespace gonogo::lab

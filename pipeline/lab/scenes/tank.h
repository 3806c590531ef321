// A tank full of any number of spheres, made in seconds, and scenes in it. A tile of spheres is settled once between
// periodic sides. Copies of it are laid side by side, and walls are put around them.
#pragma once
#include <filesystem>

#include "pipeline/lab/scenes/scene.h"

namespace gonogo::lab {

struct TankSpec {
  Spheres of{.count = 100'000};
  int layers = 50;               // of spheres, fewer where there are few: the tank's depth does not grow with its floor
  double length_over_width = 1;  // of the floor, x over y, about
  double seconds = 0.12;         // shaken before anything is timed: the spheres settle against the walls [s]
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

// The search for contacts by itself.

struct CollideBench {
  TankSpec tank;
  RunOn on;  // without iterations
  int repeats = 11;
};

struct CollideBenchResult {
  std::int64_t bodies = 0, contacts = 0;
  double build_seconds = 0;   // of settling, laying out and the first search
  double ms_per_search = 0;   // median of bins and contacts
  sim::StageTimes stages;     // medians
  double ns_per_contact = 0;  // of the search
};

/// Finds the contacts of the tank at rest `repeats` times: bins, pairs, gaps, normals and points. Takes no step.
CollideBenchResult bench_collide(const CollideBench& request);

// A large ball among the spheres of a tank.

/// The tank with the ball as its first body, without the spheres that the ball overlaps. Density [kg/m^3].
sim::SceneWorld with_ball(const sim::SceneWorld& tank, const Vec3d& centre, double radius, double density);

/// Middle of the tank's floor [m].
Vec3d middle_of(const sim::SceneWorld& world);

/// Mean height of the highest centre in columns two diameters wide [m]. Columns at and beside the ball are left out.
/// `bodies`: the ball first, the tank last.
double surface_of(const std::vector<sim::BodyState>& bodies, const TankSpec& tank, const sim::SceneWorld& world,
                  double ball_radius);

// A light ball that floats on many spheres.

struct BallSpec {
  TankSpec tank{.of = {.count = 20'000}};
  double size_ratio = 10;         // of the ball to the spheres
  double relative_density = 0.5;  // of the ball to the bulk that it swims on
  double floated = 3;             // [s]
};

/// A ball laid onto a tank of smooth spheres, which are as fluid as spheres can be. Measured: share of the ball's
/// volume below the mean surface. Archimedes: `relative_density`.
ManyScene ball_scene(const BallSpec& spec, const RunOn& on);

// A ball dropped onto a bed of spheres.

struct CraterSpec {
  TankSpec tank{.of = {.count = 8000}};
  double size_ratio = 5;   // of the ball to the spheres
  double density = 2600;   // of the ball [kg/m^3]
  double drop_height = 1;  // of its lowest point over the surface [m]
  double watched = 0.8;    // after it has touched the surface [s]
};

/// The ball starts at the surface with the speed of its fall. Measured at the end [m]: depth of its lowest point below
/// the surface, and H = drop height + depth. Experiments find depth ~ H^(1/3) (Uehara et al. 2003).
ManyScene crater_scene(const CraterSpec& spec, const RunOn& on);

// A large sphere among small ones in a tank that is shaken upright.

struct NutSpec {
  TankSpec tank{.of = {.count = 4000}};
  double size_ratio = 4;    // of the large sphere to the small ones, of equal density
  double acceleration = 3;  // largest one of the tank, in g
  double frequency = 5;     // [Hz]
  double shaken = 10;       // [s]
};

/// One large sphere on the floor of a filled tank, which then moves up and down, in the tank's frame. Measured: heights
/// of its centre over the depth of the fill at the start and at the end. It rises (Brazil nut).
ManyScene nut_scene(const NutSpec& spec, const RunOn& on);

// A tracked vehicle that drives over pebbles.

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

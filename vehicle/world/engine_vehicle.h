// A vehicle in a world of the contact engine: bodies, joints, struts, wheels and tracks.
#pragma once
#include "vehicle/world/engine_track.h"

namespace gonogo::vehicle {

/// A turning part that trials record: a wheel or, after the road wheels, a sprocket.
struct RunningPart {
  std::string name;             // "front left", "left sprocket"
  Vec3d centre{};               // [m]
  double reach = 0, width = 0;  // of the tyre or shoe under it: down from the axle, across; 0: none [m]
  double rolling_radius = 0;    // distance per radian of turn [m]
  bool driven = false;
};

std::vector<RunningPart> running_parts(const Vehicle& v);

/// Points along the bottom of a tracked vehicle's belts, 10 mm apart, in the vehicle's frame [m]. Empty for others.
std::vector<Vec3d> belt_bottom(const Vehicle& v);

struct EngineVehicle {
  std::vector<Station> station;
  EngineBodies bodies;
  std::vector<sim::BodyIndex> wheel{};  // [station]
  std::vector<Index> drive_motor{};     // [station] between wheel and its carrier; -1: not driven
  std::vector<Index> brake_motor{};     // [station]; -1: none
  std::vector<Index> steer_motor{};     // of the steering arms; empty without steering
  sim::BodyIndex chassis = 0;           // that goes the vehicle's way; of a quarter its wheel
  Vec3d chassis_centre{};               // its centre of mass in the vehicle's frame [m]
  Vec3 hitch_B{};                    // in the chassis: at the rear, as high as the axles; of a quarter in its axle [m]
  std::vector<EngineTrack> track{};  // left, right; sprockets drive and brake, not road wheels
};

/// Body and drive motor (-1: none) of running_parts()[part].
sim::BodyIndex running_body(const EngineVehicle& e, std::size_t part);
Index running_motor(const EngineVehicle& e, std::size_t part);

/// The same vehicle with a payload [kg] at the chassis's centre of mass; a quarter gets its share.
Vehicle loaded(Vehicle v, double payload);

/// Distance from a station's axle down to flat ground at first touch [m]: to the tips of the lugs, or to the bottom of
/// a belt whose plates do not touch the wheel yet.
double ground_reach(const Vehicle& v, const Wheel& wheel);

/// Height of the vehicle's origin over flat ground when its wheels or lugs just touch [m].
double standing_height(const Vehicle& v);

/// Mass of vehicle or quarter with its share of a payload [kg].
double loaded_mass(const Vehicle& v, double payload);

/// Adds the vehicle in its design position, with its origin at `origin` and its axes along the world's. A quarter's
/// origin is its axle; its spring is unloaded, so that it settles under its own weight; `yaw` turns its wheel from x
/// towards y [rad]. Call set_down() of track_loop.h on tracked vehicles first. Throws InputError for a tracked vehicle
/// without a belt that closes. `v` must outlive the result. `tool_material`: of its shapes in the world.
EngineVehicle add_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material,
                          double yaw = 0);

/// Sum of the moments of inertia of all parts that turn with the driven wheels, about the axle [kg m^2].
double driven_wheel_inertia(const Vehicle& v);

}  // namespace gonogo::vehicle

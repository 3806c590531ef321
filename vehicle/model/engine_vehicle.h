// A whole vehicle in a world of the contact engine: bodies, joints, struts, wheels, and what drives and brakes them.
#pragma once
#include "vehicle/model/engine_track.h"

namespace gonogo::vehicle {

/// What the driver is told; times in the world's time.
struct DriverOrders {
  double release = 0;        // the brakes are on until then [s]
  double throttle_ramp = 0;  // of the throttle, or of the commanded speed, from zero on [s]
  double speed = 0;          // to hold, on the speedometer [m/s]; 0: full throttle
  double brake_from = 1e9;   // throttle off and brakes fully on from then [s]
  int gear = 0;              // to stay in, 1 the lowest; 0: shifts by itself from the lowest one on
};

/// What a trial watches of a vehicle beside its chassis: wheels, and of a tracked vehicle its sprockets after its road
/// wheels.
struct RunningPart {
  std::string name;             // "front left", "left sprocket"
  Vec3d centre;                 // [m]
  double reach = 0, width = 0;  // of what touches the ground under it: down from its axle, and across; 0: nothing [m]
  double rolling_radius = 0;    // way per radian that it turns [m]
  bool driven = false;
};

std::vector<RunningPart> running_parts(const Vehicle& v);

/// Points along the bottom of a tracked vehicle's belts, between which a plate is flat, in the vehicle's frame; of
/// others none [m].
std::vector<Vec3d> belt_bottom(const Vehicle& v);

struct EngineVehicle {
  std::vector<Station> station;
  EngineBodies bodies;
  std::vector<sim::BodyIndex> wheel;  // [station]
  std::vector<Index> drive_motor;     // [station] of the wheel against what carries it, -1: not driven
  std::vector<Index> brake_motor;     // [station] -1: none
  std::vector<Index> steer_motor;     // of the steering arms, when there are any
  sim::BodyIndex chassis = 0;
  Vec3d chassis_centre;            // its centre of mass in the vehicle's frame [m]
  std::vector<EngineTrack> track;  // left, right; their sprockets drive and brake, not the stations' road wheels
};

/// Body and drive motor (-1: none) of a running part, by its place in running_parts().
sim::BodyIndex running_body(const EngineVehicle& e, std::size_t part);
Index running_motor(const EngineVehicle& e, std::size_t part);

/// The same vehicle with a payload in the chassis's centre of mass [kg].
Vehicle loaded(Vehicle v, double payload);

/// Distance from a station's axle down to where the vehicle touches flat ground before it has settled: its lugs' tips,
/// or the bottom of a belt whose plates touch no wheel yet [m].
double ground_reach(const Vehicle& v, const Wheel& wheel);

/// Height of the vehicle's origin over flat ground when its wheels, lugs included, just touch [m].
double standing_height(const Vehicle& v);

/// Adds the vehicle in its design position, origin at `origin`, axes along the world's. A tracked one must have been
/// set down (track_loop.h); throws InputError where its file has no belt, or one that does not close. `v` must outlive
/// the result.
EngineVehicle add_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material);

/// Adds drivelines or controllers, brakes and differentials. Throws InputError for what the engine cannot drive: a
/// converter without capacity, a centre differential that locks between axles with open ones.
void add_drive(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const DriverOrders& orders);

/// Whether the file says how its driver keeps to a straight line, and with which wheels.
bool steers(const Vehicle& v);

/// Lets the driver keep the vehicle on the line along x through where it starts, by a point ahead of it. The inner ends
/// of its steered wheels' tie rods are held by arms that turn in the chassis, each parallel to its wheel's steering
/// arm, so that wheel and arm turn by the same angle. Call after add_vehicle, for a vehicle that steers.
void add_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const Vec3d& origin);

/// Moments of inertia about the axle of everything that turns with the driven wheels [kg m^2].
double driven_wheel_inertia(const Vehicle& v);

}  // namespace gonogo::vehicle

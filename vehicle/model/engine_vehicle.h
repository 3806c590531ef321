// A whole vehicle in a world of the contact engine: bodies, joints, struts, wheels, driveline and brakes.
#pragma once
#include "vehicle/model/engine_track.h"

namespace gonogo::vehicle {

/// Orders to the driver, in the world's time.
struct DriverOrders {
  double release = 0;        // time at which the brakes are released [s]
  double throttle_ramp = 0;  // time in which throttle or commanded speed rises from zero [s]
  double speed = 0;          // speedometer reading to hold [m/s]; 0: full throttle
  double brake_from = 1e9;   // time of full braking with the throttle closed [s]
  int gear = 0;              // gear to stay in, 1 the lowest; 0: automatic shifts from the lowest
  bool by_hand = false;      // pedals stand at zero until someone sets them; brakes are left to whoever drives
};

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
  std::vector<sim::BodyIndex> wheel;  // [station]
  std::vector<Index> drive_motor;     // [station] between wheel and its carrier; -1: not driven
  std::vector<Index> brake_motor;     // [station]; -1: none
  std::vector<Index> steer_motor;     // of the steering arms; empty without steering
  sim::BodyIndex chassis = 0;
  Vec3d chassis_centre;            // its centre of mass in the vehicle's frame [m]
  std::vector<EngineTrack> track;  // left, right; sprockets drive and brake, not road wheels
};

/// Body and drive motor (-1: none) of running_parts()[part].
sim::BodyIndex running_body(const EngineVehicle& e, std::size_t part);
Index running_motor(const EngineVehicle& e, std::size_t part);

/// The same vehicle with a payload [kg] at the chassis's centre of mass.
Vehicle loaded(Vehicle v, double payload);

/// Distance from a station's axle down to flat ground at first touch [m]: to the tips of the lugs, or to the bottom of
/// a belt whose plates do not touch the wheel yet.
double ground_reach(const Vehicle& v, const Wheel& wheel);

/// Height of the vehicle's origin over flat ground when its wheels or lugs just touch [m].
double standing_height(const Vehicle& v);

/// Adds the vehicle in its design position, with its origin at `origin` and its axes along the world's. Call set_down()
/// of track_loop.h on tracked vehicles first. Throws InputError for a tracked vehicle without a belt that closes. `v`
/// must outlive the result.
EngineVehicle add_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material);

/// Adds drivelines or controllers, brakes and differentials. Throws InputError for drivelines that the engine does not
/// know: a converter without capacity, a locking centre differential between axles with open ones.
void add_drive(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const DriverOrders& orders);

/// Whether some wheels turn on kingpins that tie rods hold, and the file says how far.
bool has_steered_wheels(const Vehicle& v);
/// Whether the file describes straight-line steering: gains of the driver, and steered wheels.
bool steers(const Vehicle& v);

/// Adds a controller that steers towards the line along x through the start, by a point ahead of the vehicle. The tie
/// rods' inner ends are held by arms that turn in the chassis. Each is parallel to its wheel's steering arm, so that
/// wheel and arm turn by the same angle. Call after add_vehicle(), if steers().
void add_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const Vec3d& origin);

/// Controller of an arm that steers a wheel by an angle.
struct SteeredArm {
  Index controller = 0;
  double side = 1;  // -1: behind the middle of the vehicle, where wheels turn the other way
};

/// As add_steering(), but the arms hold the angles that sim::Simulation::set_command() gives their controllers [rad].
std::vector<SteeredArm> add_hand_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e,
                                          const Vec3d& origin);

/// Sum of the moments of inertia of all parts that turn with the driven wheels, about the axle [kg m^2].
double driven_wheel_inertia(const Vehicle& v);

}  // namespace gonogo::vehicle

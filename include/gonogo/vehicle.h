// Vehicles from files: their numbers, and driving them in a simulated world. Link gonogo::vehicle.
//
// Frame of a vehicle: x forward, y left, z up. docs/vehicles.md describes the files.
#pragma once
#include <gonogo/sim.h>

namespace gonogo::api {

/// Pressure that soil must carry in one pass and in fifty [Pa].
struct ConeIndex {
  double one_pass = 0, fifty_passes = 0;
};

/// A vehicle with its payload. Cheap to copy.
class Vehicle {
 public:
  struct Impl;
  explicit Vehicle(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  /// A file, or a shipped vehicle ("hmmwv"; "hmmwv_quarter" is one wheel with its share of the mass). `payload`: at the
  /// chassis's centre of mass, of the whole vehicle [kg].
  static Vehicle read(const std::string& name_or_file, double payload = 0);

  std::string name() const;
  bool is_quarter() const;
  double length() const, width() const;  // [m]; 0 where a quarter's file gives none
  double mass() const;                   // [kg]
  double tread_radius() const;           // of the driven wheels without lugs, or of the sprocket [m]
  double max_drive_torque() const;       // sum over driven wheels, in the lowest gear [N m]
  double standing_height() const;        // of its origin when it just touches flat ground [m]
  double max_steering_angle() const;     // of the wheels [rad]
  /// "wheels", "motors" (unequal on the two sides), "brakes" (of one side) or "none".
  std::string steering() const;
  /// Whether every driven wheel has a motor: throttle below zero then drives backwards instead of braking.
  bool has_wheel_motors() const;
  /// Normal loads of the wheels on level ground [N], axle by axle, left before right.
  std::vector<double> wheel_loads() const;
  /// Largest tractive force at full throttle and this speed of the treads [m/s], before slip and resistance [N].
  double tractive_force(double tread_speed) const;
  /// Throws InputError where the file gives no nominal tyre size.
  ConeIndex cone_index() const;

  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// A vehicle in a world. Cheap to copy; valid in every simulation of that world.
class PlacedVehicle {
 public:
  struct Impl;
  explicit PlacedVehicle(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

  /// Body that goes the vehicle's way; of a quarter its wheel.
  int chassis() const;
  /// Bodies of the wheels, axle by axle, left before right.
  const std::vector<int>& wheels() const;
  /// Motor between each wheel and its carrier; -1: not driven.
  const std::vector<int>& drive_motors() const;

  /// Holds throttle and steering, both -1 to 1, from now on. Throttle below zero brakes, or with wheel motors drives
  /// backwards; steering above zero turns to the left. Throws InputError outside these ranges and for a quarter.
  void drive(Simulation& simulation, double throttle, double steering = 0, int world = 0) const;
  /// Of a quarter: holds the speed of the rim [m/s] with the torque that the vehicle has. Throws InputError for others.
  void set_rim_speed(Simulation& simulation, double speed, int world = 0) const;

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Adds a vehicle at rest that faces along x and just touches flat ground at `ground`, below its origin [m].
/// `material`: of its tyres or tracks; a bed's kToolMaterial is 2.
PlacedVehicle place(World& world, const Vehicle& vehicle, const Vec3& ground, int material = 2);

}  // namespace gonogo::api

#include <gonogo/vehicle.h>

#include <optional>

#include "base/files/shipped.h"
#include "base/units.h"
#include "pipeline/face/inside.h"
#include "vehicle/model/statics.h"
#include "vehicle/model/track_loop.h"
#include "vehicle/semi_empirical/mobility_index.h"
#include "vehicle/world/driving.h"

namespace gonogo::api {

struct Vehicle::Impl {
  vehicle::Vehicle vehicle;
};

struct PlacedVehicle::Impl {
  Vehicle vehicle;  // `driven` points into it
  vehicle::DrivenVehicle driven{};
  std::vector<int> wheels{}, motors{};
  std::size_t bodies = 0, world_motors = 0;  // of the world, when the vehicle had been added

  const vehicle::Vehicle& model() const { return vehicle.impl().vehicle; }
  /// Throws gonogo::InputError for a world that this vehicle was not added to.
  sim::Simulation& engine(Simulation& simulation, int world) const {
    sim::Simulation& engine = simulation.impl().at(world);
    const sim::SceneWorld& scene = simulation.impl().world[std::size_t(world)];
    if (scene.body.size() < bodies || scene.motor.size() < world_motors)
      throw gonogo::InputError("vehicle " + model().name + ": it was added to another world than world " +
                               std::to_string(world));
    return engine;
  }
};

Vehicle Vehicle::read(const std::string& name_or_file, double payload) {
  return guarded([&] {
    if (!(payload >= 0)) throw gonogo::InputError("payload of " + name_or_file + ": zero or more is needed [kg]");
    const vehicle::Vehicle v = vehicle::read_any_vehicle(shipped_file("vehicles", "vehicle", name_or_file));
    return Vehicle(std::make_shared<Impl>(Impl{vehicle::set_down(vehicle::loaded(v, payload))}));
  });
}

std::string Vehicle::name() const { return impl_->vehicle.name; }
bool Vehicle::is_quarter() const { return vehicle::is_quarter(impl_->vehicle); }
double Vehicle::length() const { return impl_->vehicle.length; }
double Vehicle::width() const { return impl_->vehicle.width; }
double Vehicle::mass() const { return vehicle::weigh(impl_->vehicle).total; }
double Vehicle::tread_radius() const { return vehicle::drive_radius(impl_->vehicle); }
double Vehicle::max_drive_torque() const { return vehicle::largest_drive_torque(impl_->vehicle); }
double Vehicle::standing_height() const { return vehicle::standing_height(impl_->vehicle); }
double Vehicle::max_steering_angle() const { return impl_->vehicle.max_steering_angle; }
std::string Vehicle::steering() const { return vehicle::name_of(vehicle::steering_of(impl_->vehicle)); }
bool Vehicle::has_wheel_motors() const { return impl_->vehicle.driveline.wheel_motors; }
std::vector<double> Vehicle::wheel_loads() const {
  return guarded([&] { return vehicle::static_loads(impl_->vehicle); });
}
double Vehicle::tractive_force(double tread_speed) const {
  return guarded([&] {
    if (!(tread_speed >= 0)) throw gonogo::InputError("tractive_force: the speed must not be below zero [m/s]");
    return vehicle::tractive_force(impl_->vehicle, tread_speed);
  });
}
ConeIndex Vehicle::cone_index() const {
  return guarded([&] {
    const vehicle::VehicleConeIndex index = vehicle::vehicle_index(impl_->vehicle).cone_index;
    return ConeIndex{index.one_pass * kPsi, index.fifty_passes * kPsi};
  });
}

int PlacedVehicle::chassis() const { return impl_->driven.parts.chassis; }
const std::vector<int>& PlacedVehicle::wheels() const { return impl_->wheels; }
const std::vector<int>& PlacedVehicle::drive_motors() const { return impl_->motors; }

void PlacedVehicle::drive(Simulation& simulation, double throttle, double steering, int world) const {
  guarded([&] {
    if (vehicle::is_quarter(impl_->model()))
      throw gonogo::InputError("vehicle " + impl_->model().name + ": a quarter has no throttle; set its rim speed");
    vehicle::set_controls(impl_->engine(simulation, world), world, impl_->driven, throttle, steering);
  });
}

void PlacedVehicle::set_rim_speed(Simulation& simulation, double speed, int world) const {
  guarded([&] {
    const vehicle::Vehicle& v = impl_->model();
    if (!vehicle::is_quarter(v))
      throw gonogo::InputError("vehicle " + v.name + ": only a quarter's rim speed can be set; drive() this one");
    impl_->engine(simulation, world)
        .set_motor(world, impl_->motors.front(), Real(speed / vehicle::drive_radius(v)),
                   Real(vehicle::largest_drive_torque(v)));
  });
}

PlacedVehicle place(World& world, const Vehicle& vehicle, const Vec3& ground, int material) {
  return guarded([&] {
    if (material < 0 || material >= kMaterials)
      throw gonogo::InputError("place: material " + std::to_string(material) + ": there are 0 to " +
                               std::to_string(kMaterials - 1));
    PlacedVehicle::Impl placed{.vehicle = vehicle};
    const vehicle::Vehicle& v = placed.model();
    const Vec3d origin{ground.x, ground.y, ground.z + vehicle::standing_height(v)};
    sim::SceneWorld& scene = world.impl().scene;
    if (vehicle::is_quarter(v))
      placed.driven.parts = vehicle::add_vehicle(scene, v, origin, material);
    else
      placed.driven = vehicle::add_driven_vehicle(scene, v, origin, material);
    placed.wheels.assign(placed.driven.parts.wheel.begin(), placed.driven.parts.wheel.end());
    placed.motors.assign(placed.driven.parts.drive_motor.begin(), placed.driven.parts.drive_motor.end());
    placed.bodies = scene.body.size();
    placed.world_motors = scene.motor.size();
    return PlacedVehicle(std::make_shared<PlacedVehicle::Impl>(std::move(placed)));
  });
}

}  // namespace gonogo::api

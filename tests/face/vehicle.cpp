#include <gonogo/terrain.h>
#include <gonogo/vehicle.h>

#include <numeric>

#include "tests/support/catch.h"

using namespace gonogo::api;

TEST_CASE("wheels of the face carry the vehicle and its payload") {
  const Vehicle empty = Vehicle::read("hmmwv"), loaded = Vehicle::read("hmmwv", 500);
  CHECK(loaded.mass() == Approx(empty.mass() + 500));
  const auto loads = loaded.wheel_loads();
  CHECK(loads.size() == 4);
  CHECK(std::accumulate(loads.begin(), loads.end(), 0.0) == Approx(loaded.mass() * 9.80665).epsilon(1e-3));
  CHECK(empty.name() == "hmmwv");
  CHECK(empty.steering() == "wheels");
  CHECK_FALSE(empty.is_quarter());
  CHECK_FALSE(empty.has_wheel_motors());
  CHECK(empty.max_steering_angle() > 0.3);
  CHECK(empty.length() > empty.width());
  CHECK(empty.tractive_force(1) > empty.tractive_force(15));
  CHECK(empty.cone_index().fifty_passes > empty.cone_index().one_pass);
  CHECK_THROWS_AS(Vehicle::read("hmmwv", -1), InputError);
  CHECK_THROWS_AS(Vehicle::read("no_such_vehicle"), InputError);
}

TEST_CASE("a vehicle of the face drives forward on hard ground, and turns to the left") {
  World world({.origin = {0, 0, -2}, .size = {60, 30, 12}});
  world.add_floor(0);
  world.set_law(0, kToolMaterial, {.friction = 0.8});
  const PlacedVehicle car = place(world, Vehicle::read("hmmwv"), {10, 15, 0});
  CHECK(car.wheels().size() == 4);
  Simulation simulation({world}, {.step = 2e-3, .iterations = 50, .threads = 2});
  const Vec3 start = simulation.body(car.chassis()).position;
  car.drive(simulation, 0.6, 0.5);
  simulation.step(1000);
  const Vec3 now = simulation.body(car.chassis()).position;
  CHECK(now.x - start.x > 0.5);
  CHECK(now.y - start.y > 0.01);
  CHECK_THROWS_AS(car.drive(simulation, 2), InputError);
  CHECK_THROWS_AS(car.set_rim_speed(simulation, 1), InputError);
  World other({.size = {1, 1, 1}});
  other.add_floor(0);
  Simulation without({other});
  CHECK_THROWS_AS(car.drive(without, 0), InputError);
}

TEST_CASE("a quarter of the face turns at the rim speed that is set") {
  World world({.origin = {0, 0, -1}, .size = {20, 4, 6}});
  world.add_floor(0);
  world.set_law(0, kToolMaterial, {.friction = 0.8});
  const Vehicle quarter = Vehicle::read("hmmwv_quarter");
  CHECK(quarter.is_quarter());
  CHECK(quarter.max_drive_torque() > 0);
  const PlacedVehicle wheel = place(world, quarter, {2, 2, 0});
  Simulation simulation({world});
  CHECK(simulation.body(wheel.chassis()).position.z == Approx(quarter.standing_height()).margin(1e-3));
  wheel.set_rim_speed(simulation, 1);
  simulation.step(2000);
  CHECK(simulation.body(wheel.chassis()).angular_velocity.y * quarter.tread_radius() == Approx(1).epsilon(0.05));
  CHECK(simulation.body(wheel.chassis()).velocity.x > 0.8);
  CHECK(simulation.motor_torque(wheel.drive_motors().front()) <= quarter.max_drive_torque());
  CHECK_THROWS_AS(wheel.drive(simulation, 0.5), InputError);
}

// Whole vehicles that Python puts into a world and drives.
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "base/shipped.h"
#include "python/src/calls.h"
#include "python/src/module.h"
#include "python/src/state.h"
#include "terrain/bed/bed.h"
#include "vehicle/model/statics.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

std::shared_ptr<vehicle::Vehicle> read(const std::string& name, double payload) {
  if (!(payload >= 0)) throw InputError("payload: " + std::to_string(payload) + " kg given; zero or more is needed");
  return long_call([&] {
    const vehicle::Vehicle v = vehicle::read_vehicle(shipped_file("vehicles", "vehicle", name));
    return std::make_shared<vehicle::Vehicle>(vehicle::set_down(vehicle::loaded(v, payload)));
  });
}

Driven add(sim::SceneWorld& world, std::shared_ptr<vehicle::Vehicle> v, const std::array<double, 3>& ground,
           int material) {
  const Vec3d origin{ground[0], ground[1], ground[2] + vehicle::standing_height(*v)};
  Driven driven{v, vehicle::add_driven_vehicle(world, *v, origin, material), {}};
  driven.world = {Index(world.body.size()), Index(world.motor.size()), Index(world.controller.size()),
                  Index(world.driveline.size())};
  return driven;
}

std::string steering_of(const vehicle::Vehicle& v) { return vehicle::name_of(vehicle::steering_of(v)); }

}  // namespace

void bind_vehicle(nb::module_& m) {
  using namespace nb::literals;
  using vehicle::Vehicle;
  nb::class_<Vehicle>(m, "Vehicle", "A whole vehicle. Frame: x forward, y left, z up.")
      .def_static(
          "read", [](const std::string& name, double payload) { return read(name, payload); }, "name"_a,
          "payload"_a = 0.0, "A shipped vehicle's name or a file; payload at the chassis's centre of mass [kg].")
      .def_ro("name", &Vehicle::name)
      .def_ro("length", &Vehicle::length, "[m]")
      .def_ro("width", &Vehicle::width, "[m]")
      .def_prop_ro(
          "mass", [](const Vehicle& v) { return vehicle::weigh(v).total; }, "[kg]")
      .def_prop_ro(
          "steering", &steering_of,
          "What turns it: \"wheels\", \"motors\" (unequal on the two sides), \"brakes\" of one side, or \"none\".")
      .def_prop_ro(
          "wheel_motors", [](const Vehicle& v) { return v.driveline.wheel_motors; },
          "Whether a motor sits in every driven wheel: throttle below zero drives backwards then.")
      .def_ro("max_steering_angle", &Vehicle::max_steering_angle, "Of the wheels [rad].");
  nb::class_<Driven>(m, "DrivenVehicle", "A vehicle in a world, for Simulation.drive().")
      .def_prop_ro("vehicle", [](const Driven& d) { return d.vehicle; })
      .def_prop_ro(
          "chassis", [](const Driven& d) { return d.parts.parts.chassis; }, "Index of its body.")
      .def_prop_ro(
          "wheels", [](const Driven& d) { return d.parts.parts.wheel; },
          "Indices of their bodies, axle by axle, left before right.")
      .def_prop_ro("steering", [](const Driven& d) { return vehicle::name_of(d.parts.steering); });
  auto world = nb::borrow<nb::class_<sim::SceneWorld>>(m.attr("World"));
  world.def("add_vehicle", &add, "vehicle"_a, "ground"_a, "material"_a = int(terrain::tool_material),
            "Adds a vehicle at rest that faces along x, with its origin over this point of flat ground [m].");
}

}  // namespace gonogo::python

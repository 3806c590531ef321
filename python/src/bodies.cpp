// Whole vehicles that Python puts into a world and drives.
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "base/files/shipped.h"
#include "python/src/binding.h"
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

namespace {

void bind_host(nb::module_& m) {
  using Self = nb::handle_t<Bodies>;
  const auto all = [](Self self) -> const std::vector<sim::BodyState>& { return nb::cast<Bodies&>(self).state; };
  nb::class_<Bodies>(m, "Bodies", "All bodies of a world at one time. Arrays are views of one block of memory.")
      .def("__len__", [](const Bodies& b) { return b.state.size(); })
      .def_prop_ro(
          "position", [all](Self s) { return field_of(all(s), &all(s).data()->position.x, 3, s); },
          "Centres of mass [body, 3] [m].")
      .def_prop_ro(
          "orientation", [all](Self s) { return field_of(all(s), &all(s).data()->orientation.w, 4, s); },
          "Unit quaternions w, x, y, z [body, 4].")
      .def_prop_ro(
          "velocity", [all](Self s) { return field_of(all(s), &all(s).data()->velocity.x, 3, s); }, "[body, 3] [m/s].")
      .def_prop_ro(
          "angular_velocity", [all](Self s) { return field_of(all(s), &all(s).data()->angular_velocity.x, 3, s); },
          "[body, 3] [rad/s].");
}

void bind_contacts(nb::module_& m) {
  using Self = nb::handle_t<Contacts>;
  const auto all = [](Self self) -> const std::vector<sim::Contact>& { return nb::cast<Contacts&>(self).contact; };
  const auto push = [](Self self) -> const std::vector<sim::Impulse>& { return nb::cast<Contacts&>(self).impulse; };
  nb::class_<Contacts>(m, "Contacts", "All contacts of a world's latest step. Arrays are views.")
      .def("__len__", [](const Contacts& c) { return c.contact.size(); })
      .def_prop_ro(
          "body_a", [all](Self s) { return field_of(all(s), &all(s).data()->body_a, 1, s); }, "[contact]")
      .def_prop_ro(
          "body_b", [all](Self s) { return field_of(all(s), &all(s).data()->body_b, 1, s); }, "[contact]")
      .def_prop_ro(
          "normal", [all](Self s) { return field_of(all(s), &all(s).data()->normal.x, 3, s); },
          "Unit vectors from body b to body a [contact, 3].")
      .def_prop_ro(
          "gap", [all](Self s) { return field_of(all(s), &all(s).data()->gap, 1, s); },
          "Negative when the bodies overlap [contact] [m].")
      .def_prop_ro(
          "impulse", [push](Self s) { return field_of(push(s), &push(s).data()->linear.x, 3, s); },
          "On body a in the last substep [contact, 3] [N s].");
}

/// `first`: of the first record. The memory may be a GPU's, so nothing reads it here.
template <class T>
DeviceArray<T> device_field(const DeviceBodies& b, T* first, std::size_t width, nb::handle owner) {
  const std::size_t shape[] = {std::size_t(b.on.count), width};
  const std::int64_t strides[] = {sizeof(sim::BodyState) / sizeof(T), 1};
  const bool gpu = b.on.gpu >= 0;
  return DeviceArray<T>(first, 2, shape, owner, strides, nb::dtype<T>(),
                        gpu ? nb::device::cuda::value : nb::device::cpu::value, gpu ? b.on.gpu : 0);
}

void bind_device(nb::module_& m) {
  using Self = nb::handle_t<DeviceBodies>;
  const auto of = [](Self self) -> const DeviceBodies& { return nb::cast<DeviceBodies&>(self); };
  nb::class_<DeviceBodies>(
      m, "DeviceBodies",
      "Bodies at one time, in memory of the device that simulates. Arrays are views of one block "
      "with __dlpack__ and __dlpack_device__; they are ready, and stay when the simulation goes on.")
      .def("__len__", [](const DeviceBodies& b) { return std::size_t(b.on.count); })
      .def_prop_ro(
          "device", [](const DeviceBodies& b) { return b.on.gpu < 0 ? "cpu" : "cuda:" + std::to_string(b.on.gpu); },
          "\"cpu\", or \"cuda:\" and the number of the GPU.")
      .def_prop_ro(
          "position", [of](Self s) { return device_field(of(s), &of(s).on.state->position.x, 3, s); },
          "Centres of mass [body, 3] [m], float64.")
      .def_prop_ro(
          "orientation", [of](Self s) { return device_field(of(s), &of(s).on.state->orientation.w, 4, s); },
          "Unit quaternions w, x, y, z [body, 4], float32.")
      .def_prop_ro(
          "velocity", [of](Self s) { return device_field(of(s), &of(s).on.state->velocity.x, 3, s); },
          "[body, 3] [m/s], float32.")
      .def_prop_ro(
          "angular_velocity", [of](Self s) { return device_field(of(s), &of(s).on.state->angular_velocity.x, 3, s); },
          "[body, 3] [rad/s], float32.");
}

}  // namespace

void bind_bodies(nb::module_& m) {
  bind_host(m);
  bind_contacts(m);
  bind_device(m);
}

}  // namespace gonogo::python

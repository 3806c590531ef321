// Worlds to simulate, settled beds, and the quarter vehicle.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "python/src/binding.h"
#include "terrain/bed/bed.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

using Numbers = std::array<double, 3>;

Vec3d vec3d(const Numbers& v) { return {v[0], v[1], v[2]}; }
Vec3 vec3(const Numbers& v) { return {Real(v[0]), Real(v[1]), Real(v[2])}; }

sim::SceneWorld make_world(const Numbers& size, const Numbers& origin, const Numbers& gravity,
                           const std::pair<bool, bool>& periodic) {
  sim::SceneWorld world;
  world.size = vec3d(size);
  world.origin = vec3d(origin);
  world.gravity = vec3(gravity);
  world.periodic_x = periodic.first;
  world.periodic_y = periodic.second;
  return world;
}

void set_law(sim::SceneWorld& world, int a, int b, double friction, double rolling_friction, double cohesion_pressure) {
  if (a < 0 || b < 0 || a >= sim::kMaxMaterials || b >= sim::kMaxMaterials)
    throw InputError("set_law: materials are 0 to " + std::to_string(sim::kMaxMaterials - 1));
  world.set_law(a, b, {Real(friction), Real(rolling_friction), Real(cohesion_pressure)});
}

sim::BodyIndex add_floor(sim::SceneWorld& world, double height, int material) {
  const Vec3d& o = world.origin;
  const Vec3d middle{o.x + world.size.x / 2, o.y + world.size.y / 2, height};
  const sim::BodyIndex body = world.add_body({middle, {}, {}, {}}, sim::fixed_body());
  sim::Shape plane;
  plane.type = sim::ShapeType::plane;
  plane.body = body;
  plane.material = material;
  world.add_shape(plane);
  return body;
}

sim::BodyIndex add_box(sim::SceneWorld& world, const Numbers& position, const Numbers& half, double density,
                       int material) {
  const double mass = density * 8 * half[0] * half[1] * half[2];
  const auto moment = [&](int a, int b) { return Real(mass / 3 * (half[a] * half[a] + half[b] * half[b])); };
  const sim::BodyIndex body =
      world.add_body({vec3d(position), {}, {}, {}}, sim::solid(Real(mass), {moment(1, 2), moment(0, 2), moment(0, 1)}));
  sim::Shape box;
  box.type = sim::ShapeType::box;
  box.body = body;
  box.material = material;
  box.size = vec3(half);
  world.add_shape(box);
  return body;
}

terrain::Packing settle(double length, double width, double depth, double grain_diameter, std::uint64_t seed,
                        int threads) {
  terrain::BedSpec spec{
      .length = length, .width = width, .depth = depth, .grain_diameter = grain_diameter, .seed = seed};
  return long_call([&] { return terrain::settle_packing(spec, threads); });
}

sim::SceneWorld world_of(const terrain::Packing& packing, double friction, double rolling_friction,
                         double cohesion_pressure, double headroom) {
  const sim::PairLaw law{Real(friction), Real(rolling_friction), Real(cohesion_pressure)};
  return terrain::bed_world(packing, {law, law}, headroom);
}

/// A vehicle of kind quarter, which Python knows as a WheelRig.
struct Quarter : vehicle::Vehicle {};

std::tuple<int, int, int> add_wheel(sim::SceneWorld& world, const Quarter& quarter, const Numbers& axle,
                                    double payload) {
  const vehicle::Vehicle v = vehicle::loaded(quarter, payload);
  const vehicle::EngineVehicle e = vehicle::add_vehicle(world, v, vec3d(axle), terrain::tool_material);
  return {e.wheel.front(), e.bodies.body.front(), e.drive_motor.front()};
}

}  // namespace

void bind_scene(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<sim::SceneWorld>(m, "World", "Description of one world: a box with bodies. SI units, z up.")
      .def(
          "__init__",
          [](sim::SceneWorld* self, const Numbers& size, const Numbers& origin, const Numbers& gravity,
             const std::pair<bool, bool>& periodic) {
            new (self) sim::SceneWorld(make_world(size, origin, gravity, periodic));
          },
          "size"_a, "origin"_a = Numbers{0, 0, 0}, "gravity"_a = Numbers{0, 0, -kGravity},
          "periodic"_a = std::pair(false, false),
          "Box [origin, origin + size] [m], periodic along x and y where asked.")
      .def_prop_ro("body_count", [](const sim::SceneWorld& w) { return w.body.size(); })
      .def(
          "add_sphere",
          [](sim::SceneWorld& w, const Numbers& position, double radius, double density, int material) {
            return w.add_sphere(vec3d(position), Real(radius), Real(density), material);
          },
          "position"_a, "radius"_a, "density"_a = 2650.0, "material"_a = 0,
          "Adds a solid sphere [m, kg/m^3]. Returns the index of its body.")
      .def("add_box", &add_box, "position"_a, "half"_a, "density"_a = 2650.0, "material"_a = 0,
           "Adds a solid box of half edges `half` [m, kg/m^3]. Returns the index of its body.")
      .def("add_floor", &add_floor, "height"_a = 0.0, "material"_a = 0,
           "Adds a fixed level plane at z = height [m]. Returns the index of its body.")
      .def(
          "set_velocity",
          [](sim::SceneWorld& w, std::size_t body, const Numbers& velocity) {
            if (body >= w.body.size()) throw InputError("set_velocity: the world has no body " + std::to_string(body));
            w.body[body].velocity = vec3(velocity);
          },
          "body"_a, "velocity"_a, "Velocity at the start [m/s].")
      .def("set_law", &set_law, "material_a"_a, "material_b"_a, "friction"_a, "rolling_friction"_a = 0.0,
           "cohesion_pressure"_a = 0.0, "How two materials touch: friction [-], cohesion pressure [Pa].")
      .def("add_wheel_rig", &add_wheel, "rig"_a, "axle"_a, "payload"_a = 0.0,
           "Adds a quarter vehicle with its axle there [m]; payload of the whole vehicle [kg]. "
           "Returns the indices of wheel, sprung mass and motor.");
  nb::class_<terrain::Packing>(m, "Bed", "A settled periodic bed of grains.")
      .def_static("settle", &settle, "length"_a, "width"_a, "depth"_a, "grain_diameter"_a = 0.09, "seed"_a = 1,
                  "threads"_a = 1, "Pours and settles grains [m]. Deterministic in all arguments but threads.")
      .def_static(
          "read", [](const std::string& path) { return terrain::read_packing(path); }, "path"_a)
      .def(
          "write", [](const terrain::Packing& p, const std::string& path) { terrain::write_packing(path, p); },
          "path"_a)
      .def_prop_ro("grain_count", [](const terrain::Packing& p) { return p.grain.size(); })
      .def_prop_ro(
          "length", [](const terrain::Packing& p) { return p.spec.length; }, "[m]")
      .def_prop_ro(
          "width", [](const terrain::Packing& p) { return p.spec.width; }, "[m]")
      .def_prop_ro(
          "grain_diameter", [](const terrain::Packing& p) { return p.spec.grain_diameter; }, "[m]")
      .def_ro("solid_fraction", &terrain::Packing::solid_fraction, "[-]")
      .def_ro("surface", &terrain::Packing::surface, "Mean height of the top [m].")
      .def_prop_ro("highest_point", &terrain::highest_point, "[m]")
      .def("world", &world_of, "friction"_a, "rolling_friction"_a = 0.0, "cohesion_pressure"_a = 0.0,
           "headroom"_a = 2.0, "A world with this bed. Bodies 0 to grain_count - 1 are the grains, then the base.");
  nb::class_<Quarter>(m, "WheelRig", "A quarter vehicle: wheel, hub and sprung mass.")
      .def_static(
          "read", [](const std::string& path) { return Quarter{vehicle::read_quarter_vehicle(path)}; }, "path"_a)
      .def_prop_ro("name", [](const Quarter& q) { return q.name; })
      .def_prop_ro(
          "radius", [](const Quarter& q) { return q.wheel.front().radius; }, "Without lugs [m].")
      .def_prop_ro(
          "width", [](const Quarter& q) { return q.wheel.front().width; }, "[m]")
      .def_prop_ro(
          "lug_height", [](const Quarter& q) { return q.wheel.front().lug_height; }, "[m]")
      .def_prop_ro(
          "max_torque", [](const Quarter& q) { return vehicle::largest_drive_torque(q); }, "At the wheel [N m].");
}

}  // namespace gonogo::python

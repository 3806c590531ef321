// Bodies on bodies of triangles: they carry their weight, stick, slide, roll and climb as statics and friction say.
#include <cmath>
#include <string>

#include "sim/shape/meshes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// A box, or the mesh of one with so many squares along a side.
BodyIndex add_block(SceneWorld& w, const Vec3d& at, const Vec3& half, double mass, int cells) {
  const BodyIndex b = add_box(w, {at, {}, {}, {}}, half, mass);
  if (cells > 0) {
    w.shape.back().type = ShapeType::mesh;
    w.shape.back().surface = w.add_mesh(box_mesh(half, cells));
  }
  return b;
}

void fix(SceneWorld& w, BodyIndex b) { w.mass[b] = fixed_body(); }

/// Squares along a side of the lower and the upper block; 0: a box.
struct Pair {
  int low, top;
};
constexpr Pair kPairs[] = {{1, 0}, {6, 0}, {0, 1}, {0, 4}, {1, 1}, {3, 4}};

std::string described(const Pair& p, Backend backend) {
  const auto one = [](int cells) { return cells == 0 ? std::string("box") : "mesh " + std::to_string(cells); };
  return one(p.top) + " on " + one(p.low) + ", " + name_of(backend);
}

Shape lugged_wheel() {
  Shape s;
  s.type = ShapeType::wheel;
  s.size = {0.3f, 0.1f, 0.03f};
  s.lug_count = 12;
  s.lug_thickness = 0.04f;
  return s;
}

}  // namespace

TEST_CASE(
    "a block on a fixed one carries its weight, sticks below tan(angle) = mu and slides above, triangles or not") {
  const double mu = 0.5, mass = 3, weight = mass * kGravity;
  const Vec3 half{0.1f, 0.08f, 0.06f};
  for (const Backend backend : backends())
    for (const Pair& p : kPairs)
      for (const double share : {0.0, 0.97, 1.2}) {
        const double angle = std::atan(share * mu);
        SceneWorld w = open_world({Real(mu)});
        w.gravity = tilted_gravity(angle);
        fix(w, add_block(w, {0, 0, -0.2}, {1, 0.5f, 0.2f}, 1, p.low));
        const BodyIndex b = add_block(w, {0.013, 0.021, half.z}, half, mass, p.top);
        const auto simulation = simulate(backend, w, settings_with(80));
        advance_for(*simulation, 0.4);
        const BodyState s = simulation->body(0, b);
        const std::string label = described(p, backend) + ", tan / mu " + short_text(share);
        const double speed = share > 1 ? -kGravity * (std::sin(angle) - mu * std::cos(angle)) * 0.4 : 0;
        CHECK(agrees(label + ": speed [m/s]", speed, s.velocity.x, 4e-3 * kGravity * 0.4 * std::sin(angle) + 1e-4));
        CHECK(
            agrees(label + ": load [N]", weight * std::cos(angle), -simulation->contact_force(0, 0).z, 0.01 * weight));
        CHECK(std::abs(s.position.z - half.z) < 1e-3);
        CHECK(std::abs(s.velocity.y) < 1e-3);
        CHECK(length(s.angular_velocity) < 0.05);
      }
}

TEST_CASE("a tower of five mesh blocks turned against each other stands, and each floor carries what is above it") {
  const Vec3 half{0.1f, 0.1f, 0.05f};
  const double mass = 2;
  for (const Backend backend : backends()) {
    SceneWorld w = open_world({Real(0.5)});
    fix(w, add_block(w, {0, 0, -0.05}, half, 1, 2));
    for (int k = 0; k < 5; ++k) {
      const BodyIndex b = add_block(w, {0.01 * k, -0.005 * k, 0.05 + 0.1 * k}, half, mass, 1 + k % 3);
      const double yaw = 0.2 * k;
      w.body[b].orientation = {Real(std::cos(yaw / 2)), 0, 0, Real(std::sin(yaw / 2))};
    }
    const auto simulation = simulate(backend, w, settings_with(150));
    advance_for(*simulation, 1);
    CHECK(agrees(std::string("tower of meshes: load of the ground [N], ") + name_of(backend), 5 * mass * kGravity,
                 -simulation->contact_force(0, 0).z, 0.01 * 5 * mass * kGravity));
    double moved = 0;
    for (BodyIndex b = 1; b < 6; ++b)
      moved = std::max(moved, length(simulation->body(0, b).position - w.body[b].position));
    CHECK(agrees(std::string("tower of meshes: furthest that a block moved in 1 s [m], ") + name_of(backend), 0, moved,
                 1e-3));
  }
}

TEST_CASE("an upright cylinder or wheel stands on mesh blocks larger and smaller than its cap, and half over an edge") {
  const double mass = 4, weight = mass * kGravity;
  struct Place {
    double half, x;
  };
  for (const Backend backend : backends())
    for (const bool lugs : {false, true})
      for (const Place& p : {Place{0.5, 0}, Place{0.05, 0.01}, Place{0.5, 0.45}}) {
        SceneWorld w = open_world({Real(0.5)});
        fix(w, add_block(w, {0, 0, -0.1}, {Real(p.half), Real(p.half), 0.1f}, 1, 4));
        Shape s = lugged_wheel();
        s.type = lugs ? ShapeType::wheel : ShapeType::cylinder;
        s.size = {0.1f, 0.05f, 0.02f};
        s.body = w.add_body({{p.x, 0.003, 0.05}, about_x(kPi / 2), {}, {}}, solid(Real(mass), {0.02f, 0.03f, 0.02f}));
        w.add_shape(s);
        const auto simulation = simulate(backend, w, settings_with(100));
        advance_for(*simulation, 0.5);
        const BodyState end = simulation->body(0, s.body);
        const std::string label = std::string(lugs ? "wheel" : "cylinder") + " on its cap, block of " +
                                  short_text(2 * p.half) + " m, " + name_of(backend);
        CHECK(agrees(label + ": load [N]", weight, -simulation->contact_force(0, 0).z, 0.01 * weight));
        CHECK(agrees(label + ": moved [m]", 0, length(end.position - w.body[s.body].position), 1e-4));
        CHECK(length(end.angular_velocity) < 1e-3);
      }
}

TEST_CASE("a lugged wheel and a tyre of triangles roll over mesh ground as the wheel over a plane") {
  for (const Backend backend : backends()) {
    double travelled[3], load[3];
    for (const int way : {0, 1, 2}) {  // wheel on a plane, wheel on a mesh, tyre on a mesh
      SceneWorld w = open_world({Real(0.8)});
      if (way == 0) {
        add_plane(w);
      } else {
        Shape ground;
        ground.type = ShapeType::mesh;
        ground.surface = w.add_mesh(floor_mesh(3, 31));
        ground.body = w.add_body({}, fixed_body());
        w.add_shape(ground);
      }
      Shape wheel = lugged_wheel();
      if (way == 2) {
        wheel.surface = w.add_mesh(tyre_mesh(wheel, 4));
        wheel.type = ShapeType::mesh;
      }
      BodyMass m = solid(20, {0.6f, 1, 0.6f});
      m.inverse_inertia_B.x = m.inverse_inertia_B.z = 0;  // upright
      wheel.body = w.add_body({{-1, 0, 0.331}, {}, {2, 0, 0}, {0, Real(2 / 0.33), 0}}, m);
      w.add_shape(wheel);
      const auto simulation = simulate(backend, w, settings_with(60));
      double sum = 0;
      for (int i = 0; i < 400; ++i) {
        simulation->advance(1);
        sum -= simulation->contact_force(0, 0).z / 400;
      }
      const BodyState s = simulation->body(0, 1);
      travelled[way] = s.position.x + 1;
      load[way] = sum;
      CHECK(std::abs(s.position.y) < 1e-3);
      CHECK(simulation->report(0).flags == 0);
    }
    const char* name[] = {"", "lugged wheel on a mesh", "tyre on a mesh"};
    for (const int way : {1, 2}) {
      const std::string label = std::string(name[way]) + " compared with a plane, " + name_of(backend);
      CHECK(agrees(label + ": way [m]", travelled[0], travelled[way], 1e-3 * travelled[0]));
      CHECK(agrees(label + ": mean load [N]", load[0], load[way], 5e-3 * load[0]));
    }
  }
}

TEST_CASE(
    "a smooth wheel or tyre climbs a step of triangles when pulled by more than W tan(angle to the edge), not below") {
  const double radius = 0.3, step = 0.06, lift = std::sqrt(radius * radius - (radius - step) * (radius - step));
  const double threshold = lift / (radius - step);  // pull over weight: moments about the edge
  for (const Backend backend : backends())
    for (const ShapeType type : {ShapeType::cylinder, ShapeType::wheel, ShapeType::mesh})
      for (const double share : {0.96, 1.04}) {
        SceneWorld w = open_world({Real(0)});
        w.gravity = {Real(share * threshold * kGravity), 0, Real(-kGravity)};
        fix(w, add_block(w, {-1, 0, -0.1}, {1, 1, 0.1f}, 1, 3));
        fix(w, add_block(w, {1, 0, -0.1 + step}, {1, 1, 0.1f}, 1, 7));
        Shape s;
        s.type = type;
        s.size = {Real(radius), 0.1f, 0};
        if (type == ShapeType::mesh) s.surface = w.add_mesh(cylinder_mesh(s.size.x, s.size.y, 128));
        s.body = w.add_body({{-lift - 1e-4, 0.03, radius}, {}, {}, {}}, solid(10, {0.3f, 0.5f, 0.3f}));
        w.add_shape(s);
        const auto simulation = simulate(backend, w, settings_with(100));
        advance_for(*simulation, 0.4);
        const BodyState end = simulation->body(0, s.body);
        INFO(name_of(backend) << " type " << int(type) << " share " << share << ": " << end.position.x << ", "
                              << end.position.z);
        if (share < 1) CHECK(std::abs(end.position.z - radius) < 1e-3);
        if (share > 1) CHECK(end.position.z > radius + 0.01);
        CHECK(std::abs(end.position.y - 0.03) < 1e-3);
        // The polygon of the mesh turns on its corners; nothing else turns, and nothing leans.
        if (type != ShapeType::mesh) CHECK(std::abs(end.angular_velocity.y) < 0.02);
        CHECK(std::hypot(end.angular_velocity.x, end.angular_velocity.z) < 0.02);
      }
}

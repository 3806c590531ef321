// Ground of triangles acts as the smooth ground it stands for: the same motion, the same forces, no bumps.
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

Heightfield level_field(Index nx, Index ny, double spacing, double slope = 0) {
  Heightfield f;
  f.name = "level";
  f.nx = nx;
  f.ny = ny;
  f.spacing_x = f.spacing_y = Real(spacing);
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) f.height.push_back(Real(slope * spacing * (i - 0.5 * (nx - 1))));
  return f;
}

enum class Ground { plane, quad, mesh, field };
constexpr const char* kGround[] = {"plane", "mesh of two triangles", "mesh of many triangles", "heightfield"};

/// Level ground through the origin, as body 0.
void add_ground(SceneWorld& w, Ground kind) {
  if (kind == Ground::plane) {
    add_plane(w);
    return;
  }
  Shape s;
  s.body = w.add_body({}, fixed_body());
  s.type = kind == Ground::field ? ShapeType::heightfield : ShapeType::mesh;
  s.surface = kind == Ground::field ? w.add_heightfield(level_field(61, 71, 0.0613))
                                    : w.add_mesh(floor_mesh(2, kind == Ground::quad ? 1 : 57));
  w.add_shape(s);
}

BodyIndex add_shape(SceneWorld& w, ShapeType type, const Vec3& size, const BodyState& state, double mass) {
  Shape s;
  s.type = type;
  s.size = size;
  s.body = w.add_body(state, solid(Real(mass), {Real(mass * 0.02), Real(mass * 0.03), Real(mass * 0.025)}));
  w.add_shape(s);
  return s.body;
}

/// What the ground feels in every step of a body that slides or rolls over it, and where the body ends.
struct Ride {
  std::vector<double> force;    // [N]
  std::vector<Index> contacts;  // that the body has
  BodyState end;
};

Ride ride(Backend backend, const SceneWorld& w, int steps) {
  const auto simulation = simulate(backend, w, settings_with(60));
  Ride r;
  for (int i = 0; i < steps; ++i) {
    simulation->advance(1);
    r.force.push_back(-simulation->contact_force(0, 0).z);
    r.contacts.push_back(simulation->report(0).contact_count);
  }
  r.end = simulation->body(0, 1);
  CHECK(simulation->report(0).flags == 0);
  return r;
}

}  // namespace

TEST_CASE("a ball and a block that cross the edges of flat ground feel none of them") {
  const double mass = 3, weight = mass * kGravity;
  struct Case {
    const char* name;
    ShapeType type;
    Vec3 size;
    double height;
  };
  const Case cases[] = {{"rolling ball", ShapeType::sphere, {0.06f, 0, 0}, 0.06},
                        {"sliding capsule", ShapeType::capsule, {0.05f, 0.12f, 0}, 0.05},
                        {"sliding box", ShapeType::box, {0.1f, 0.07f, 0.05f}, 0.05},
                        {"sliding ellipsoid", ShapeType::ellipsoid, {0.09f, 0.12f, 0.05f}, 0.05},
                        {"sliding cylinder", ShapeType::cylinder, {0.05f, 0.12f, 0}, 0.05}};
  for (const Backend backend : backends())
    for (const Case& c : cases) {
      Ride on[4];
      for (const Ground ground : {Ground::plane, Ground::quad, Ground::mesh, Ground::field}) {
        SceneWorld w = open_world({Real(0.2), 0.02f});
        add_ground(w, ground);
        // Capsule and cylinder along y are pushed along their axis, so that they slide.
        const bool rolls = c.type == ShapeType::sphere || c.type == ShapeType::box;
        const Vec3 push = rolls ? Vec3{1.1f, 0.37f, 0} : Vec3{0, 1.1f, 0};
        add_shape(w, c.type, c.size, {{-0.51, -0.43, c.height}, {}, push, {}}, mass);
        Ride& r = on[int(ground)] = ride(backend, w, 300);
        if (ground == Ground::plane) continue;
        const std::string label = std::string(c.name) + " on a " + kGround[int(ground)] + ", " + name_of(backend);
        double bump = 0;
        for (std::size_t i = 0; i < r.force.size(); ++i) bump = std::max(bump, std::abs(r.force[i] - on[0].force[i]));
        CHECK(agrees(label + ": largest difference of the load from a plane's [N]", 0, bump, 1e-2 * weight));
        CHECK(agrees(label + ": place compared with a plane's [m]", 0, length(r.end.position - on[0].end.position),
                     1e-5));
        CHECK(r.contacts == on[0].contacts);  // inner edges add none
        CHECK(agrees(label + ": load at the end [N]", weight, r.force.back(), 0.02 * weight));
      }
    }
}

TEST_CASE("a box made of triangles slides, rests and carries as the box") {
  const double mu = 0.3, angle = 0.5, mass = 2;
  const Vec3 half{0.1f, 0.08f, 0.06f};
  for (const Backend backend : backends()) {
    double speed[2];
    for (const bool mesh : {false, true}) {
      SceneWorld w = open_world({Real(mu), 0.02f});
      w.set_law(0, 0, {Real(mu), 0, 0});
      w.gravity = tilted_gravity(angle);
      add_plane(w);
      const BodyIndex b = add_box(w, {{0, 0, half.z}, {}, {}, {}}, half, mass);
      if (mesh) {
        w.shape.back().type = ShapeType::mesh;
        w.shape.back().surface = w.add_mesh(box_mesh(half));
      }
      const auto simulation = simulate(backend, w, settings_with(80));
      advance_for(*simulation, 0.5);
      speed[mesh] = simulation->body(0, b).velocity.x;
    }
    const double expected = -kGravity * (std::sin(angle) - mu * std::cos(angle)) * 0.5;
    CHECK(agrees("mesh box on an incline, speed [m/s]", expected, speed[1], 3e-3 * std::abs(expected)));
    CHECK(agrees("mesh box compared with the box, speed [m/s]", speed[0], speed[1], 1e-5));
  }
}

TEST_CASE("balls dropped on a box made of triangles move as on the box") {
  for (const Backend backend : backends()) {
    std::vector<BodyState> end[2];
    for (const bool mesh : {false, true}) {
      SceneWorld w = open_world({Real(0.4), 0.02f});
      Shape s;
      s.type = mesh ? ShapeType::mesh : ShapeType::box;
      s.size = {0.5f, 0.4f, 0.3f};
      if (mesh) s.surface = w.add_mesh(box_mesh(s.size, 4));
      s.body = w.add_body({{0, 0, -0.3}, {}, {}, {}}, fixed_body());
      w.add_shape(s);
      for (int i = 0; i < 5; ++i)  // on the face, near its rim, over the edge and the corner
        w.add_sphere({0.11 * i + 0.04, 0.1 * i - 0.02, 0.055 + 0.002 * i}, 0.05f, 2000, 0);
      const auto simulation = simulate(backend, w, settings_with(60));
      advance_for(*simulation, 0.25);
      end[mesh] = simulation->bodies(0);
    }
    double apart = 0;
    for (std::size_t b = 0; b < end[0].size(); ++b)
      apart = std::max(apart, length(end[0][b].position - end[1][b].position));
    CHECK(agrees("balls on a mesh box compared with the box [m]", 0, apart, 1e-4));
  }
}

TEST_CASE("a ball in a corner of mesh walls is held by the forces of plane walls") {
  for (const Backend backend : backends()) {
    Vec3d force[2][3];
    for (const bool mesh : {false, true}) {
      SceneWorld w = open_world({Real(0.0), 0.02f});
      w.gravity = {-3, -2, Real(-kGravity)};
      // Walls facing +x, +y, +z: planes turned so that their z axis is the normal.
      const Quat turn[3] = {about_y(kPi / 2), about_x(-kPi / 2), {}};
      for (const Quat& q : turn) {
        if (!mesh) {
          add_plane(w, {}, q);
          continue;
        }
        Shape s;
        s.type = ShapeType::mesh;
        s.surface = w.mesh.empty() ? w.add_mesh(floor_mesh(1, 9)) : 0;
        s.body = w.add_body({{}, q, {}, {}}, fixed_body());
        w.add_shape(s);
      }
      w.add_sphere({0.1, 0.1, 0.1}, 0.1f, 1000, 0);
      const auto simulation = simulate(backend, w, settings_with(100));
      simulation->advance(200);
      for (BodyIndex b = 0; b < 3; ++b) force[mesh][b] = simulation->contact_force(0, b);
    }
    for (int b = 0; b < 3; ++b)
      CHECK(agrees("wall of a corner, difference of the force [N]", 0, length(force[0][b] - force[1][b]), 1e-3));
  }
}

TEST_CASE("bodies stay and slide on a slope of a heightfield as on a tilted plane") {
  const double slope = 0.4, angle = std::atan(slope), mass = 5;
  const Quat tilt = about_y(-angle);
  const Vec3d up{-std::sin(angle), 0, std::cos(angle)};
  struct Case {
    const char* name;
    ShapeType type;
    Vec3 size;
    Quat q;
    double height;
  };
  const Case cases[] = {{"ball", ShapeType::sphere, {0.1f, 0, 0}, {}, 0.1},
                        {"box", ShapeType::box, {0.2f, 0.15f, 0.1f}, tilt, 0.1},
                        {"capsule", ShapeType::capsule, {0.1f, 0.2f, 0}, {}, 0.1},
                        {"wheel", ShapeType::wheel, {0.3f, 0.1f, 0}, {}, 0.3}};
  for (const Backend backend : backends())
    for (const Case& c : cases)
      for (const double mu : {0.2, 0.8}) {
        double along[2];
        for (const bool field : {false, true}) {
          SceneWorld w = open_world({Real(mu), 0.02f});
          w.set_law(0, 0, {Real(mu), 0, 0});
          if (field) {
            Shape s;
            s.type = ShapeType::heightfield;
            s.surface = w.add_heightfield(level_field(81, 41, 0.05, slope));
            s.body = w.add_body({}, fixed_body());
            w.add_shape(s);
          } else {
            add_plane(w, {}, tilt);
          }
          add_shape(w, c.type, c.size, {up * c.height, c.q, {}, {}}, mass);
          const auto simulation = simulate(backend, w, settings_with(80));
          advance_for(*simulation, 0.4);
          const BodyState s = simulation->body(0, 1);
          CHECK(std::abs(dot(s.position, up) - c.height) < 1e-3);
          along[field] = dot(static_cast<Vec3d>(s.velocity), {std::cos(angle), 0, std::sin(angle)});
        }
        CHECK(agrees(std::string(c.name) + " on a slope, mu " + short_text(mu) + ": speed compared with a plane [m/s]",
                     along[0], along[1], 2e-3));
      }
}

TEST_CASE("a wheel straddling a ridge of a heightfield stands on the ridge") {
  for (const Backend backend : backends()) {
    SceneWorld w = open_world({Real(0.8), 0.02f});
    w.set_law(0, 0, {Real(0.8), 0, 0});
    Heightfield f = level_field(21, 11, 0.2);
    for (Index i = 0; i < f.nx; ++i) f.height[5 * f.nx + i] = 0.1f;  // a ridge along x, at y = 0
    Shape s;
    s.type = ShapeType::heightfield;
    s.surface = w.add_heightfield(f);
    s.body = w.add_body({}, fixed_body());
    w.add_shape(s);
    BodyMass m = solid(20, {1, 1, 1});
    m.inverse_inertia_B = {};  // on rails: it would fall to one side
    m.inverse_mass.x = m.inverse_mass.y = 0;
    Shape wheel;
    wheel.type = ShapeType::wheel;
    wheel.size = {0.3f, 0.1f, 0};
    wheel.body = w.add_body({{0.03, 0, 0.41}, {}, {}, {}}, m);
    w.add_shape(wheel);
    const auto simulation = simulate(backend, w, settings_with(80));
    advance_for(*simulation, 0.5);
    CHECK(agrees("wheel on a ridge, height [m]", 0.4, simulation->body(0, 1).position.z, 1e-3));
    CHECK(agrees("wheel on a ridge, load [N]", 20 * kGravity, simulation->contact_force(0, 1).z, 0.01 * 20 * kGravity));
  }
}

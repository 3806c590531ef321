#include "pipeline/lab/scenes/silo.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/units.h"
#include "pipeline/lab/scenes/silo_stress.h"
#include "sim/shape/mesh_shapes.h"

namespace gonogo::lab {
namespace {

constexpr double kPacked = 0.6;  // solid fraction of the fill, about
constexpr int kSegments = 48;

/// Bodies of the scene behind the spheres, in this order.
struct Parts {
  sim::BodyIndex wall, floor, plug, ground;
};

double wall_thickness(const SiloSpec& spec) { return 3 * spec.of.diameter; }
double depth_below(const SiloSpec& spec) { return 40 * spec.of.diameter; }

std::vector<Sphere> loose_fill(const SiloSpec& spec) {
  const double inside = spec.radius() * std::cos(kPi / kSegments) - spec.of.largest_diameter() / 2;
  const auto across = Index(std::ceil(2 * spec.radius() / spec.of.pitch()));
  const double corner = -across * spec.of.pitch() / 2;
  const auto layers = Index(spec.of.count);  // more than enough; the lattice ends with the last sphere
  return loose_lattice(
      spec.of, {corner, corner, 0}, across, across, std::min<Index>(layers, 4 * spec.of.count / (across * across) + 8),
      [&](const Vec3d& p) { return p.x * p.x + p.y * p.y < inside * inside; }, std::size_t(spec.of.count));
}

sim::BodyIndex add_mesh_body(sim::SceneWorld& world, sim::TriangleMesh mesh) {
  sim::Shape s;
  s.type = sim::ShapeType::mesh;
  s.surface = world.add_mesh(std::move(mesh));
  s.body = world.add_body({}, sim::fixed_body());
  s.group = 1;
  world.add_shape(s);
  return s.body;
}

Parts add_silo(sim::SceneWorld& world, const SiloSpec& spec, double height) {
  const auto r = Real(spec.radius()), hole = Real(spec.orifice_radius()), t = Real(wall_thickness(spec));
  Parts parts{};
  parts.wall = add_mesh_body(
      world, sim::revolved_mesh({{r, 0}, {r + t, 0}, {r + t, Real(height)}, {r, Real(height)}}, kSegments));
  parts.floor = add_mesh_body(world, sim::revolved_mesh({{hole, -t}, {r + t, -t}, {r + t, 0}, {hole, 0}}, kSegments));
  sim::Shape plug;
  plug.type = sim::ShapeType::cylinder;
  plug.size = {hole * Real(std::cos(kPi / kSegments)), t / 2, 0};
  plug.turn_B = towards(1, 1);  // its axis, y, along z
  plug.group = 1;
  plug.body = world.add_body({{0, 0, -double(t) / 2}, {}, {}, {}}, sim::fixed_body());
  world.add_shape(plug);
  parts.plug = plug.body;
  parts.ground = world.add_body({}, sim::fixed_body());
  add_plane(world, parts.ground, {0, 0, -depth_below(spec)}, {});
  world.shape.back().group = 1;
  return parts;
}

/// What a run of the silo remembers from drive to drive.
struct Flow {
  bool pulled = false, open = false;
  double floor_force = 0, looks = 0;     // sum over looks before the hole is opened [N]
  double fill_over_width = 0;            // when it is
  WallStress stress;                     // of the same looks
  double first_time = 0, last_time = 0;  // between which the flow is taken [s]
  double first_mass = 0, last_mass = 0;  // that has left by then [kg]
};

double mass_below(const sim::SceneWorld& world, Index spheres, const std::vector<sim::BodyState>& bodies, double z) {
  double mass = 0;
  for (Index b = 0; b < spheres; ++b)
    if (bodies[b].position.z < z) mass += 1 / double(world.mass[b].inverse_mass.x);
  return mass;
}

/// The wall is drawn upward for so long before the opening, at so many diameters a second; over the second half of
/// this its friction has built up as far as it does, and the sums are taken.
constexpr double kPull = 2, kPullSpeed = 0.1;  // [s], [1/s]

/// Upward at a speed [m/s].
void move_wall(sim::Simulation& simulation, sim::BodyIndex wall, double speed) {
  sim::BodyState state = simulation.body(0, wall);
  state.velocity.z = Real(speed);
  simulation.set_body(0, wall, state);
}

/// Twice the height of the centre of mass.
double fill_height(const sim::SceneWorld& world, Index spheres, const std::vector<sim::BodyState>& bodies) {
  double mass = 0, moment = 0;
  for (Index b = 0; b < spheres; ++b) {
    const double m = 1 / double(world.mass[b].inverse_mass.x);
    mass += m;
    moment += m * bodies[b].position.z;
  }
  return 2 * moment / mass;
}

}  // namespace

/// The fill's height is `slenderness` times the diameter: N pi d^3 / 6 = packed pi r^2 (2 r slenderness).
double SiloSpec::radius() const { return of.diameter * std::cbrt(double(of.count) / (12 * kPacked * slenderness)); }

double SiloSpec::orifice_radius() const {
  return orifice_diameters > 0 ? orifice_diameters * of.diameter / 2 : radius() / 3;
}

ManyScene silo_scene(const SiloSpec& spec, const RunOn& on) {
  const std::vector<Sphere> fill = loose_fill(spec);
  const double height = height_of(fill);
  ManyScene scene;
  scene.name = "silo";
  scene.settings = many_step_settings(spec.of, on.iterations, on.solver);
  sim::SceneWorld& world = scene.world;
  const double half = spec.radius() + wall_thickness(spec), below = depth_below(spec) + spec.of.diameter;
  world.origin = {-half, -half, -below};
  world.size = {2 * half, 2 * half, height + below};
  world.set_law(0, 0, {Real(spec.of.friction), 0, 0});
  for (const Sphere& s : fill) world.add_sphere(s.centre, Real(s.radius), Real(spec.of.density), 0);
  const auto spheres = Index(fill.size());
  const Parts parts = add_silo(world, spec, height);
  const double pulled = 3 * fall_time(height / 3), opens = pulled + kPull, ends = opens + spec.flow_time;
  scene.duration = ends;
  const auto flow = std::make_shared<Flow>();
  const auto kept = std::make_shared<const sim::SceneWorld>(world);
  const double mouth = -wall_thickness(spec), weight = kGravity * mass_below(world, spheres, world.body, 1e30);
  scene.drive = [=](sim::Simulation& simulation, double time) {
    if (time < opens) {
      if (time < pulled) return;
      if (!flow->pulled) {
        move_wall(simulation, parts.wall, kPullSpeed * spec.of.diameter);
        simulation.set_law(0, 0, 0, {Real(spec.of.friction), Real(spec.rolling_friction), 0});
        flow->pulled = true;
      }
      if (time < pulled + kPull / 2) return;
      flow->floor_force -= simulation.contact_force(0, parts.floor).z + simulation.contact_force(0, parts.plug).z;
      flow->stress.add(sim::capture_world(simulation, 0), *kept, spheres, parts.wall, simulation.settings().step);
      ++flow->looks;
      return;
    }
    if (!flow->open) {
      flow->fill_over_width = fill_height(*kept, spheres, simulation.bodies(0)) / (2 * spec.radius());
      move_wall(simulation, parts.wall, 0);
      sim::BodyState away = simulation.body(0, parts.plug);
      away.position.z = -depth_below(spec) - 1;
      simulation.set_body(0, parts.plug, away);
      flow->open = true;
    }
    if (time < opens + spec.flow_time / 4 || time > ends) return;
    const double mass = mass_below(*kept, spheres, simulation.bodies(0), mouth);
    if (flow->first_time == 0) flow->first_time = time, flow->first_mass = mass;
    flow->last_time = time, flow->last_mass = mass;
  };
  scene.measure = [=](sim::Simulation&) -> std::vector<Measured> {
    const double time = flow->last_time - flow->first_time;
    return {{"floor_share_of_weight", flow->floor_force / flow->looks / weight},
            {"fill_over_width", flow->fill_over_width},
            {"wall_friction_mobilised", flow->stress.mobilised(spec.of.friction)},
            {"wall_stress_ratio", flow->stress.ratio(2 * spec.radius())},
            {"flow_kg_per_s", time > 0 ? (flow->last_mass - flow->first_mass) / time : 0},
            {"left_share", flow->last_mass / (weight / kGravity)}};
  };
  scene.watch_every = 0.05;
  scene.watch = [=](sim::Simulation& simulation, double time) -> std::vector<Measured> {
    WallStress now;
    now.add(sim::capture_world(simulation, 0), *kept, spheres, parts.wall, simulation.settings().step);
    const double floor = simulation.contact_force(0, parts.floor).z + simulation.contact_force(0, parts.plug).z;
    return {{"time_s", time},
            {"floor_share_of_weight", -floor / weight},
            {"wall_friction_mobilised", now.normal > 0 ? now.mobilised(spec.of.friction) : 0},
            {"wall_stress_ratio", now.ratio(2 * spec.radius())}};
  };
  return scene;
}

}  // namespace gonogo::lab

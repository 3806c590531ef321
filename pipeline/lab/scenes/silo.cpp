#include "pipeline/lab/scenes/silo.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/units.h"
#include "sim/shape/meshes.h"

namespace gonogo::lab {

void WallStress::add(const sim::Capture& state, const sim::SceneWorld& world, Index spheres, sim::BodyIndex wall,
                     double step) {
  for (const sim::CapturedContact& c : state.contact) {
    if (c.a != wall && c.b != wall) continue;
    const Vec3d force = static_cast<Vec3d>(c.impulse) * ((c.a == wall ? -1 : 1) / step);  // on the sphere
    const Vec3d inward = static_cast<Vec3d>(c.normal) * (c.a == wall ? -1.0 : 1.0);
    normal += dot(force, inward);
    shear += force.z;
    shear_moment += force.z * c.point.z;
  }
  for (Index b = 0; b < spheres; ++b)
    weight_moment += kGravity / double(world.mass[b].inverse_mass.x) * state.body[b].position.z;
}

namespace {

/// Bodies of the scene behind the spheres, in this order.
struct Parts {
  sim::BodyIndex wall, floor, plug, ground;
};

double wall_thickness(const SiloSpec& spec) { return 3 * spec.of.diameter; }
double depth_below(const SiloSpec& spec) { return 40 * spec.of.diameter; }

Parts add_silo(sim::SceneWorld& world, const SiloSpec& spec, double height) {
  const auto r = Real(spec.radius()), hole = Real(spec.orifice_radius()), t = Real(wall_thickness(spec));
  Parts parts{};
  parts.wall =
      add_wall(world, sim::revolved_mesh({{r, 0}, {r + t, 0}, {r + t, Real(height)}, {r, Real(height)}}, kSegments));
  parts.floor = add_wall(world, sim::revolved_mesh({{hole, -t}, {r + t, -t}, {r + t, 0}, {hole, 0}}, kSegments));
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

double mass_below(const sim::SceneWorld& world, Index spheres, const std::vector<sim::BodyState>& bodies, double z) {
  double mass = 0;
  for (Index b = 0; b < spheres; ++b)
    if (bodies[b].position.z < z) mass += 1 / double(world.mass[b].inverse_mass.x);
  return mass;
}

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

/// A run of the silo: what acts on it, and the sums that are taken meanwhile.
class SiloRun {
 public:
  SiloRun(const SiloSpec& spec, const sim::SceneWorld& world, const Parts& parts, double height)
      : spec_(spec),
        world_(world),
        parts_(parts),
        spheres_(parts.wall),
        weight_(kGravity * mass_below(world, spheres_, world.body, 1e30)) {
    pull_ = 3 * fall_time(height / 3);
    open_ = pull_ + kPullTime;
    end_ = open_ + spec.flow_time;
  }

  double end() const { return end_; }  // [s]

  void drive(sim::Simulation& simulation, double time) {
    enter_due_phase(simulation, time);
    if (phase_ == Phase::weigh) weigh(simulation);
    if (phase_ == Phase::gauge) gauge(simulation, time);
  }

  std::vector<SceneNumber> measures() const {
    const double time = last_.time - first_.time;
    return {{"floor_share_of_weight", floor_force_ / looks_ / weight_},
            {"fill_over_width", fill_over_width_},
            {"wall_friction_mobilised", stress_.mobilised(spec_.of.friction)},
            {"wall_stress_ratio", stress_.ratio(2 * spec_.radius())},
            {"flow_kg_per_s", time > 0 ? (last_.mass - first_.mass) / time : 0},
            {"left_share", last_.mass / (weight_ / kGravity)}};
  }

  std::vector<SceneNumber> watched(sim::Simulation& simulation, double time) const {
    WallStress now;
    add_stress(simulation, now);
    return {{"time_s", time},
            {"floor_share_of_weight", -floor_force_now(simulation) / weight_},
            {"wall_friction_mobilised", now.normal > 0 ? now.mobilised(spec_.of.friction) : 0},
            {"wall_stress_ratio", now.ratio(2 * spec_.radius())}};
  }

 private:
  /// In the order in which they follow each other.
  enum class Phase {
    settle,  // the lattice falls onto floor and plug
    pull,    // the wall is drawn upward, and its friction builds up
    weigh,   // as before, and forces on floor and wall are summed up
    flow,    // the wall stands, the plug is gone
    gauge,   // as before, and what has left is noted
    over
  };

  static constexpr double kPullTime = 2;     // of both phases in which the wall is drawn upward [s]
  static constexpr double kPullSpeed = 0.1;  // of the wall, in sphere diameters [1/s]

  /// Mass that has left the silo by a time.
  struct Left {
    double time = 0, mass = 0;  // [s], [kg]
  };

  Phase phase_at(double time) const {
    if (time < pull_) return Phase::settle;
    if (time < pull_ + kPullTime / 2) return Phase::pull;
    if (time < open_) return Phase::weigh;
    if (time < open_ + spec_.flow_time / 4) return Phase::flow;
    return time <= end_ ? Phase::gauge : Phase::over;
  }

  /// No phase is left out, however far apart two drives are.
  void enter_due_phase(sim::Simulation& simulation, double time) {
    while (phase_ < phase_at(time)) {
      phase_ = Phase(int(phase_) + 1);
      if (phase_ == Phase::pull) start_pull(simulation);
      if (phase_ == Phase::flow) open_silo(simulation);
    }
  }

  void start_pull(sim::Simulation& simulation) const {
    move_wall(simulation, parts_.wall, kPullSpeed * spec_.of.diameter);
    simulation.set_law(0, 0, 0, {Real(spec_.of.friction), Real(spec_.rolling_friction), 0});
  }

  void open_silo(sim::Simulation& simulation) {
    fill_over_width_ = fill_height(world_, spheres_, simulation.bodies(0)) / (2 * spec_.radius());
    move_wall(simulation, parts_.wall, 0);
    sim::BodyState away = simulation.body(0, parts_.plug);
    away.position.z = -depth_below(spec_) - 1;
    simulation.set_body(0, parts_.plug, away);
  }

  void weigh(sim::Simulation& simulation) {
    floor_force_ -= floor_force_now(simulation);
    add_stress(simulation, stress_);
    ++looks_;
  }

  void gauge(sim::Simulation& simulation, double time) {
    last_ = {time, mass_below(world_, spheres_, simulation.bodies(0), -wall_thickness(spec_))};
    if (first_.time == 0) first_ = last_;
  }

  /// Upward force of the spheres on floor and plug, negative [N].
  double floor_force_now(sim::Simulation& simulation) const {
    return simulation.contact_force(0, parts_.floor).z + simulation.contact_force(0, parts_.plug).z;
  }

  void add_stress(sim::Simulation& simulation, WallStress& stress) const {
    stress.add(sim::capture_world(simulation, 0), world_, spheres_, parts_.wall, simulation.settings().step);
  }

  SiloSpec spec_;
  sim::SceneWorld world_;
  Parts parts_;
  Index spheres_;                         // they are the bodies before the wall
  double weight_;                         // of all spheres [N]
  double pull_ = 0, open_ = 0, end_ = 0;  // beginnings of phases `pull`, `flow` and `over` [s]

  Phase phase_ = Phase::settle;
  double floor_force_ = 0, looks_ = 0;  // sum of downward forces [N] over this many looks
  WallStress stress_;                   // of the same looks
  double fill_over_width_ = 0;          // when the plug goes
  Left first_, last_;                   // of phase `gauge`
};

}  // namespace

/// The fill's height is `slenderness` times the diameter: N pi d^3 / 6 = packed pi r^2 (2 r slenderness).
double SiloSpec::radius() const { return of.diameter * std::cbrt(double(of.count) / (12 * kPacked * slenderness)); }

double SiloSpec::orifice_radius() const {
  return orifice_diameters > 0 ? orifice_diameters * of.diameter / 2 : radius() / 3;
}

ManyScene silo_scene(const SiloSpec& spec, const RunOn& on) {
  const std::vector<Sphere> fill = loose_column(spec.of, spec.radius());
  const double height = height_of(fill);
  ManyScene scene{.name = "silo", .settings = many_step_settings(spec.of, on.iterations, on.solver)};
  sim::SceneWorld& world = scene.world;
  const double half = spec.radius() + wall_thickness(spec), below = depth_below(spec) + spec.of.diameter;
  world.origin = {-half, -half, -below};
  world.size = {2 * half, 2 * half, height + below};
  world.set_law(0, 0, {Real(spec.of.friction), 0, 0});
  for (const Sphere& s : fill) world.add_sphere(s.centre, Real(s.radius), Real(spec.of.density), 0);
  const Parts parts = add_silo(world, spec, height);
  const auto run = std::make_shared<SiloRun>(spec, world, parts, height);
  scene.duration = run->end();
  scene.drive = [run](sim::Simulation& simulation, double time) { run->drive(simulation, time); };
  scene.measure = [run](sim::Simulation&) { return run->measures(); };
  scene.watch_every = 0.05;
  scene.watch = [run](sim::Simulation& simulation, double time) { return run->watched(simulation, time); };
  return scene;
}

}  // namespace gonogo::lab

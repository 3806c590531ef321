#include "vehicle/hard_ground/track_checks.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

constexpr double kPullTolerance = 0.02, kLoadTolerance = 0.01;  // relative
constexpr double kTorqueTolerance = 0.03;                       // relative; impacts and dampers take their part
constexpr double kPinDrift = 1e-4;                              // [m]

/// A tracked vehicle on a plane whose sprockets the check itself turns.
struct TrackRig {
  HardGround ground;
  std::unique_ptr<sim::Simulation> s;

  TrackRig(const Vehicle& v, double mu, double slope, const HardGroundRun& run, double step)
      : ground(without_driver(v, mu, slope)), s(start(ground, run, step)) {
    turn(0, 1e5);
  }

  static HardGround without_driver(const Vehicle& v, double mu, double slope) {
    HardGround g(v, {}, mu, slope);
    g.world.driveline.clear();
    return g;
  }

  /// Speed of both sprockets [rad/s] within a torque [N m].
  void turn(double speed, double torque) {
    for (const EngineTrack& t : ground.e.track) s->set_motor(0, t.drive_motor, Real(speed), Real(torque));
  }
  /// From rest to a speed within a second.
  void speed_up(double speed, double torque) {
    constexpr int parts = 20;
    for (int k = 1; k <= parts; ++k) {
      turn(speed * k / parts, torque);
      run_for(*s, 1.0 / parts);
    }
  }

  /// Force of the plane, the last body, on the vehicle [N].
  Vec3d plane_force() { return -1.0 * s->contact_force(0, sim::BodyIndex(ground.world.body.size()) - 1); }

  double torque() {
    double sum = 0;
    for (const EngineTrack& t : ground.e.track) sum += s->motor_torque(0, t.drive_motor);
    return sum;
  }
  double place() { return s->body(0, ground.e.chassis).position.x; }
};

/// How far pins have come apart [m].
double pin_drift(const sim::SceneWorld& world, const std::vector<sim::BodyState>& body, const EngineTrack& t) {
  double worst = 0;
  for (const Index pin : t.pin) {
    const sim::Joint& j = world.joint[std::size_t(pin)];
    const auto at = [&](const sim::Attachment& a) {
      const sim::BodyState& b = body[std::size_t(a.body)];
      return b.position + rotate_precisely(b.orientation, a.point_B);
    };
    worst = std::max(worst, length(at(j.a) - at(j.b)));
  }
  return worst;
}

/// What the belt pulls on its idler along the tensioner: by the two pins that are nearest to right over and under its
/// axle, between which nothing else but the idler touches the belt [N].
double belt_pull(TrackRig& rig, const EngineTrack& t, const Vec3d& travel) {
  const auto bodies = rig.s->bodies(0);
  const Vec3d axle = bodies[std::size_t(t.idler)].position;
  std::size_t over = 0, under = 0;
  double best[2] = {1e9, 1e9};
  const auto pin_at = [&](std::size_t k) {
    const sim::Attachment& a = rig.ground.world.joint[std::size_t(t.pin[k])].a;
    const sim::BodyState& b = bodies[std::size_t(a.body)];
    return b.position + rotate_precisely(b.orientation, a.point_B);
  };
  for (std::size_t k = 0; k < t.pin.size(); ++k) {
    const Vec3d from = pin_at(k) - axle;
    const bool is_over = from.z > 0;
    if (std::fabs(from.x) < best[is_over ? 0 : 1]) {
      best[is_over ? 0 : 1] = std::fabs(from.x);
      (is_over ? over : under) = k;
    }
  }
  // Pins are counted from the sprocket over the top backwards: the belt around the idler begins behind pin `over`.
  const Vec3d pull = rig.s->joint_load(0, t.pin[over]).force - rig.s->joint_load(0, t.pin[under]).force;
  return std::fabs(dot(pull, travel));
}

}  // namespace

HardGroundReport check_belts_at_rest(const Vehicle& vehicle, const HardGroundRun& run) {
  const Vehicle v = set_down(vehicle);
  const Track& t = *v.track;
  const Vec3d way = t.idler_travel - t.idler.centre, travel = way * (1 / length(way));
  TrackRig rig(v, 0.8, 0, run, 1e-3);
  HardGroundReport r{.name = "belts",
                     .title = v.name + ": belts at rest",
                     .x_label = "time [s]",
                     .y_label = "load of the ground over weight"};
  Trace load{"engine", {}, {}};
  constexpr int samples = 40;
  constexpr double time = 2, mean_over = 0.25;
  for (int k = 0; k < samples; ++k) {
    run_for(*rig.s, time / samples);
    load.add((k + 1) * time / samples, rig.plane_force().z / (weigh(v).total * kGravity));
  }
  double weight = 0, tensioner[2] = {}, pull[2] = {};
  constexpr int parts = 25;
  for (int k = 0; k < parts; ++k) {
    run_for(*rig.s, mean_over / parts);
    weight += rig.plane_force().z / parts;
    for (int side = 0; side < 2; ++side) {
      const EngineTrack& track = rig.ground.e.track[std::size_t(side)];
      tensioner[side] += std::fabs(dot(rig.s->spring_load(0, track.tensioner).force, travel)) / parts;
      pull[side] += belt_pull(rig, track, travel) / parts;
    }
  }
  const double expected = weigh(v).total * kGravity;
  r.expect("ground_load_N", "load on the ground: the weight [N]", expected, weight, kLoadTolerance * expected);
  for (int side = 0; side < 2; ++side) {
    const std::string name = side == 0 ? "left" : "right";
    r.expect("belt_tension_" + name + "_N", "both runs of the " + name + " belt pull what its tensioner pushes [N]",
             tensioner[side], pull[side], kPullTolerance * tensioner[side]);
    r.expect("pin_drift_" + name + "_m", "pins of the " + name + " belt come apart [m]", 0,
             pin_drift(rig.ground.world, rig.s->bodies(0), rig.ground.e.track[std::size_t(side)]), kPinDrift);
  }
  r.trace = {load};
  return r;
}

HardGroundReport check_track_speed(const Vehicle& vehicle, double sprocket_speed, const HardGroundRun& run) {
  const Vehicle v = set_down(vehicle);
  TrackRig rig(v, 0.8, 0, run, 1e-3);
  constexpr double settled = 0.5, torque = 1e5;
  run_for(*rig.s, settled);
  rig.speed_up(sprocket_speed, torque);
  run_for(*rig.s, 0.5);
  const double turn = 2 * kPi / sprocket_speed, from = rig.place();
  HardGroundReport r{.name = "track_speed",
                     .title = v.name + ": way over what the sprockets turn",
                     .x_label = "turns",
                     .y_label = "way [m]"};
  Trace engine{"engine", {}, {}}, closed{"teeth times pitch", {0, 2}, {0, 2 * 2 * kPi * rolling_radius(*v.track)}};
  double drift = 0;
  constexpr int parts = 20, turns = 2;
  for (int k = 0; k < turns * parts; ++k) {
    run_for(*rig.s, turn / parts);
    engine.add(double(k + 1) / parts, rig.place() - from);
    for (const EngineTrack& t : rig.ground.e.track)
      drift = std::max(drift, pin_drift(rig.ground.world, rig.s->bodies(0), t));
  }
  const double time = rig.s->settings().step * std::lround(turn / parts / rig.s->settings().step) * turns * parts;
  const double expected = rolling_radius(*v.track) * sprocket_speed * time;
  r.expect("track_way_m", "way of two turns of the sprockets: teeth times pitch [m]", expected, engine.y.back(),
           0.01 * expected);
  r.expect("pin_drift_driven_m", "pins come apart while it drives [m]", 0, drift, kPinDrift);
  r.trace = {closed, engine};
  return r;
}

HardGroundReport check_track_traction(const Vehicle& vehicle, double mu, const HardGroundRun& run) {
  const Vehicle v = set_down(vehicle);
  const double slope = std::atan(mu);
  TrackRig rig(v, mu, slope, run, 2e-3);
  constexpr double settled = 0.5, spin = 4, torque = 1e5, before = 0.5, time = 2;
  run_for(*rig.s, settled);
  rig.speed_up(spin, torque);
  run_for(*rig.s, before);
  const double speed = forward_speed(*rig.s, rig.ground);
  HardGroundReport r{.name = "track_traction",
                     .title = v.name + ": spinning belts on the slope that friction just allows",
                     .x_label = "time [s]",
                     .y_label = "speed [m/s]"};
  Trace trace{"engine", {}, {}};
  constexpr int samples = 40;
  for (int k = 0; k < samples; ++k) {
    run_for(*rig.s, time / samples);
    trace.add((k + 1) * time / samples, forward_speed(*rig.s, rig.ground));
  }
  const double gained = (forward_speed(*rig.s, rig.ground) - speed) / time;
  r.expect("track_gradeability", "steepest slope with spinning belts: tan = mu", mu,
           mu + gained / (kGravity * std::cos(slope)), kPullTolerance * mu);
  r.trace = {trace};
  return r;
}

HardGroundReport check_track_torque(const Vehicle& vehicle, double slope, const HardGroundRun& run) {
  const Vehicle v = set_down(vehicle);
  const Track& t = *v.track;
  constexpr double settled = 0.5, speed = 1.5, torque = 1e5;
  constexpr int teeth = 4, samples = 100;
  TrackRig rig(v, 0.9, slope, run, 1e-3);
  run_for(*rig.s, settled);
  rig.speed_up(speed, torque);
  HardGroundReport r{.name = "track_torque",
                     .title = v.name + ": the sprockets' torque and the ground's force, slowly uphill",
                     .x_label = "time [s]",
                     .y_label = "force [N]"};
  Trace ground{"ground", {}, {}}, sprockets{"torque over rolling radius", {}, {}};
  const double time = teeth * 2 * kPi / (sprocket_teeth(t) * speed);
  double by_ground = 0, by_torque = 0;
  for (int k = 0; k < samples; ++k) {
    run_for(*rig.s, time / samples);
    ground.add((k + 1) * time / samples, rig.plane_force().x);
    sprockets.add(ground.x.back(), rig.torque() / rolling_radius(t));
    by_ground += ground.y.back() / samples;
    by_torque += sprockets.y.back() / samples;
  }
  const double weight = weigh(v).total * kGravity * std::sin(slope);
  r.expect("track_force_N", "force of the ground, slowly uphill: the weight's share along the slope [N]", weight,
           by_ground, kPullTolerance * weight);
  r.expect("track_torque_N", "torque of the sprockets over their rolling radius: the same [N]", weight, by_torque,
           kTorqueTolerance * weight);
  r.trace = {ground, sprockets};
  return r;
}

}  // namespace gonogo::vehicle

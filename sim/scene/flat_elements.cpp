#include "sim/scene/flat_elements.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace gonogo::sim {
namespace {

/// Refuses one element of one world by name.
class Refusal {
 public:
  Refusal(std::size_t world, const char* kind, std::size_t index)
      : place_("world " + std::to_string(world) + ": " + kind + " " + std::to_string(index) + " ") {}
  void unless(bool good, const std::string& what) const {
    if (!good) throw InputError(place_ + what);
  }

 private:
  std::string place_;
};

bool is_positive(double x) { return x > 0 && std::isfinite(x); }
bool is_not_negative(double x) { return x >= 0 && std::isfinite(x); }
bool exists(const SceneWorld& world, BodyIndex b) { return b >= 0 && b < BodyIndex(world.body.size()); }

std::string bodies_of(const SceneWorld& world) { return std::to_string(world.body.size()) + " bodies of the world"; }

void check(const SceneWorld& world, const ForceElement& f, const Refusal& refuse) {
  refuse.unless(exists(world, f.body),
                "acts on body " + std::to_string(f.body) + ", not one of the " + bodies_of(world));
  refuse.unless(!is_fixed(world.mass[f.body]), "acts on a fixed body; name one that can move");
  refuse.unless(is_finite(f.point_B) && is_finite(f.force) && is_finite(f.torque) && is_finite(f.wind),
                "has a vector that is not finite");
  refuse.unless(is_not_negative(f.drag), "has a drag of " + std::to_string(f.drag) + " kg/m; it must be zero or more");
  refuse.unless(std::isfinite(f.start) && is_not_negative(f.ramp), "needs a ramp time of zero or more");
}

void check_table(const std::vector<TablePoint>& table, const char* name, double lowest, double highest,
                 const Refusal& refuse) {
  refuse.unless(!table.empty(), std::string("has no ") + name + " table; give it at least one point");
  for (std::size_t i = 0; i < table.size(); ++i) {
    refuse.unless(std::isfinite(table[i].at) && (i == 0 || table[i].at > table[i - 1].at),
                  std::string("has a ") + name + " table whose points are not in ascending order");
    refuse.unless(table[i].value >= lowest && table[i].value <= highest,
                  std::string("has a ") + name + " of " + std::to_string(table[i].value) + "; allowed are " +
                      std::to_string(lowest) + " to " + std::to_string(highest));
  }
}

void check(const SceneWorld& world, const Controller& c, const Refusal& refuse) {
  constexpr double max = 1e9;  // of any torque
  refuse.unless(c.motor >= 0 && c.motor < Index(world.motor.size()),
                "drives motor " + std::to_string(c.motor) + ", not one of the " + std::to_string(world.motor.size()) +
                    " motors of the world");
  refuse.unless(world.motor[c.motor].kind == MotorKind::speed,
                "drives motor " + std::to_string(c.motor) + ", a torque motor; controllers drive speed motors");
  const double command = command_limit(c.type);
  check_table(c.command, "command", -command, command, refuse);
  check_table(c.limit, "torque limit", 0, max, refuse);
  if (has_torque_curve(c.type)) refuse.unless(c.limit.front().at >= 0, "has a torque curve over negative speeds");
  if (c.type == ControllerType::throttle)
    refuse.unless(c.limit.back().at > 0, "has a torque curve without a speed that the motor does not exceed");
  if (!follows_body(c)) return;
  refuse.unless(exists(world, c.body),
                "follows body " + std::to_string(c.body) + ", not one of the " + bodies_of(world));
  refuse.unless(is_finite(c.axis) && length(c.axis) > 0, "has an axis without direction");
  refuse.unless(std::isfinite(c.proportional) && std::isfinite(c.integral) && std::isfinite(c.feed_forward),
                "has a gain that is not finite");
  if (c.type == ControllerType::velocity_by_speed || sets_angle(c.type))
    refuse.unless(is_positive(c.top_speed), "needs a top speed above zero");
  if (!sets_angle(c.type)) return;
  refuse.unless(c.frame == ReferenceFrame::body && world.motor[c.motor].b == c.body,
                "steers body " + std::to_string(c.body) + " by a motor that does not turn against it");
  refuse.unless(is_positive(c.rate) && is_positive(c.max_angle) && std::isfinite(c.look_ahead),
                "needs a rate and a largest angle above zero and a distance to look ahead");
  refuse.unless(is_finite(c.pointer_a) && length(c.pointer_a) > 0, "has a pointer without direction");
}

/// Motors of a driveline, each of which nobody else may set.
std::vector<Index> motors_of(const Driveline& d) {
  std::vector<Index> motors;
  for (Index a = 0; a < d.axle_count; ++a)
    for (const Index m : {d.axle[a].wheel[0], d.axle[a].wheel[1], d.axle[a].lock})
      if (m >= 0) motors.push_back(m);
  for (Index b = 0; b < d.brake_count; ++b) motors.push_back(d.brake[b].motor);
  return motors;
}

void check_tables(const Driveline& d, const Refusal& refuse) {
  constexpr double max = 1e9;
  check_table(d.torque, "torque", -max, max, refuse);
  check_table(d.throttle, "throttle", 0, 1, refuse);
  check_table(d.braking, "braking", 0, 1, refuse);
  if (!d.speed.empty()) check_table(d.speed, "speed", -max, max, refuse);
  if (d.coupling != Coupling::converter) return;
  check_table(d.torque_ratio, "torque ratio", 0, 10, refuse);
  check_table(d.capacity, "capacity", 0, max, refuse);
}

void check_axles(const Driveline& d, const Refusal& refuse) {
  double share = 0;
  for (Index a = 0; a < d.axle_count; ++a) {
    const DrivenAxle& axle = d.axle[a];
    refuse.unless(axle.wheel[0] >= 0, "has an axle without a wheel");
    refuse.unless(axle.lock < 0 || axle.wheel[1] >= 0, "has a differential between one wheel and none");
    refuse.unless(axle.bias >= 1 && std::isfinite(axle.bias), "has a torque bias below 1");
    refuse.unless(is_not_negative(axle.share), "has an axle whose share is below zero");
    share += axle.share;
  }
  refuse.unless(std::fabs(share - 1) < 1e-6,
                "gives its axles shares that add up to " + std::to_string(share) + "; they must add up to 1");
}

void check(const SceneWorld& world, const Driveline& d, const Refusal& refuse) {
  refuse.unless(d.axle_count >= 1 && d.axle_count <= kMaxDrivenAxles,
                "has " + std::to_string(d.axle_count) + " axles; allowed are 1 to " + std::to_string(kMaxDrivenAxles));
  refuse.unless(d.gear_count >= 1 && d.gear_count <= kMaxGears && d.first_gear >= 0 && d.first_gear < d.gear_count,
                "has " + std::to_string(d.gear_count) + " gears; allowed are 1 to " + std::to_string(kMaxGears) +
                    ", the first one among them");
  refuse.unless(d.brake_count >= 0 && d.brake_count <= kMaxBrakes,
                "has " + std::to_string(d.brake_count) + " brakes; the most is " + std::to_string(kMaxBrakes));
  for (Index g = 0; g < d.gear_count; ++g)
    refuse.unless(is_positive(d.ratio[g]) && (g == 0 || d.ratio[g] < d.ratio[g - 1]),
                  "has gears whose ratios do not fall from above zero");
  check_axles(d, refuse);
  check_tables(d, refuse);
  refuse.unless(d.coupling == Coupling::direct || (is_positive(d.engine_inertia) && is_not_negative(d.idle_speed)),
                "has a converter or clutch and needs an engine inertia above zero");
  refuse.unless(d.efficiency > 0 && d.efficiency <= 1, "has an efficiency that is not between 0 and 1");
  refuse.unless(exists(world, d.body),
                "follows body " + std::to_string(d.body) + ", not one of the " + bodies_of(world));
  for (const Index m : motors_of(d)) {
    refuse.unless(m >= 0 && m < Index(world.motor.size()), "drives motor " + std::to_string(m) + ", not one of the " +
                                                               std::to_string(world.motor.size()) +
                                                               " motors of the world");
    refuse.unless(world.motor[m].kind == MotorKind::speed,
                  "drives motor " + std::to_string(m) + ", a torque motor; drivelines drive speed motors");
  }
}

void check(const SceneWorld& world, const Monitor& m, double step, const Refusal& refuse) {
  refuse.unless(exists(world, m.body),
                "watches body " + std::to_string(m.body) + ", not one of the " + bodies_of(world));
  refuse.unless(m.motor >= -1 && m.motor < Index(world.motor.size()),
                "watches motor " + std::to_string(m.motor) + ", not one of the " + std::to_string(world.motor.size()) +
                    " motors of the world; -1 watches none");
  refuse.unless(m.stride >= 1, "has a stride of " + std::to_string(m.stride) + "; it must be at least one step");
  refuse.unless(is_positive(m.time_limit), "needs a time limit above zero");
  refuse.unless(is_not_negative(m.start) && is_not_negative(m.earliest) && is_not_negative(m.immobile_window) &&
                    is_not_negative(m.immobile_from) && std::isfinite(m.immobile_speed) && std::isfinite(m.height) &&
                    !std::isnan(m.distance) && m.slid_back >= 0,
                "has a time below zero or a threshold that is not a number");
  const double steps = (m.start + m.time_limit) / step;
  refuse.unless(steps < 1e9, "has a time limit of " + std::to_string(steps) + " steps; the most is 1e9");
}

Table append_table(const std::vector<TablePoint>& table, FlatElements& flat) {
  const Table range{Index(flat.table.size()), Index(table.size())};
  flat.table.insert(flat.table.end(), table.begin(), table.end());
  return range;
}

void flatten_forces(const SceneWorld& world, FlatElements& flat) {
  flat.force = world.force;
  std::stable_sort(flat.force.begin(), flat.force.end(),
                   [](const ForceElement& a, const ForceElement& b) { return a.body < b.body; });
  for (Index i = 0; i < Index(flat.force.size()); ++i) {
    const BodyIndex b = flat.force[i].body;
    if (flat.loaded.empty() || flat.loaded.back().body != b) flat.loaded.push_back({b, i, i});
    flat.loaded.back().end = i + 1;
  }
}

ControllerPlan plan(const Controller& c, FlatElements& flat) {
  ControllerPlan p;
  p.type = c.type;
  p.motor = c.motor;
  if (follows_body(c)) {
    p.body = c.body;
    p.axis = c.axis * (1 / length(c.axis));
  }
  p.frame = c.frame;
  p.command = append_table(c.command, flat);
  p.limit = append_table(c.limit, flat);
  p.proportional = c.proportional;
  p.integral = c.integral;
  p.feed_forward = c.feed_forward;
  p.top_speed = c.top_speed;
  p.look_ahead = c.look_ahead;
  p.max_angle = c.max_angle;
  p.rate = c.rate;
  p.pointer_a = c.pointer_a;
  return p;
}

DrivelinePlan plan(const Driveline& d, FlatElements& flat) {
  DrivelinePlan p;
  static_cast<DrivelineNumbers&>(p) = d;
  p.torque = append_table(d.torque, flat);
  p.torque_ratio = append_table(d.torque_ratio, flat);
  p.capacity = append_table(d.capacity, flat);
  p.throttle = append_table(d.throttle, flat);
  p.braking = append_table(d.braking, flat);
  p.speed = append_table(d.speed, flat);
  return p;
}

MonitorPlan plan(const SceneWorld& world, const Monitor& m, double step) {
  const auto steps = [&](double time) { return Index(std::lround(std::min(time / step, 2e9))); };
  MonitorPlan p;
  p.body = m.body;
  p.motor = m.motor;
  p.stride = m.stride;
  p.start = steps(m.start);
  p.time_limit = std::max<Index>(1, steps(m.start + m.time_limit));
  p.earliest = std::min(p.time_limit, steps(m.start + m.earliest));
  p.capacity = p.time_limit / p.stride;
  p.height = m.height;
  p.distance = m.distance;
  p.slid_back = m.slid_back;
  p.up_B = rotate_back(world.body[m.body].orientation, m.up);
  p.min_up = m.min_up;
  if (m.immobile_window > 0) {
    p.immobile_samples = std::max<Index>(1, steps(m.immobile_window / m.stride));
    p.immobile_from = steps(m.start + m.immobile_from + m.immobile_window);
    p.immobile_travel = m.immobile_speed * m.immobile_window;
  }
  return p;
}

}  // namespace

ForceElement tow_load(BodyIndex body, ReferenceFrame frame, const Vec3& direction, double pull, const Vec3& point_B) {
  if (!is_finite(direction) || !(length(direction) > 0)) throw InputError("a tow load needs a direction");
  ForceElement f;
  f.body = body;
  f.frame = frame;
  f.force = direction * Real(-pull / length(direction));
  f.point_B = point_B;
  return f;
}

ForceElement aerodynamic_drag(BodyIndex body, double density, double coefficient, double area, const Vec3& point_B) {
  ForceElement f;
  f.type = ForceType::drag;
  f.body = body;
  f.drag = Real(density * coefficient * area);
  f.point_B = point_B;
  return f;
}

void check_elements(const SceneWorld& world, std::size_t w, const StepSettings& settings) {
  for (std::size_t i = 0; i < world.force.size(); ++i) check(world, world.force[i], {w, "force", i});
  std::vector<bool> driven(world.motor.size());
  for (std::size_t i = 0; i < world.controller.size(); ++i) {
    const Controller& c = world.controller[i];
    const Refusal refuse(w, "controller", i);
    check(world, c, refuse);
    refuse.unless(!driven[c.motor], "drives motor " + std::to_string(c.motor) + ", which has a controller already");
    driven[c.motor] = true;
  }
  for (std::size_t i = 0; i < world.driveline.size(); ++i) {
    const Refusal refuse(w, "driveline", i);
    check(world, world.driveline[i], refuse);
    for (const Index m : motors_of(world.driveline[i])) {
      refuse.unless(!driven[m], "drives motor " + std::to_string(m) + ", which is driven already");
      driven[m] = true;
    }
  }
  for (std::size_t i = 0; i < world.monitor.size(); ++i)
    check(world, world.monitor[i], settings.step, {w, "monitor", i});
}

FlatElements flat_elements(const SceneWorld& world, const StepSettings& settings) {
  FlatElements flat;
  flatten_forces(world, flat);
  for (const Controller& c : world.controller) flat.controller.push_back(plan(c, flat));
  for (const Driveline& d : world.driveline) {
    flat.driveline.push_back(plan(d, flat));
    flat.driveline_state.push_back({0, d.idle_speed, 0, double(d.first_gear)});
  }
  ElementSize next;
  for (const Monitor& m : world.monitor) {
    flat.monitor.push_back(plan(world, m, settings.step));
    flat.monitor.back().first_sample = next.samples;
    next = after(next, {0, 0, 0, 0, 1, flat.monitor.back().capacity});
    MonitorState start;
    start.position = world.body[m.body].position;
    flat.monitor_state.push_back(start);
  }
  flat.sample_capacity = next.samples;
  return flat;
}

}  // namespace gonogo::sim

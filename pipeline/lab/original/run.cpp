#include "pipeline/lab/original/run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/cancel.h"
#include "base/error.h"
#include "base/line.h"
#include "base/units.h"
#include "vehicle/model/engine_vehicle.h"
#include "vehicle/model/statics.h"

namespace gonogo::lab {
namespace {

using vehicle::EngineVehicle;
using vehicle::Vehicle;

Vehicle as_in_the_original(Vehicle v) {
  if (v.kind != vehicle::VehicleKind::wheeled || v.driveline.wheel_motors)
    throw InputError("vehicle " + v.name + ": the original study drives a wheeled vehicle with an engine");
  for (vehicle::Wheel& w : v.wheel) {
    w.lug_count = 0;
    w.lug_height = 0;
  }
  for (vehicle::Axle& a : v.axle) a.brake_torque = 0;
  return v;
}

sim::StepSettings settings_of(const OriginalRequest& r) {
  sim::StepSettings s = terrain::bed_step_settings(2 * r.input.radius, r.time.step, r.time.iterations, 1e-3);
  s.envelope = Real(0.1 * r.input.radius);
  // A pull of 1 MPa turns a loose grain 20 m/s faster in a step. The original lets it go; here it crosses one bin.
  s.max_slowed = std::numeric_limits<Index>::max();
  return s;
}

Index steps_in(double time, double step) { return Index(std::lround(time / step)); }

/// Grains settled alone.
std::vector<sim::BodyState> settled(const OriginalRequest& r) {
  std::vector<sim::BodyState> grain;
  for (const Vec3d& p : dropped_grains(r.bin, r.input.radius, r.seed)) grain.push_back({p, {}, {}, {}});
  const auto s =
      sim::make_simulation(r.backend, {bin_world(r.bin, r.input, r.tyre_friction, grain)}, settings_of(r), r.threads);
  s->advance(steps_in(r.time.settle, r.time.step));
  if (const sim::StepReport report = s->report(0); report.flags != 0)
    throw DeviceError("the grains of the bin did not settle: " + sim::description(report.fault, r.time.step));
  const auto bodies = s->bodies(0);
  return {bodies.begin(), bodies.begin() + std::ptrdiff_t(grain.size())};
}

/// The vehicle over the settled grains.
struct Dropped {
  sim::SceneWorld world;
  EngineVehicle e;
  Vec3 origin_B;         // the vehicle's origin in the chassis's frame
  sim::Controller hand;  // of the steering, empty command: there is none
};

sim::Monitor chassis_monitor(const OriginalTimeline& t, sim::BodyIndex chassis) {
  sim::Monitor m;
  m.body = chassis;
  m.distance = t.goal_x - t.start_x;
  m.slid_back = t.start_x - t.lost_x;
  m.time_limit = t.end - t.settle;
  return m;
}

Dropped dropped(const Vehicle& v, const OriginalRequest& r, const std::vector<sim::BodyState>& grain, double surface) {
  Dropped d;
  d.world = bin_world(r.bin, r.input, r.tyre_friction, grain);
  const Vec3d origin{r.time.start_x, 0, surface + r.time.drop};
  const std::size_t shapes = d.world.shape.size();
  d.e = vehicle::add_vehicle(d.world, v, origin, terrain::tool_material);
  std::erase_if(d.world.shape, [&](const sim::Shape& s) { return s.body == d.e.chassis; });
  for (std::size_t i = shapes; i < d.world.shape.size(); ++i) d.world.shape[i].group = kPassesFloor;
  if (vehicle::steers(v)) {
    vehicle::add_steering(d.world, v, d.e, origin);
    d.hand = d.world.controller.back();
  }
  vehicle::DriverOrders orders;
  orders.release = r.time.rest;
  orders.throttle_ramp = r.time.throttle_ramp;
  vehicle::add_drive(d.world, v, d.e, orders);
  const sim::BodyState& chassis = d.world.body[std::size_t(d.e.chassis)];
  d.origin_B = rotate_back(chassis.orientation, static_cast<Vec3>(origin - chassis.position));
  d.world.monitor.push_back(chassis_monitor(r.time, d.e.chassis));
  return d;
}

OriginalSample sample_of(const sim::BodyState& chassis, const Dropped& d, const OriginalTimeline& t, double since) {
  OriginalSample s;
  s.time = t.settle + since;
  s.throttle = std::clamp((since - t.rest) / t.throttle_ramp, 0.0, 1.0);
  const Vec3 arm = rotate(chassis.orientation, d.origin_B);
  s.position = chassis.position + static_cast<Vec3d>(arm);
  s.velocity = static_cast<Vec3d>(chassis.velocity + cross(chassis.angular_velocity, arm));
  if (d.hand.command.empty()) return s;
  const Vec3 forward = rotate(chassis.orientation, d.hand.axis);
  const double beside = chassis.position.y + d.hand.look_ahead * forward.y;
  s.steering = sim::steering_wish(d.hand.proportional, d.hand.max_angle, beside) / d.hand.max_angle;
  return s;
}

OriginalStop stop_of(sim::StopCause cause) {
  if (cause == sim::StopCause::distance) return OriginalStop::max_x;
  if (cause == sim::StopCause::slid_back) return OriginalStop::sliding_backward;
  return cause == sim::StopCause::time_limit ? OriginalStop::max_time : OriginalStop::failed;
}

/// Floor and spheres let tyres through, so that a vehicle that digs itself in falls out of the bin. The original goes
/// on until it is behind lost_x or the time is over. Below the floor nothing touches it: the rest is a parabola.
std::optional<OriginalStop> stop_of_fall(const OriginalSample& s, const OriginalRequest& r) {
  constexpr double kAllBelow = -2.5;  // of the origin: no wheel reaches the floor [m]
  if (s.position.z > kAllBelow) return std::nullopt;
  const double left = r.time.end - s.time, pull = -kGravity * std::sin(r.input.slope);
  const double end_x = s.position.x + left * s.velocity.x + 0.5 * left * left * pull;
  return end_x <= r.time.lost_x ? OriginalStop::sliding_backward : OriginalStop::max_time;
}

}  // namespace

const char* stop_sentence(OriginalStop stop) {
  switch (stop) {
    case OriginalStop::max_x:
      return "Reached maximum x position";
    case OriginalStop::sliding_backward:
      return "Vehicle sliding backward";
    case OriginalStop::max_time:
      return "Reached maximum time";
    case OriginalStop::failed:
      return "Simulation failed";
  }
  return "";
}

OriginalRecord run_original(const Vehicle& vehicle, const OriginalRequest& r) {
  const Vehicle v = as_in_the_original(vehicle);
  const std::vector<sim::BodyState> grain = settled(r);
  OriginalRecord record;
  record.grains = grain.size();
  for (const sim::BodyState& g : grain) record.surface = std::max(record.surface, g.position.z + r.input.radius);
  const Dropped d = dropped(v, r, grain, record.surface);
  const auto s = sim::make_simulation(r.backend, {d.world}, settings_of(r), r.threads);
  const Index every = std::max<Index>(1, steps_in(r.time.output_step, r.time.step));
  const Index tilt = steps_in(r.time.rest, r.time.step);
  for (Index taken = 0;; taken += every) {
    stop_if_cancelled();
    record.sample.push_back(sample_of(s->body(0, d.e.chassis), d, r.time, taken * r.time.step));
    if (r.watch) r.watch(record.sample.back());
    if (const sim::WorldStop stop = s->stop(0); stop.cause != sim::StopCause::none) {
      record.stop = stop_of(stop.cause);
      record.slowed = s->report(0).slowed;
      const sim::StepReport report = s->report(0);
      if (report.flags & sim::flag_left_domain)
        record.stop = stop_of_fall(record.sample.back(), r).value_or(record.stop);
      if (record.stop == OriginalStop::failed) record.fault = sim::description(report.fault, r.time.step);
      return record;
    }
    if (taken == tilt)
      s->set_gravity(0, {Real(-kGravity * std::sin(r.input.slope)), 0, Real(-kGravity * std::cos(r.input.slope))});
    s->advance(every);
  }
}

std::string original_output(const OriginalRecord& record) {
  std::string text;
  for (const OriginalSample& s : record.sample)
    text += line("%.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g\n", s.time, s.throttle, s.steering, s.position.x,
                 s.position.y, s.position.z, s.velocity.x, s.velocity.y, s.velocity.z);
  return text + "# " + stop_sentence(record.stop) + "\n";
}

}  // namespace gonogo::lab

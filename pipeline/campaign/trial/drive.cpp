#include "pipeline/campaign/trial/drive.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "pipeline/campaign/trial/undisturbed.h"
#include "sim/scene/build_joint.h"
#include "vehicle/model/engine_vehicle.h"
#include "vehicle/model/statics.h"

namespace gonogo::campaign {
namespace {

constexpr double kHeadroom = 2;  // over a standing vehicle's origin [m]

/// The wheel is let down with its brake on, its rim speed grows from zero to the commanded one, and stays there.
sim::Controller driver(const TrialSetup& setup, const TrialConditions& conditions, Index motor) {
  sim::Controller c;
  c.motor = motor;
  c.command = {{setup.park_time, 0}, {setup.park_time + setup.ramp_time, conditions.speed / setup.rig.radius}};
  c.limit = {{0, setup.rig.max_torque}};
  return c;
}

/// Watches what the trial is judged by: the wheel of a quarter vehicle, the chassis of a whole one.
sim::Monitor stopping_monitor(const TrialSetup& setup, sim::BodyIndex body) {
  const Thresholds& t = setup.thresholds;
  sim::Monitor m;
  m.body = body;
  m.start = setup.park_time;
  m.time_limit = setup.time_limit;
  m.earliest = setup.ramp_time + setup.min_drive_time;
  if (!(setup.task->tow().share > 0)) m.distance = setup.run_in_distance + setup.test_distance;
  m.slid_back = t.slid_back_share * setup.vehicle_length();
  m.immobile_window = t.immobile_time;
  m.immobile_from = setup.ramp_time;
  m.immobile_speed = t.immobile_speed;
  return m;
}

/// Height of the axle at which a wheel just clears every grain. `reach`: its radius with lugs [m]; `yaw`: of its
/// heading from x [rad].
double resting_axle_height(const terrain::Packing& packing, double reach, double width, double x, double y,
                           double yaw = 0) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  double height = packing.surface + reach;
  for (const terrain::Grain& g : terrain::lobes_of(packing)) {
    const double x_W = std::remainder(g.position.x - x, packing.spec.length),
                 y_W = std::remainder(g.position.y - y, packing.spec.width);
    const double dx = c * x_W + s * y_W, dy = c * y_W - s * x_W;
    const double free = reach + g.radius;
    if (std::fabs(dx) >= free || std::fabs(dy) >= width / 2 + g.radius) continue;
    height = std::max(height, g.position.z + std::sqrt(free * free - dx * dx));
  }
  return height;
}

/// Height from which the drop of the axle of a wheel in the lane at y is its sinkage. What a task has dug or built is
/// left out: there the ground that the vehicle stands on counts.
double sinkage_reference(const TrialSetup& setup, const terrain::Packing& packing, double reach, double width,
                         double y) {
  const Course c = setup.course(packing.surface);
  if (setup.task->obstacle_end() > 0)
    return untouched_axle_height(packing, reach, width, y, c.start - c.rear, c.front + c.rear);
  return untouched_axle_height(packing, reach, width, y, 0, c.length, setup.task->slip_angle().value_or(0));
}

/// Load of a drawbar sweep, along the bed.
void add_tow(const TrialSetup& setup, const TrialConditions& conditions, sim::BodyIndex body, const Vec3& point_B,
             sim::SceneWorld& world) {
  const TowPlan tow = setup.task->tow();
  if (!(tow.share > 0)) return;
  sim::ForceElement load =
      sim::tow_load(body, sim::ReferenceFrame::world, {1, 0, 0}, tow.share * setup.weight(conditions.payload), point_B);
  load.start = setup.tow_start();
  load.ramp = tow.ramp;
  world.force.push_back(load);
}

/// A carriage that moves along x at the speed of the given slip and leads the wheel, which turns at the commanded speed
/// from the beginning, by a damped spring along its way. With a slip angle another one holds it across.
void add_carriage(const TrialTask& task, double rim_speed, double radius, double mass, const vehicle::RigBodies& bodies,
                  sim::SceneWorld& world) {
  const Vec3 velocity{Real(rim_speed * (1 - *task.given_slip())), 0, 0};
  const double yaw = task.slip_angle().value_or(0), turning = rim_speed / radius;
  sim::BodyState& wheel = world.body[std::size_t(bodies.wheel)];
  wheel.velocity = velocity;
  wheel.angular_velocity = {Real(0 - turning * std::sin(yaw)), Real(turning * std::cos(yaw)), 0};
  const Vec3d at = wheel.position;
  const sim::BodyIndex carriage = world.add_body({at, {}, velocity, {}}, sim::fixed_body());
  world.spring.push_back(
      sim::spring_along(world, bodies.wheel, carriage, at, at, {1, 0, 0}, kCarriageStiffness, carriage_damping(mass)));
  if (task.slip_angle())
    world.spring.push_back(sim::spring_along(world, bodies.wheel, carriage, at, at, {0, 1, 0}, kCarriageStiffness,
                                             carriage_damping(mass)));
  world.controller.back().command = {{0, turning}};
}

/// The wheel of a quarter vehicle. Its drop below the height at which it would roll over grains that do not give way is
/// the sinkage.
void add_rig(const TrialSetup& setup, const TrialConditions& conditions, const terrain::Packing& packing,
             sim::SceneWorld& world) {
  const vehicle::WheelRig& rig = setup.rig;
  const double x = setup.course(0).start, y = 0.5 * packing.spec.width;
  const double yaw = setup.task->slip_angle().value_or(0);
  const double height = resting_axle_height(packing, rig.radius + rig.lug_height, rig.width, x, y, yaw);
  const auto bodies =
      vehicle::add_wheel_rig(world, rig, {x, y, height}, conditions.payload, terrain::tool_material, yaw);
  world.controller.push_back(driver(setup, conditions, bodies.motor));
  add_tow(setup, conditions, bodies.wheel, {}, world);
  if (setup.task->given_slip())
    add_carriage(*setup.task, conditions.speed, rig.radius, vehicle::rig_mass(rig, conditions.payload), bodies, world);
  sim::Monitor m = stopping_monitor(setup, bodies.wheel);
  m.motor = bodies.motor;
  m.height = sinkage_reference(setup, packing, rig.radius + rig.lug_height, rig.width, y);
  world.monitor.push_back(m);
}

/// Height at which points of a belt's bottom as wide as its shoes touch no grain.
double resting_belt_height(const vehicle::Vehicle& v, const terrain::Packing& packing, double x, double y) {
  double height = -1e9;
  const auto lobes = terrain::lobes_of(packing);
  for (const Vec3d& p : vehicle::belt_bottom(v))
    for (const terrain::Grain& g : lobes) {
      const double dx = std::remainder(g.position.x - x - p.x, packing.spec.length),
                   dy = std::remainder(g.position.y - y - p.y, packing.spec.width);
      if (std::fabs(dx) >= g.radius || std::fabs(dy) >= v.track[0].shoe_width / 2 + g.radius) continue;
      height = std::max(height, g.position.z + std::sqrt(g.radius * g.radius - dx * dx) - p.z);
    }
  return height;
}

/// Height of the vehicle's origin at which none of its wheels, or nothing of its belts, touches a grain and one almost
/// does.
double resting_height(const vehicle::Vehicle& v, const terrain::Packing& packing, double x, double y) {
  if (!v.track.empty()) return resting_belt_height(v, packing, x, y);
  double height = -1e9;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v)) {
    const double axle = resting_axle_height(packing, p.reach, p.width, x + p.centre.x, y + p.centre.y);
    height = std::max(height, axle - p.centre.z);
  }
  return height;
}

/// A whole vehicle with its brakes on, its chassis watched first and its wheels after it.
void add_whole(const TrialSetup& setup, const TrialConditions& conditions, const terrain::Packing& packing,
               sim::SceneWorld& world) {
  const vehicle::Vehicle v = vehicle::set_down(vehicle::loaded(*setup.whole, conditions.payload));
  const double x = setup.course(0).start, y = 0.5 * packing.spec.width;
  const Vec3d origin{x, y, resting_height(v, packing, x, y)};
  auto e = vehicle::add_vehicle(world, v, origin, terrain::tool_material);
  if (vehicle::steers(v)) vehicle::add_steering(world, v, e, origin);
  vehicle::DriverOrders orders;
  orders.release = setup.park_time;
  orders.throttle_ramp = setup.ramp_time;
  orders.speed = conditions.speed;
  vehicle::add_drive(world, v, e, orders);
  // The hitch: at the rear, as high as the axles, so that the pull turns the vehicle as its wheels' forces do.
  const Vec3d hitch{-v.length / 2, 0, e.station.front().centre.z};
  add_tow(setup, conditions, e.chassis,
          rotate_back(world.body[std::size_t(e.chassis)].orientation, static_cast<Vec3>(hitch - e.chassis_centre)),
          world);
  sim::Monitor chassis = stopping_monitor(setup, e.chassis);
  chassis.min_up = std::cos(to_radians(setup.thresholds.tilt_deg));
  world.monitor.push_back(chassis);
  const auto parts = vehicle::running_parts(v);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    sim::Monitor m;
    m.body = vehicle::running_body(e, i);
    m.motor = vehicle::running_motor(e, i);
    if (parts[i].reach > 0)
      m.height = sinkage_reference(setup, packing, parts[i].reach, parts[i].width, y + parts[i].centre.y);
    m.start = setup.park_time;
    m.time_limit = setup.time_limit;
    world.monitor.push_back(m);
  }
}

/// The bed with the strip of other soil and the fixed bodies of the task.
sim::SceneWorld ground_world(const TrialSetup& setup, const terrain::Packing& packing,
                             const TrialConditions& conditions, double headroom) {
  constexpr int soft_material = terrain::tool_material + 1;
  sim::SceneWorld world = terrain::bed_world(packing, conditions.laws, headroom + setup.task->rise());
  world.gravity = conditions.gravity;
  const Course course = setup.course(packing.surface);
  if (const auto strip = setup.task->strip(course); strip && conditions.soft) {
    // Between the two soils the softer one gives way.
    for (const int other : {int(terrain::grain_material), int(terrain::base_material), soft_material})
      world.set_law(soft_material, other, *conditions.soft);
    world.set_law(soft_material, terrain::tool_material, conditions.laws.tool);
    for (sim::Shape& s : world.shape)
      if (s.material == terrain::grain_material &&
          beyond(strip->from, world.body[std::size_t(s.body)].position.x, course.length) < strip->length)
        s.material = soft_material;
  }
  setup.task->furnish(course, world);
  return world;
}

}  // namespace

sim::SceneWorld bed_alone(const TrialSetup& setup, const terrain::Packing& settled, const TrialConditions& conditions) {
  return ground_world(setup, settled, conditions, 2 * settled.spec.grain_diameter);
}

double carriage_damping(double mass) { return std::sqrt(kCarriageStiffness * mass); }

Index bed_steps(const TrialSetup& setup, const sim::StepSettings& settings) {
  return std::max(1, int(std::lround(setup.bed_settle_time / settings.step)));
}

TiltedBed tilted_bed(sim::Simulation& simulation, sim::WorldIndex world, const terrain::Packing& settled) {
  TiltedBed bed;
  const sim::StepReport report = simulation.report(world);
  bed.flags = report.flags;
  bed.residual = report.rms_residual;
  const auto bodies = simulation.bodies(world);
  Vec3d mean;
  const std::size_t count = settled.grain.size();
  for (std::size_t i = 0; i < count; ++i) mean += static_cast<Vec3d>(bodies[i].velocity) * (1.0 / double(count));
  bed.grain = terrain::grain_places(bodies, settled.spec.shape, count);
  bed.creep = std::hypot(mean.x, mean.y);
  return bed;
}

bool fails(const TrialSetup& setup, const TiltedBed& bed) {
  return bed.flags != 0 || bed.creep > setup.thresholds.creep_speed;
}

DriveOutcome outcome_of_failed_bed(const TiltedBed& bed) {
  DriveOutcome o;
  o.flags = bed.flags;
  o.worst_residual = bed.residual;
  o.bed_creep = bed.creep;
  if (bed.flags == 0) {
    o.verdict = Verdict::no_go;
    o.reason = Reason::slope_unstable;
  }
  o.slip = o.sinkage = o.drift = o.mean_torque = o.energy_per_metre = kNaN;
  return o;
}

sim::SceneWorld vehicle_on_bed(const TrialSetup& setup, const terrain::Packing& settled, const TiltedBed& bed,
                               const TrialConditions& conditions) {
  terrain::Packing packing = settled;
  for (std::size_t i = 0; i < bed.grain.size(); ++i) {
    packing.grain[i].position = bed.grain[i].position;
    packing.grain[i].orientation = bed.grain[i].orientation;
  }
  const double headroom = setup.whole ? kHeadroom + vehicle::standing_height(vehicle::set_down(*setup.whole))
                                      : 3 * (setup.rig.radius + setup.rig.lug_height);
  sim::SceneWorld world = ground_world(setup, packing, conditions, headroom);
  if (setup.whole)
    add_whole(setup, conditions, packing, world);
  else
    add_rig(setup, conditions, packing, world);
  return world;
}

}  // namespace gonogo::campaign

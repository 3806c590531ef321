#include "pipeline/campaign/trial/world.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "sim/scene/scene.h"
#include "terrain/bed/bed.h"
#include "vehicle/model/assembly.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/driving.h"

namespace gonogo::campaign {
namespace {

/// Where a wheel stands on the hard layer under weak grains, some of them are pinched and jump away at tens of metres
/// per second. One movement in a million: a trial moves tens of thousands of grains some thousand times.
constexpr Index kMaxSlowed = 200;

std::size_t packing_of(const TrialSetup& setup, const TrialInputs& in) {
  return terrain::packing_level(setup.calibration, in.soil);
}

vehicle::LinearSpring tyre_contact(const TrialSetup& setup, double payload) {
  const double weight = setup.weight(payload), grain = setup.calibration.grain_diameter;
  const double wheels = double(vehicle::stations(setup.vehicle).size());
  return vehicle::contact_spring(setup.vehicle.wheel.front(), weight / wheels, grain);
}

/// Height of the axle of a cylinder that touches this grain, which lies dx ahead of it and dy beside its middle: a
/// grain beyond its side touches its edge. The base's height when the two cannot touch [m].
double touching_height(const terrain::Grain& g, double reach, double width, double dx, double dy) {
  const double beside = std::max(0.0, std::fabs(dy) - width / 2);
  if (beside >= g.radius) return reach;
  const double apart = reach + std::sqrt(g.radius * g.radius - beside * beside);
  return std::fabs(dx) < apart ? g.position.z + std::sqrt(apart * apart - dx * dx) : reach;
}

constexpr double kHeadroom = 2;  // over a standing vehicle's origin [m]

/// Watches what the trial is judged by: the wheel of a quarter vehicle, the chassis of a whole one.
sim::Monitor stopping_monitor(const TrialSetup& setup, sim::BodyIndex body) {
  const Thresholds& t = setup.thresholds;
  sim::Monitor m;
  m.body = body;
  m.start = setup.park_time;
  m.time_limit = setup.time_limit;
  m.earliest = setup.ramp_time + setup.min_drive_time;
  if (!(setup.task->tow().share > 0)) m.distance = setup.run_in_distance + setup.test_distance;
  m.slid_back = t.slid_back_share * setup.vehicle.length;
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

/// A carriage that moves along x at the speed of the given slip and tows the wheel of a quarter, which turns at the
/// commanded speed from the beginning, by a damped spring along its way. With a slip angle another one holds it across.
void add_carriage(const TrialTask& task, double rim_speed, double mass, const vehicle::EngineVehicle& e,
                  sim::SceneWorld& world) {
  const Vec3 velocity{Real(rim_speed * (1 - *task.given_slip())), 0, 0};
  const double yaw = task.slip_angle().value_or(0), turning = rim_speed / e.station.front().wheel->radius;
  sim::BodyState& wheel = world.body[std::size_t(e.wheel.front())];
  wheel.velocity = velocity;
  wheel.angular_velocity = {Real(0 - turning * std::sin(yaw)), Real(turning * std::cos(yaw)), 0};
  const Vec3d at = wheel.position;
  const sim::BodyIndex carriage = world.add_body({at, {}, velocity, {}}, sim::fixed_body());
  const auto hold = [&](const Vec3d& way) {
    world.spring.push_back(
        sim::spring_along(world, e.wheel.front(), carriage, at, at, way, kCarriageStiffness, carriage_damping(mass)));
  };
  hold({1, 0, 0});
  if (task.slip_angle()) hold({0, 1, 0});
  world.controller.back().command = {{0, turning}};
}

/// Height at which points of a belt's bottom as wide as its shoes touch no grain.
double resting_belt_height(const vehicle::Vehicle& v, const terrain::Packing& packing, double x, double y) {
  double height = -1e9;
  const auto lobes = terrain::lobes_of(packing);
  for (const Vec3d& p : vehicle::belt_bottom(v))
    for (const terrain::Grain& g : lobes) {
      const double dx = std::remainder(g.position.x - x - p.x, packing.spec.length),
                   dy = std::remainder(g.position.y - y - p.y, packing.spec.width);
      if (std::fabs(dx) >= g.radius || std::fabs(dy) >= v.track->shoe_width / 2 + g.radius) continue;
      height = std::max(height, g.position.z + std::sqrt(g.radius * g.radius - dx * dx) - p.z);
    }
  return height;
}

/// Height of the origin of a vehicle with this heading at which none of its wheels, or nothing of its belts, touches a
/// grain and one almost does.
double resting_height(const vehicle::Vehicle& v, const terrain::Packing& packing, double x, double y, double yaw) {
  if (v.track) return resting_belt_height(v, packing, x, y);
  double height = -1e9;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v)) {
    const double axle = resting_axle_height(packing, p.reach, p.width, x + p.centre.x, y + p.centre.y, yaw);
    height = std::max(height, axle - p.centre.z);
  }
  return height;
}

/// The vehicle is watched first and its wheels after it; a quarter is its wheel.
void add_monitors(const TrialSetup& setup, const vehicle::Vehicle& v, const vehicle::EngineVehicle& e,
                  const terrain::Packing& packing, double y, sim::SceneWorld& world) {
  const bool quarter = vehicle::is_quarter(v);
  sim::Monitor whole = stopping_monitor(setup, e.chassis), wheel;
  wheel.start = setup.park_time;
  wheel.time_limit = setup.time_limit;
  if (!quarter) {
    whole.min_up = std::cos(to_radians(setup.thresholds.tilt_deg));
    world.monitor.push_back(whole);
  }
  const auto parts = vehicle::running_parts(v);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    sim::Monitor m = quarter ? whole : wheel;
    m.body = vehicle::running_body(e, i);
    m.motor = vehicle::running_motor(e, i);
    if (parts[i].reach > 0)
      m.height = sinkage_reference(setup, packing, parts[i].reach, parts[i].width, y + parts[i].centre.y);
    world.monitor.push_back(m);
  }
}

/// The vehicle with its brakes on, its driver, and what pulls it.
void add_vehicle(const TrialSetup& setup, const TrialConditions& conditions, const terrain::Packing& packing,
                 sim::SceneWorld& world) {
  const vehicle::Vehicle v = vehicle::set_down(vehicle::loaded(setup.vehicle, conditions.payload));
  const double x = setup.course(0).start, y = 0.5 * packing.spec.width, yaw = setup.task->slip_angle().value_or(0);
  const Vec3d origin{x, y, resting_height(v, packing, x, y, yaw)};
  auto e = vehicle::add_vehicle(world, v, origin, terrain::tool_material, yaw);
  if (vehicle::steers(v)) vehicle::add_steering(world, v, e, origin);
  vehicle::DriverOrders orders;
  orders.release = setup.park_time;
  orders.throttle_ramp = setup.ramp_time;
  orders.speed = conditions.speed;
  vehicle::add_driveline(world, v, e, orders);
  add_tow(setup, conditions, e.chassis, e.hitch_B, world);
  if (setup.task->given_slip())
    add_carriage(*setup.task, conditions.speed, vehicle::loaded_mass(setup.vehicle, conditions.payload), e, world);
  add_monitors(setup, v, e, packing, y, world);
}

/// Height of the world over the bed that the vehicle needs [m].
double headroom_of(const vehicle::Vehicle& v) {
  const double standing = vehicle::standing_height(vehicle::set_down(v));
  return vehicle::is_quarter(v) ? 3 * standing : kHeadroom + standing;
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

TrialConditions conditions_of(const TrialSetup& setup, const TrialInputs& in) {
  TrialConditions c;
  const Vec3d g = bed_gravity(in.slope_along, in.slope_across, setup.gravity);
  c.gravity = static_cast<Vec3>(g);
  const std::size_t packing = packing_of(setup, in);
  const sim::PairLaw grain = terrain::contact_law(setup.calibration, in.soil, packing);
  // The tyre touches grains with its own friction; soil cohesion acts between grains alone.
  c.laws = {grain, {Real(in.tyre_friction), Real(setup.wheel_rolling) * grain.rolling_friction, 0}};
  if (setup.compliant_tyres && setup.vehicle.wheel.front().compliant.stiffness > 0) {
    const vehicle::LinearSpring spring = tyre_contact(setup, in.payload);
    c.laws.tool.stiffness = Real(spring.stiffness);
    c.laws.tool.damping = Real(spring.damping);
  }
  if (const auto strip = setup.task->strip({})) c.soft = terrain::contact_law(setup.calibration, strip->soil, packing);
  c.payload = in.payload;
  c.speed = in.speed;
  return c;
}

terrain::BedSpec bed_spec_of(const TrialSetup& setup, const TrialInputs& in) {
  return setup.bed_spec(in.bed_depth, packing_of(setup, in), in.bed_seed);
}

terrain::Packing settled_bed(const TrialSetup& setup, const TrialInputs& in) {
  terrain::Packing tile = terrain::cached_packing(bed_spec_of(setup, in), setup.packing_folder, 1);
  if (setup.deepest_bed > 0) tile = terrain::on_hard_layer(tile, in.bed_depth);
  terrain::Packing bed = terrain::tiled(terrain::shifted(tile, in.bed_seed), setup.tiles_along, setup.tiles_across);
  setup.task->shape(setup.course(bed.surface), bed);
  return bed;
}

double attempt_step(const TrialSetup& setup, std::uint64_t attempt) {
  return attempt > 1 ? setup.numerics.step / 2 : setup.numerics.step;
}

sim::StepSettings attempt_settings(const TrialSetup& setup, std::uint64_t attempt) {
  terrain::Numerics numerics = setup.numerics;
  numerics.step = attempt_step(setup, attempt);
  sim::StepSettings s = terrain::step_settings(setup.calibration.grain_diameter, numerics);
  s.max_slowed = kMaxSlowed;
  s.recovery_speed *= Real(std::sqrt(setup.gravity / kGravity));  // a tenth of the fall through a grain
  return s;
}

double untouched_axle_height(const terrain::Packing& packing, double reach, double width, double y, double from,
                             double way, double yaw) {
  const terrain::BedSpec& bed = packing.spec;
  const double c = std::cos(yaw), s = std::sin(yaw), half_lane = width / 2 * c + reach * std::fabs(s);
  std::vector<terrain::Grain> lane;
  for (const terrain::Grain& g : terrain::lobes_of(packing))
    if (std::fabs(std::remainder(g.position.y - y, bed.width)) < half_lane + g.radius) lane.push_back(g);
  // Highest first: once a wheel stands higher than on top of the next grain, none of the others touches it.
  const auto top = [](const terrain::Grain& g) { return g.position.z + g.radius; };
  std::sort(lane.begin(), lane.end(), [&](const auto& a, const auto& b) { return top(a) > top(b); });
  const int places = std::max(8, int(4 * way / bed.grain_diameter));
  double sum = 0;
  for (int k = 0; k < places; ++k) {
    const double x = from + (k + 0.5) * way / places;
    double height = reach;
    for (const terrain::Grain& g : lane) {
      if (top(g) + reach <= height) break;
      const double dx = std::remainder(g.position.x - x, bed.length), dy = std::remainder(g.position.y - y, bed.width);
      height = std::max(height, touching_height(g, reach, width, c * dx + s * dy, c * dy - s * dx));
    }
    sum += height;
  }
  return sum / places;
}

sim::SceneWorld bed_alone(const TrialSetup& setup, const terrain::Packing& settled, const TrialConditions& conditions) {
  return ground_world(setup, settled, conditions, 2 * settled.spec.grain_diameter);
}

Index first_wheel_monitor(const vehicle::Vehicle& v) { return vehicle::is_quarter(v) ? 0 : 1; }

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

sim::SceneWorld vehicle_on_bed(const TrialSetup& setup, const terrain::Packing& settled, const TiltedBed& bed,
                               const TrialConditions& conditions) {
  terrain::Packing packing = settled;
  for (std::size_t i = 0; i < bed.grain.size(); ++i) {
    packing.grain[i].position = bed.grain[i].position;
    packing.grain[i].orientation = bed.grain[i].orientation;
  }
  sim::SceneWorld world = ground_world(setup, packing, conditions, headroom_of(setup.vehicle));
  add_vehicle(setup, conditions, packing, world);
  return world;
}

}  // namespace gonogo::campaign

#include "pipeline/lab/bench/engine_bench.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/json/config.h"
#include "base/math/statistics.h"
#include "base/progress.h"
#include "base/units.h"
#include "pipeline/lab/scenes/scene.h"
#include "sim/scene/penalty_setup.h"
#include "terrain/bed/bed.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::lab {
namespace {

sim::SceneWorld bench_world(const BedBench& request) {
  terrain::BedSpec spec;
  spec.grain_diameter = request.grain_diameter;
  spec.length = request.length;
  spec.width = request.width;
  spec.depth = request.depth;
  log_line("bench", "settling the bed, or reading it from " + request.packing_folder.string());
  const terrain::Packing packing = terrain::cached_packing(spec, request.packing_folder, request.threads);
  const sim::PairLaw law{Real(request.friction), Real(request.rolling_friction), 0};
  return terrain::bed_world(terrain::tiled(packing, request.copies, 1), {law, law}, spec.grain_diameter);
}

}  // namespace

BedBenchResult bench_bed(const BedBench& request) {
  sim::require_backend(request.backend);
  const sim::SceneWorld world = bench_world(request);
  const sim::Scene scene(std::size_t(request.worlds), world);
  const auto timed = [&](int iterations, BedBenchResult& r) {
    const auto settings = terrain::bed_step_settings(request.grain_diameter, 1e-3, iterations);
    const auto simulation = sim::make_simulation(request.backend, scene, settings, request.threads);
    simulation->advance(20);
    const double time = seconds_per_step(*simulation, request.repeats, request.steps_per_sample);
    const sim::StepReport report = simulation->report(0);
    r.contacts = std::int64_t(report.contact_count) * request.worlds;
    r.residual_m_per_s = report.rms_residual;
    return time;
  };
  BedBenchResult few, r;
  const int less = std::max(1, request.iterations / 5);
  const double quick = timed(less, few), time = timed(request.iterations, r);
  r.worlds = request.worlds;
  r.bodies = std::int64_t(world.body.size()) * request.worlds;
  r.iterations = request.iterations;
  r.ms_per_step = time * 1e3;
  r.ns_per_contact_iteration = time * 1e9 / double(r.contacts) / request.iterations;
  r.ns_per_contact_iteration_solver =
      (time * 1e9 / double(r.contacts) - quick * 1e9 / double(few.contacts)) / (request.iterations - less);
  return r;
}

namespace {

struct WheelScene {
  vehicle::Vehicle quarter;
  terrain::BedSpec bed;
  sim::PairLaw law;
  double slope;                                          // [rad]
  double speed;                                          // of the rim [m/s]
  double settle_time, park_time, ramp_time, drive_time;  // [s]

  const vehicle::Wheel& wheel() const { return quarter.wheel.front(); }
};

WheelScene read_wheel_scene(const std::filesystem::path& path) {
  const Config c = Config::read(path);
  c.choice("scene", {"wheel"});
  c.text_or("about", "");
  WheelScene s;
  s.quarter = vehicle::read_quarter_vehicle(c.path("vehicle"));
  s.quarter.chassis.mass = c.number("load_N", {1, 1e6}) / kGravity - s.quarter.wheel.front().part.mass;
  if (!(s.quarter.chassis.mass > 0)) c.fail("load_N", "is less than the weight of the vehicle's hub");
  const Config bed = c.object("bed");
  s.bed.length = bed.number("length_m", {0.5, 100});
  s.bed.width = bed.number("width_m", {0.1, 100});
  s.bed.depth = bed.number("depth_m", {0.02, 10});
  s.bed.grain_diameter = bed.number("grain_diameter_m", {1e-3, 1});
  s.bed.size_spread = bed.number("size_spread", {0, 0.5});
  s.bed.grain_density = bed.number("grain_density_kg_m3", {100, 2e4});
  bed.finish();
  const Config contact = c.object("contact");
  s.law.friction = Real(contact.number("friction", {0, 10}));
  s.law.rolling_friction = Real(contact.number("rolling_friction", {0, 10}));
  contact.finish();
  s.slope = to_radians(c.number("slope_deg", {-60, 60}));
  s.speed = c.number("speed_m_s", {0.01, 50});
  s.settle_time = c.number("settle_time_s", {0, 100});
  s.park_time = c.number("park_time_s", {0, 100});
  s.ramp_time = c.number("ramp_time_s", {0, 100});
  s.drive_time = c.number("drive_time_s", {0.1, 1000});
  c.finish();
  return s;
}

Vec3 tilted_gravity(double slope) { return {Real(-kGravity * std::sin(slope)), 0, Real(-kGravity * std::cos(slope))}; }

/// The bed at rest under the slope's gravity, with its own friction.
terrain::Packing tilted(const WheelScene& scene, terrain::Packing packing, const WheelBench& request) {
  sim::SceneWorld world = terrain::bed_world(packing, {scene.law, scene.law}, 2 * scene.bed.grain_diameter);
  world.gravity = tilted_gravity(scene.slope);
  const auto settings = terrain::bed_step_settings(scene.bed.grain_diameter, 1e-3, 50);
  const auto simulation = sim::make_simulation(request.backend, {world}, settings, request.threads);
  simulation->advance(Index(std::lround(scene.settle_time / settings.step)));
  const auto bodies = simulation->bodies(0);
  terrain::take_places(packing.grain, packing.spec.shape, bodies);
  return packing;
}

/// Lowest height of the axle at which wheel and lugs clear every grain.
double clear_height(const WheelScene& scene, const terrain::Packing& packing, double x, double y) {
  const double reach = scene.wheel().radius + scene.wheel().lug_height;
  double height = packing.surface;
  for (const terrain::Grain& g : terrain::lobes_of(packing)) {
    const double dx = g.position.x - x, dy = g.position.y - y, free = reach + g.radius;
    if (std::fabs(dx) >= free || std::fabs(dy) >= scene.wheel().width / 2 + g.radius) continue;
    height = std::max(height, g.position.z + std::sqrt(free * free - dx * dx));
  }
  return height;
}

/// Follows a wheel over periodic sides.
class Odometer {
 public:
  Odometer(const WheelScene& scene, const sim::BodyState& wheel)
      : length_(scene.bed.length), radius_(scene.wheel().radius), last_(wheel) {}

  void add(const sim::BodyState& wheel, double time) {
    const double dx = wheel.position.x - last_.position.x;
    x_ += dx - length_ * std::rint(dx / length_);
    rolled_ += (wheel.angular_velocity.y + last_.angular_velocity.y) / 2 * time * radius_;
    last_ = wheel;
  }
  double x() const { return x_; }
  double rolled() const { return rolled_; }

 private:
  double length_, radius_;
  sim::BodyState last_;
  double x_ = 0, rolled_ = 0;
};

class Drive {
 public:
  /// `quarter`: of every world.
  Drive(const WheelScene& scene, const WheelBench& request, sim::Simulation& simulation,
        std::vector<vehicle::EngineVehicle> quarter, double surface)
      : scene_(scene), request_(request), simulation_(simulation), quarter_(std::move(quarter)), surface_(surface) {}

  void park() { simulation_.advance(steps(scene_.park_time)); }

  void ramp() {
    constexpr int parts = 20;
    for (int k = 1; k <= parts; ++k) {
      set_speed(scene_.speed * k / parts);
      simulation_.advance(std::max(1, steps(scene_.ramp_time / parts)));
    }
  }

  /// Samples every few steps, far more often than a lug passes.
  WheelBenchResult drive() {
    const double sample_time = 0.01;
    const int per_sample = std::max(1, steps(sample_time)), samples = std::max(4, steps(drive_time()) / per_sample);
    const int passed_over = samples / 2, measured = samples - passed_over;
    WheelBenchResult r;
    std::vector<Odometer> odometer, half;
    for (int w = 0; w < request_.worlds; ++w) odometer.emplace_back(scene_, wheel(w));
    const double start = seconds();
    for (int k = 0; k < samples; ++k) {
      simulation_.advance(per_sample);
      for (int w = 0; w < request_.worlds; ++w) odometer[w].add(wheel(w), per_sample * request_.step);
      add_reports(r, 1.0 / samples);
      if (k == passed_over - 1) half = odometer;
      if (k < passed_over) continue;
      r.sinkage += sinkage() / measured;
      r.torque += torque() / measured;
    }
    const double wall = seconds() - start;
    r.steps = samples * per_sample;
    r.ms_per_step = wall / r.steps * 1e3;
    r.simulated_per_wall = r.steps * request_.step / wall;
    set_slip(r, half, odometer);
    return r;
  }

 private:
  int steps(double time) const { return int(std::lround(time / request_.step)); }
  double drive_time() const { return request_.drive_time > 0 ? request_.drive_time : scene_.drive_time; }
  sim::BodyState wheel(int w) { return simulation_.body(w, quarter_[w].wheel.front()); }

  double sinkage() {
    double sum = 0;
    for (int w = 0; w < request_.worlds; ++w) sum += surface_ - (wheel(w).position.z - scene_.wheel().radius);
    return sum / request_.worlds;
  }

  double torque() {
    double sum = 0;
    for (int w = 0; w < request_.worlds; ++w) sum += simulation_.motor_torque(w, quarter_[w].drive_motor.front());
    return sum / request_.worlds;
  }

  void set_speed(double speed) {
    for (int w = 0; w < request_.worlds; ++w)
      simulation_.set_motor(w, quarter_[w].drive_motor.front(), Real(speed / scene_.wheel().radius),
                            Real(vehicle::largest_drive_torque(scene_.quarter)));
  }

  /// `share`: of this sample in the means over time.
  void add_reports(WheelBenchResult& r, double share) {
    r.contacts = 0;
    for (int w = 0; w < request_.worlds; ++w) {
      const sim::StepReport report = simulation_.report(w);
      r.mean_iterations += report.iterations * share / request_.worlds;
      r.residual_rms += report.rms_residual * share / request_.worlds;
      r.residual_max = std::max(r.residual_max, report.max_residual);
      r.contacts += report.contact_count;
      if (r.fault.flags == 0) r.fault = report.fault;
    }
  }

  void set_slip(WheelBenchResult& r, const std::vector<Odometer>& from, const std::vector<Odometer>& to) const {
    std::vector<double> slip;
    for (int w = 0; w < request_.worlds; ++w)
      slip.push_back(1 - (to[w].x() - from[w].x()) / (to[w].rolled() - from[w].rolled()));
    const MeanError of_worlds = mean_error(slip);
    r.slip = of_worlds.mean;
    r.slip_error = of_worlds.error;
  }

  const WheelScene& scene_;
  const WheelBench& request_;
  sim::Simulation& simulation_;
  std::vector<vehicle::EngineVehicle> quarter_;
  double surface_;
};

/// The worlds differ in where their wheels are let down, so that their grains soon move differently.
double start_of_world(const WheelScene& scene, int world) {
  const double spacing = 0.618 * scene.bed.grain_diameter, stretch = scene.bed.length / 2;
  return 0.15 * scene.bed.length + std::fmod(world * spacing, stretch);
}

/// `request.step` 0: the step of penalty contact follows from the scene.
sim::StepSettings wheel_settings(const WheelScene& scene, const WheelBench& request, const sim::SceneWorld& world) {
  const terrain::Numerics numerics{.step = request.step,
                                   .substeps = request.substeps,
                                   .iterations = request.iterations,
                                   .tolerance = request.tolerance,
                                   .target = request.target,
                                   .contact = request.solver.contact,
                                   .overlap = request.overlap};
  sim::StepSettings settings = terrain::step_settings(scene.bed.grain_diameter, numerics);
  settings.iteration = request.solver.iteration;
  if (sim::is_penalty(request.solver.contact) && request.step == 0)
    settings.step = Real(0.9 * sim::critical_step(world, settings).step);
  return settings;
}

}  // namespace

WheelBenchResult bench_wheel(WheelBench request) {
  sim::require_backend(request.backend);
  const WheelScene scene = read_wheel_scene(request.scene);
  log_line("bench", "settling the bed, or reading it from " + request.packing_folder.string());
  const terrain::Packing packing =
      tilted(scene, terrain::cached_packing(scene.bed, request.packing_folder, request.threads), request);
  const double start = seconds();
  sim::SceneWorld bed = terrain::bed_world(packing, {scene.law, scene.law}, 4 * scene.wheel().radius);
  bed.gravity = tilted_gravity(scene.slope);
  sim::Scene worlds(std::size_t(request.worlds), bed);
  std::vector<vehicle::EngineVehicle> quarter;
  for (int w = 0; w < request.worlds; ++w) {
    const double x = start_of_world(scene, w), y = 0.5 * scene.bed.width;
    quarter.push_back(vehicle::add_vehicle(worlds[w], scene.quarter, {x, y, clear_height(scene, packing, x, y)},
                                           terrain::tool_material));
  }
  const sim::StepSettings settings = wheel_settings(scene, request, worlds.front());
  if (request.step == 0) request.step = settings.step;
  const auto simulation = sim::make_simulation(request.backend, worlds, settings, request.threads);
  simulation->advance(1);
  const double start_up = seconds() - start;
  const double surface =
      terrain::surface_height(terrain::lobes_of(packing), scene.bed.length, scene.bed.width, scene.bed.grain_diameter);
  Drive drive(scene, request, *simulation, std::move(quarter), surface);
  drive.park();
  drive.ramp();
  WheelBenchResult r = drive.drive();
  r.start_up = start_up;
  r.step = request.step;
  r.bodies = Index(worlds.front().body.size());
  if (r.fault.flags != 0) throw DeviceError("the wheel scene failed: " + sim::description(r.fault, request.step));
  return r;
}

}  // namespace gonogo::lab

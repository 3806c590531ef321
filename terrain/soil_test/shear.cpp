#include "terrain/soil_test/shear.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::terrain {
namespace {

constexpr double kSample = 0.05;     // travel between samples, in grain diameters
constexpr double kRecovery = 0.03;   // speed at which overlaps are pushed out, in diameters per stress time
constexpr double kNearLimit = 0.95;  // of the shear strength: beyond, its logarithm is noise
constexpr double kPressTimes = 12;   // stress times under load before the plate moves

double stress_time(const BedSpec& s, double stress) {
  return terrain::stress_time(s.grain_diameter, s.grain_density, stress);
}

/// The plate: glued grains like the base's, one body on rails with the mass of the bed below it. It keeps its speed
/// along x and is free along z only, where the load pushes it down.
sim::BodyIndex add_plate(sim::SceneWorld& world, const Packing& cell, const ShearSettings& settings) {
  const BedSpec& s = cell.spec;
  const double area = s.length * s.width, mass = cell.solid_fraction * s.grain_density * area * s.depth;
  sim::BodyState state;
  state.position = {0, 0, highest_point(cell) + s.grain_diameter / 2};
  const sim::BodyIndex plate = world.add_body(state, on_vertical_rails(mass));
  for (const Grain& g : cell.base) {
    sim::Shape shape;
    shape.body = plate;
    shape.material = base_material;
    shape.offset_B = {Real(g.position.x), Real(g.position.y), Real(-g.position.z - s.grain_diameter / 2)};
    shape.size = {Real(g.radius), 0, 0};
    world.add_shape(shape);
  }
  sim::ForceElement load;
  load.body = plate;
  load.force = {0, 0, Real(-settings.normal_stress * area)};
  load.ramp = 4 * stress_time(s, settings.normal_stress);
  world.force.push_back(load);
  return plate;
}

/// Steady stresses over the second half of the travel, peak of the running mean over half a diameter.
void summarise(const BedSpec&, ShearResult& r) {
  const std::size_t n = r.curve.size(), first = n / 2;
  std::vector<double> steady;
  double normal = 0;
  for (std::size_t k = first; k < n; ++k) {
    steady.push_back(r.curve[k].shear_stress);
    normal += r.curve[k].normal_stress / double(n - first);
  }
  double mean = 0, square = 0;
  for (const double t : steady) mean += t / double(steady.size());
  for (const double t : steady) square += (t - mean) * (t - mean) / double(steady.size());
  // Samples closer than half a diameter of travel are not independent.
  const double independent = std::max(2.0, 2 * kSample * double(steady.size()));
  r.shear_stress = mean;
  r.normal_stress = normal;
  r.scatter = std::sqrt(square / independent);
  const auto window = std::size_t(std::lround(0.5 / kSample));
  double running = 0;
  for (std::size_t k = 0; k < n; ++k) {
    running += r.curve[k].shear_stress;
    if (k >= window) running -= r.curve[k - window].shear_stress;
    if (k + 1 >= window) r.peak_stress = std::max(r.peak_stress, running / double(window));
  }
}

}  // namespace

BedSpec shear_cell(double grain_diameter, double settle_friction, std::uint64_t seed, GrainShape shape) {
  BedSpec s;
  s.grain_diameter = grain_diameter;
  s.length = 10 * grain_diameter;
  s.width = 6 * grain_diameter;
  s.depth = 8 * grain_diameter;
  s.settle_friction = settle_friction;
  s.seed = seed;
  s.shape = shape;
  return s;
}

Index shear_steps(const ShearSettings& s) {
  // The bed is eight grains deep: the plate needs travel * d / (I H / (d sqrt(rho / sigma))) for its way.
  return Index((kPressTimes + s.travel / (8 * s.inertial_number)) * s.steps_per_time);
}

ShearResult shear_test(const Packing& cell, const BedLaws& laws, const ShearSettings& settings, const TestPace& pace,
                       TestScene* scene) {
  const BedSpec& s = cell.spec;
  if (!(settings.normal_stress > 0)) throw InputError("shear test: the normal stress must be above zero");
  const double time = stress_time(s, settings.normal_stress), h = time / settings.steps_per_time;
  const double speed = settings.inertial_number * s.depth / time;
  sim::SceneWorld world = bed_world(cell, laws, 4 * s.grain_diameter);
  world.gravity = {};
  const sim::BodyIndex plate = add_plate(world, cell, settings);
  sim::StepSettings numerics = test_settings(s.grain_diameter, h, speed, pace);
  numerics.recovery_speed = Real(kRecovery * s.grain_diameter / time);
  TestRun run("shear test", std::move(world), numerics, pace);
  run.advance(Index(kPressTimes * settings.steps_per_time));
  run.set_velocity(plate, {Real(speed), 0, 0});
  const double start = run.body(plate).position.z, area = s.length * s.width;

  const Index stride = std::max<Index>(1, Index(std::lround(kSample * s.grain_diameter / speed / h)));
  const auto samples = std::size_t(std::lround(settings.travel / kSample));
  ShearResult r{};
  for (std::size_t k = 0; k < samples; ++k) {
    const Vec3d force = run.mean_force(plate, stride);
    r.curve.push_back({double(k + 1) * double(stride) * speed * h / s.grain_diameter, -force.x / area, force.z / area,
                       (run.body(plate).position.z - start) / s.grain_diameter});
  }
  summarise(s, r);
  r.dilation = r.curve.back().rise;
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

namespace {

/// Loads this close to each other say nothing of cohesion: then the line goes through the origin.
constexpr double kMinSpread = 1.5;

LineFit fit_strength(const std::vector<double>& normal, const std::vector<double>& shear) {
  const auto [lowest, highest] = std::minmax_element(normal.begin(), normal.end());
  if (*highest > kMinSpread * *lowest) return fit_line(normal, shear);
  std::vector<double> ratio;
  for (std::size_t k = 0; k < normal.size(); ++k) ratio.push_back(shear[k] / normal[k]);
  const MeanError mean = mean_error(ratio);
  LineFit line{};
  line.slope = mean.mean;
  line.slope_error = mean.error;
  return line;
}

}  // namespace

ShearStrength shear_strength(const std::vector<ShearResult>& results) {
  std::vector<double> normal, peak, steady;
  for (const ShearResult& r : results) {
    normal.push_back(r.normal_stress);
    peak.push_back(r.peak_stress);
    steady.push_back(r.shear_stress);
  }
  const LineFit p = fit_strength(normal, peak), q = fit_strength(normal, steady);
  return {.peak_angle = angle_of_tangent(p.slope, p.slope_error),
          .steady_angle = angle_of_tangent(q.slope, q.slope_error),
          .peak_cohesion = p.intercept,
          .peak_cohesion_error = p.intercept_error,
          .steady_cohesion = q.intercept,
          .steady_cohesion_error = q.intercept_error,
          .peak_r2 = p.r2,
          .steady_r2 = q.r2};
}

double fit_janosi(const std::vector<double>& displacement, const std::vector<double>& stress, double max_stress) {
  double above = 0, below = 0;
  for (std::size_t i = 0; i < displacement.size() && stress[i] < kNearLimit * max_stress; ++i) {
    const double left = 1 - stress[i] / max_stress, j = displacement[i];
    above += left * left * j * j;
    below += left * left * j * std::log(left);
  }
  if (!(below < 0))
    throw InputError(
        "shear test: the stress is at its limit from the first sample on, so that no K can be fitted; "
        "take finer grains");
  return -above / below;
}

}  // namespace gonogo::terrain

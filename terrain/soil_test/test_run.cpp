#include "terrain/soil_test/test_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "base/units.h"

namespace gonogo::terrain {

LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& weight) {
  GONOGO_ASSERT(x.size() == y.size() && (weight.empty() || weight.size() == x.size()));
  const auto w = [&](std::size_t i) { return weight.empty() ? 1.0 : weight[i]; };
  double sum = 0, mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += w(i);
    mean_x += w(i) * x[i];
    mean_y += w(i) * y[i];
  }
  mean_x /= sum;
  mean_y /= sum;
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - mean_x, dy = y[i] - mean_y;
    xx += w(i) * dx * dx;
    xy += w(i) * dx * dy;
    yy += w(i) * dy * dy;
  }
  LineFit f;
  f.slope = xy / xx;
  f.intercept = mean_y - f.slope * mean_x;
  const double left = std::max(0.0, yy - f.slope * xy);
  f.r2 = yy > 0 ? 1 - left / yy : 1;
  if (x.size() > 2) {
    const double variance = left / double(x.size() - 2);
    f.slope_error = std::sqrt(variance / xx);
    f.intercept_error = std::sqrt(variance * (1 / sum + mean_x * mean_x / xx));
  }
  return f;
}

Angle angle_of_tangent(double tangent, double error) {
  return {std::atan(tangent) / kDegree, error / (1 + tangent * tangent) / kDegree};
}

Angle angle_of_sine(double sine, double error) {
  const double s = std::clamp(sine, -1.0, 1.0);
  return {std::asin(s) / kDegree, error / std::sqrt(std::max(1e-12, 1 - s * s)) / kDegree};
}

namespace {

// Measured on beds of 10 x 6 x 8 grains (configs/soils/calibration_90mm.json): between the levels the logarithm of the
// settling friction is taken as linear in relative density.
constexpr double kLevelDensity[] = {0, 0.463, 1}, kLevelFriction[] = {0.8, 0.25, 0.02};

void require(bool good, const char* name, double value, const char* allowed) {
  if (!good) throw InputError(std::string("soil test: ") + name + " " + number_text(value) + " must be " + allowed);
}

}  // namespace

void check(const TestSoil& s) {
  require(s.grain_diameter >= 1e-4 && s.grain_diameter <= 1, "grain diameter", s.grain_diameter, "0.0001 to 1 m");
  require(s.grain.friction >= 0 && s.grain.friction <= 10, "sliding friction", s.grain.friction, "0 to 10");
  require(s.grain.rolling_friction >= 0 && s.grain.rolling_friction <= 10, "rolling friction", s.grain.rolling_friction,
          "0 to 10");
  require(s.grain.cohesion_pressure >= 0 && s.grain.cohesion_pressure <= 1e7, "cohesion pressure",
          s.grain.cohesion_pressure, "0 to 1e7 Pa");
  require(s.tool_friction >= 0 && s.tool_friction <= 10, "tool friction", s.tool_friction, "0 to 10");
  require(s.relative_density >= 0 && s.relative_density <= 1, "relative density", s.relative_density, "0 to 1");
  require(s.grain_density > 0 && s.grain_density <= 3e4, "grain density", s.grain_density,
          "above 0, at most 30000 kg/m3");
}

double settle_friction(double relative_density) {
  const int k = relative_density < kLevelDensity[1] ? 0 : 1;
  const double share = (relative_density - kLevelDensity[k]) / (kLevelDensity[k + 1] - kLevelDensity[k]);
  return kLevelFriction[k] * std::pow(kLevelFriction[k + 1] / kLevelFriction[k], std::clamp(share, 0.0, 1.0));
}

double relative_density_of(double friction) {
  const int k = friction > kLevelFriction[1] ? 0 : 1;
  const double share = std::log(friction / kLevelFriction[k]) / std::log(kLevelFriction[k + 1] / kLevelFriction[k]);
  return kLevelDensity[k] + std::clamp(share, 0.0, 1.0) * (kLevelDensity[k + 1] - kLevelDensity[k]);
}

BedSpec test_bed_spec(const TestSoil& soil, double grains_long, double grains_wide, double grains_deep) {
  check(soil);
  BedSpec s;
  s.grain_diameter = soil.grain_diameter;
  s.length = grains_long * soil.grain_diameter;
  s.width = grains_wide * soil.grain_diameter;
  s.depth = grains_deep * soil.grain_diameter;
  s.grain_density = soil.grain_density;
  s.settle_friction = settle_friction(soil.relative_density);
  s.seed = soil.seed;
  s.shape = soil.shape;
  s.settled_on = soil.settled_on;
  return s;
}

Packing test_bed(const TestSoil& soil, const BedSpec& spec, int threads) {
  return soil.packing_folder.empty() ? settle_packing(spec, threads)
                                     : cached_packing(spec, soil.packing_folder, threads);
}

Packing test_bed(const TestSoil& soil, double grains_long, double grains_wide, double grains_deep, int threads) {
  return test_bed(soil, test_bed_spec(soil, grains_long, grains_wide, grains_deep), threads);
}

TestPace pace_of(const Numerics& n) {
  TestPace pace;
  pace.substeps = n.substeps;
  pace.iterations = n.iterations;
  pace.target = n.target;
  pace.give = n.give;
  pace.residual = n.tolerance;
  if (n.tolerance == 0) pace.tolerance = 0;
  return pace;
}

sim::StepSettings test_settings(double grain_diameter, double step, double speed, const TestPace& pace) {
  const double residual = pace.residual > 0 ? pace.residual : pace.tolerance * speed;
  sim::StepSettings s = bed_step_settings(grain_diameter, step, pace.iterations, residual);
  s.substeps = pace.substeps;
  s.target = pace.target;
  s.give = Real(pace.give);
  return s;
}

double stress_time(double grain_diameter, double grain_density, double stress) {
  return grain_diameter * std::sqrt(grain_density / stress);
}

double gravity_time(double grain_diameter) { return std::sqrt(grain_diameter / kGravity); }

sim::BodyMass on_vertical_rails(double mass) {
  sim::BodyMass m;
  m.inverse_mass = {0, 0, Real(1 / mass)};
  return m;
}

TestRun::TestRun(std::string test, sim::SceneWorld world, const sim::StepSettings& settings, const TestPace& pace)
    : test_(std::move(test)),
      world_(std::move(world)),
      pace_(pace),
      step_(settings.step),
      seat_(pace.bench ? pace.bench->seat(world_, settings, pace.threads) : own_seat(world_, settings, pace.threads)) {}

std::vector<Vec3d> TestRun::take(Index steps, const std::vector<sim::BodyIndex>& measured) {
  stop_if_cancelled();
  const StepsTaken taken = seat_->take(steps, measured);
  if (taken.last.flags != 0)
    throw DeviceError(test_ + ": the simulation failed: " + sim::description(taken.last.fault, step_));
  worst_residual_ = std::max(worst_residual_, taken.worst_residual);
  if (pace_.on_steps) pace_.on_steps(steps);
  return taken.mean_force;
}

void TestRun::set_velocity(sim::BodyIndex b, const Vec3& velocity) {
  seat_->with([&](sim::Simulation& simulation, sim::WorldIndex w) {
    sim::BodyState state = simulation.body(w, b);
    state.velocity = velocity;
    simulation.set_body(w, b, state);
  });
}

sim::BodyState TestRun::body(sim::BodyIndex b) {
  sim::BodyState state;
  seat_->with([&](sim::Simulation& simulation, sim::WorldIndex w) { state = simulation.body(w, b); });
  return state;
}

std::vector<sim::BodyState> TestRun::bodies() {
  std::vector<sim::BodyState> states;
  seat_->with([&](sim::Simulation& simulation, sim::WorldIndex w) { states = simulation.bodies(w); });
  return states;
}

std::vector<sim::Contact> TestRun::contacts() {
  std::vector<sim::Contact> found;
  seat_->with([&](sim::Simulation& simulation, sim::WorldIndex w) { found = simulation.contacts(w); });
  return found;
}

std::vector<sim::Impulse> TestRun::impulses() {
  std::vector<sim::Impulse> found;
  seat_->with([&](sim::Simulation& simulation, sim::WorldIndex w) { found = simulation.impulses(w); });
  return found;
}

sim::Capture TestRun::capture() {
  sim::Capture capture;
  seat_->with([&](sim::Simulation& simulation, sim::WorldIndex w) { capture = sim::capture_world(simulation, w); });
  return capture;
}

double TestRun::rms_speed(std::size_t count) {
  const auto bodies = this->bodies();
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += dot(bodies[i].velocity, bodies[i].velocity);
  return std::sqrt(sum / double(std::max<std::size_t>(1, count)));
}

namespace {

constexpr double kStepsPerTime = 50;  // in sqrt(d / g)
constexpr Index kGeostaticSteps = 400, kMeanSteps = 50;

struct Cut {
  double z;       // height [m]
  double upward;  // force through it, mean [N]
};

/// Adds to every cut the force of the contacts between a body whose centre lies above it and one below; grains of the
/// base lie below all cuts.
void add_forces(TestRun& run, const std::vector<sim::BodyState>& bodies, Index grains, double weight,
                std::vector<Cut>& cuts) {
  const auto contacts = run.contacts();
  const auto impulses = run.impulses();
  const auto height = [&](sim::BodyIndex b) { return b < grains ? bodies[std::size_t(b)].position.z : -1e9; };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double a = height(contacts[i].body_a), b = height(contacts[i].body_b);
    // The impulse acts on body a; body b has its opposite.
    const double on_upper = (a > b ? 1 : -1) * double(impulses[i].linear.z);
    for (Cut& c : cuts)
      if (std::max(a, b) > c.z && std::min(a, b) <= c.z) c.upward += weight * on_upper;
  }
}

}  // namespace

GeostaticResult geostatic_test(const TestSoil& soil, double grains_deep, const TestPace& pace) {
  const double d = soil.grain_diameter, h = gravity_time(d) / kStepsPerTime;
  const Packing bed = test_bed(soil, 10, 6, grains_deep, pace.threads);
  const double area = bed.spec.length * bed.spec.width;
  sim::SceneWorld world = bed_world(bed, soil.laws(), 3 * d);
  TestRun run("geostatic test", std::move(world), test_settings(d, h, 0.1 * std::sqrt(kGravity * d), pace), pace);
  run.advance(kGeostaticSteps);
  std::vector<Cut> cuts;
  for (double depth = d; depth < bed.surface; depth += d) cuts.push_back({bed.surface - depth, 0});
  const auto grains = Index(bed.grain.size());
  for (Index k = 0; k < kMeanSteps; ++k) {
    run.advance(1);
    add_forces(run, run.bodies(), grains, 1 / (h * double(kMeanSteps)), cuts);
  }
  const auto bodies = run.bodies();
  GeostaticResult r;
  r.solid_fraction = bed.solid_fraction;
  for (const Cut& c : cuts) {
    double weight = 0;
    for (std::size_t i = 0; i < bed.grain.size(); ++i)
      if (bodies[i].position.z > c.z)
        weight += kGravity * soil.grain_density * kPi / 6 * std::pow(2 * bed.grain[i].radius, 3);
    r.profile.push_back({bed.surface - c.z, c.upward / area, weight / area});
    if (bed.surface - c.z > 2.5 * d) r.worst_error = std::max(r.worst_error, std::fabs(c.upward / weight - 1));
  }
  return r;
}

}  // namespace gonogo::terrain

#include "terrain/soil_test/strength_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/math/random.h"
#include "base/units.h"

namespace gonogo::terrain {

namespace {

constexpr double kShearSample = 0.05;    // travel between samples, in grain diameters
constexpr double kRecovery = 0.03;       // speed at which overlaps are pushed out, in diameters per stress time
constexpr double kNearLimit = 0.95;      // of the shear strength: beyond, its logarithm is noise
constexpr double kShearPressTimes = 12;  // stress times under load before the plate moves
constexpr double kPushTimes = 15;        // stress times in which the load along the plate of a creep test grows

double stress_time(const BedSpec& s, double stress) {
  return terrain::stress_time(s.grain_diameter, s.grain_density, stress);
}

/// The plate: glued grains like the base's, one body on rails with the mass of the bed below it. The load pushes it
/// down. Along x it keeps its speed, unless it is `free`.
sim::BodyIndex add_shear_plate(sim::SceneWorld& world, const Packing& cell, double normal_stress, bool free) {
  GONOGO_ASSERT(normal_stress > 0);
  const BedSpec& s = cell.spec;
  const double area = s.length * s.width, mass = cell.solid_fraction * s.grain_density * area * s.depth;
  sim::BodyState state;
  state.position = {0, 0, highest_point(cell) + s.grain_diameter / 2};
  sim::BodyMass rails = on_vertical_rails(mass);
  if (free) rails.inverse_mass.x = rails.inverse_mass.z;
  const sim::BodyIndex plate = world.add_body(state, rails);
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
  load.force = {0, 0, Real(-normal_stress * area)};
  load.ramp = 4 * stress_time(s, normal_stress);
  world.force.push_back(load);
  return plate;
}

/// `time`: the stress time; `speed`: of the plate [m/s].
sim::StepSettings shear_numerics(const BedSpec& s, double step, double time, double speed, const TestPace& pace) {
  GONOGO_ASSERT(time > 0);
  sim::StepSettings numerics = test_settings(s.grain_diameter, step, speed, pace);
  numerics.recovery_speed = Real(kRecovery * s.grain_diameter / time);
  return numerics;
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
  const double independent = std::max(2.0, 2 * kShearSample * double(steady.size()));
  r.shear_stress = mean;
  r.normal_stress = normal;
  r.scatter = std::sqrt(square / independent);
  const auto window = std::size_t(std::lround(0.5 / kShearSample));
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
  return Index((kShearPressTimes + s.travel / (8 * s.inertial_number)) * s.steps_per_time);
}

ShearResult shear_test(const Packing& cell, const BedLaws& laws, const ShearSettings& settings, const TestPace& pace,
                       TestScene* scene) {
  const BedSpec& s = cell.spec;
  if (!(settings.normal_stress > 0)) throw InputError("shear test: the normal stress must be above zero");
  const double time = stress_time(s, settings.normal_stress), h = time / settings.steps_per_time;
  const double speed = settings.inertial_number * s.depth / time;
  sim::SceneWorld world = bed_world(cell, laws, 4 * s.grain_diameter);
  world.gravity = {};
  const sim::BodyIndex plate = add_shear_plate(world, cell, settings.normal_stress, false);
  const sim::StepSettings numerics = shear_numerics(s, h, time, speed, pace);
  TestRun run("shear test", std::move(world), numerics, pace);
  run.advance(Index(kShearPressTimes * settings.steps_per_time));
  run.set_velocity(plate, {Real(speed), 0, 0});
  const double start = run.body(plate).position.z, area = s.length * s.width;

  const Index stride = std::max<Index>(1, Index(std::lround(kShearSample * s.grain_diameter / speed / h)));
  const auto samples = std::size_t(std::lround(settings.travel / kShearSample));
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

CreepResult creep_test(const Packing& cell, const BedLaws& laws, const CreepSettings& settings, const TestPace& pace) {
  const BedSpec& s = cell.spec;
  if (!(settings.normal_stress > 0)) throw InputError("creep test: the normal stress must be above zero");
  if (!(settings.time > 0)) throw InputError("creep test: the time must be above zero");
  const double time = stress_time(s, settings.normal_stress), h = time / settings.steps_per_time;
  sim::SceneWorld world = bed_world(cell, laws, 4 * s.grain_diameter);
  world.gravity = {};
  const sim::BodyIndex plate = add_shear_plate(world, cell, settings.normal_stress, true);
  sim::ForceElement push;
  push.body = plate;
  push.force = {Real(settings.share * settings.normal_stress * s.length * s.width), 0, 0};
  push.start = kShearPressTimes * time;
  push.ramp = kPushTimes * time;
  world.force.push_back(push);
  TestRun run("creep test", std::move(world), shear_numerics(s, h, time, s.grain_diameter / settings.time, pace), pace);
  double x = run.body(plate).position.x;
  // One step at a time, so that the plate does not pass a period unseen.
  const auto moved = [&](double seconds) {
    double way = 0;
    for (auto k = Index(std::lround(seconds / h)); k > 0; --k) {
      run.advance(1);
      const double now = run.body(plate).position.x;
      way += std::remainder(now - x, s.length);
      x = now;
    }
    return way / s.grain_diameter;
  };
  CreepResult r;
  r.way = moved((kShearPressTimes + kPushTimes) * time) + moved(settings.time / 2);
  const double late = moved(settings.time / 2);
  r.way += late;
  r.speed = late / (settings.time / 2);
  r.worst_residual = run.worst_residual();
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

namespace {

constexpr double kTriaxialPressTimes = 120;  // stress times of compression from all sides
constexpr double kRestTimes = 10;            // in which the grains take up their contact laws
constexpr double kStrainSample = 0.005;      // strain between samples
constexpr std::int32_t kPlatenGroup = 1;     // platens never touch each other
constexpr double kSizeSpread = 0.1;
enum Stream : std::uint64_t { radius_stream = 101, speed_stream, turn_stream };

struct Specimen {
  GrainShape shape;
  std::vector<Grain> grain;
  Vec3d size;           // inside of the box, one corner at the origin [m]
  double solid_volume;  // [m^3]
};

double stress_time(const TestSoil& soil, double stress) {
  return terrain::stress_time(soil.grain_diameter, soil.grain_density, stress);
}

Quat first_orientation(const TestSoil& soil, std::size_t grain) {
  if (soil.shape == GrainShape::sphere) return {};
  const auto u = [&](std::uint64_t k) { return random_unit(soil.seed, turn_stream, 3 * grain + k); };
  return random_orientation(u(0), u(1), u(2));
}

/// Grains on a lattice, so far apart that it is lost on the way together.
Specimen loose_specimen(const TestSoil& soil, const TriaxialSettings& settings) {
  const double d = soil.grain_diameter, pitch = 1.3 * clump_of(soil.shape, d).reach * (1 + kSizeSpread);
  Specimen s{soil.shape, {}, {}, 0};
  for (int k = 0; k < settings.grains_high; ++k)
    for (int j = 0; j < settings.grains_wide; ++j)
      for (int i = 0; i < settings.grains_wide; ++i) {
        const double u = random_unit(soil.seed, radius_stream, s.grain.size());
        const double radius = d / 2 * (1 + kSizeSpread * (2 * u - 1));
        const Quat turn = first_orientation(soil, s.grain.size());
        s.grain.push_back({{(i + 0.5) * pitch, (j + 0.5) * pitch, (k + 0.5) * pitch}, radius, turn});
        s.solid_volume += 4 * kPi / 3 * std::pow(radius, 3);
      }
  s.size = {settings.grains_wide * pitch, settings.grains_wide * pitch, settings.grains_high * pitch};
  return s;
}

/// Turns z to -x, -y, -z: inward normals of the platens that move.
constexpr double kHalf = std::numbers::sqrt2 / 2;
const std::array<Quat, 3> kInward = {Quat{Real(kHalf), 0, Real(-kHalf), 0}, Quat{Real(kHalf), Real(kHalf), 0, 0},
                                     Quat{0, 1, 0, 0}};
/// Turns z to x, y, z: of those that do not.
const std::array<Quat, 3> kOutward = {Quat{Real(kHalf), 0, Real(kHalf), 0}, Quat{Real(kHalf), Real(-kHalf), 0, 0},
                                      Quat{}};

double& part(Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

sim::Shape platen(sim::BodyIndex body, const Quat& turn) {
  sim::Shape plane;
  plane.type = sim::ShapeType::plane;
  plane.body = body;
  plane.material = tool_material;
  plane.group = kPlatenGroup;
  plane.turn_B = turn;
  return plane;
}

struct Box {
  sim::SceneWorld world;
  std::array<sim::BodyIndex, 3> moving;  // platens at the far x, y, z
};

/// The specimen between three fixed and three moving platens. Lateral ones are pushed by stress times their areas; the
/// top too, or it is held still, for its speed to be set.
Box boxed(const TestSoil& soil, const Specimen& s, const sim::PairLaw& law, double stress, bool push_top) {
  Box b;
  const double d = soil.grain_diameter;
  b.world.gravity = {};
  b.world.origin = {-2 * d, -2 * d, -2 * d};
  b.world.size = s.size * 1.6 + Vec3d{4 * d, 4 * d, 4 * d};
  b.world.set_law(grain_material, grain_material, law);
  b.world.set_law(grain_material, tool_material, {});
  for (const Grain& g : s.grain) add_grain(b.world, s.shape, g, soil.grain_density, grain_material);
  const sim::BodyIndex base = b.world.add_body({}, sim::fixed_body());
  for (const Quat& turn : kOutward) b.world.add_shape(platen(base, turn));
  const double mass = s.solid_volume * soil.grain_density;
  const std::array<double, 3> area = {s.size.y * s.size.z, s.size.x * s.size.z, s.size.x * s.size.y};
  for (int axis = 0; axis < 3; ++axis) {
    const bool pushed = axis < 2 || push_top;
    Vec3d place, inverse, force;
    part(place, axis) = axis == 0 ? s.size.x : axis == 1 ? s.size.y : s.size.z;
    part(inverse, axis) = pushed ? 1 / mass : 0;
    part(force, axis) = -stress * area[std::size_t(axis)];
    sim::BodyMass on_rails;
    on_rails.inverse_mass = static_cast<Vec3>(inverse);
    sim::BodyState state;
    state.position = place;
    const sim::BodyIndex body = b.world.add_body(state, on_rails);
    b.moving[std::size_t(axis)] = body;
    b.world.add_shape(platen(body, kInward[std::size_t(axis)]));
    if (!pushed) continue;
    sim::ForceElement load;
    load.body = body;
    load.force = static_cast<Vec3>(force);
    b.world.force.push_back(load);
  }
  return b;
}

void read_back(TestRun& run, const Box& box, Specimen& s) {
  const auto bodies = run.bodies();
  take_places(s.grain, s.shape, bodies);
  s.size = {bodies[std::size_t(box.moving[0])].position.x, bodies[std::size_t(box.moving[1])].position.y,
            bodies[std::size_t(box.moving[2])].position.z};
}

/// Compressed equally from all sides to the density that the settling friction gives. The loads follow the areas of the
/// final box, guessed at a solid fraction of 0.6 and corrected on the way.
Specimen compressed(const TestSoil& soil, const TriaxialSettings& settings, const TestPace& pace, double h) {
  Specimen s = loose_specimen(soil, settings);
  const sim::PairLaw slippery{Real(settle_friction(soil.relative_density)), 0, 0};
  const double pace_of_grains = 2 * soil.grain_diameter / stress_time(soil, settings.confining_stress);
  const double speed = 0.05 * pace_of_grains;  // of the solver's tolerance
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    Box box = boxed(soil, s, slippery, settings.confining_stress, true);
    for (std::size_t i = 0; round == 0 && i < s.grain.size(); ++i)
      box.world.body[i].velocity = {Real(pace_of_grains * (2 * random_unit(soil.seed, speed_stream, 3 * i) - 1)),
                                    Real(pace_of_grains * (2 * random_unit(soil.seed, speed_stream, 3 * i + 1) - 1)),
                                    Real(pace_of_grains * (2 * random_unit(soil.seed, speed_stream, 3 * i + 2) - 1))};
    TestRun run("triaxial test", box.world, test_settings(soil.grain_diameter, h, speed, pace), pace);
    run.advance(Index(kTriaxialPressTimes / rounds * settings.steps_per_time));
    read_back(run, box, s);
  }
  return s;
}

/// Stresses where the axial one is largest over the lateral one, and at the end.
void summarise(TriaxialResult& r, double strain) {
  const auto window = std::size_t(std::lround(0.03 / kStrainSample));
  double best = 0;
  for (std::size_t k = 0; k + window <= r.curve.size(); ++k) {
    double axial = 0, lateral = 0;
    for (std::size_t i = k; i < k + window; ++i) {
      axial += r.curve[i].axial_stress / double(window);
      lateral += r.curve[i].lateral_stress / double(window);
    }
    if (axial / lateral > best) {
      best = axial / lateral;
      r.peak_axial = axial;
      r.peak_lateral = lateral;
    }
  }
  double count = 0;
  for (const TriaxialSample& s : r.curve)
    if (s.strain > strain * 2 / 3) {
      r.steady_axial += s.axial_stress;
      r.steady_lateral += s.lateral_stress;
      ++count;
    }
  r.steady_axial /= count;
  r.steady_lateral /= count;
}

struct MohrCoulomb {
  Angle angle;
  double cohesion, cohesion_error;
};

/// Weighted mean.
double middle(const std::vector<double>& x, const std::vector<double>& weight) {
  double sum = 0, of_weights = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += weight[i] * x[i];
    of_weights += weight[i];
  }
  return sum / of_weights;
}

/// Axial over lateral stress, with weights by the fitted axial stress instead of the measured one, which would favour
/// weak specimens.
MohrCoulomb by_axial_stress(const std::vector<double>& axial, const std::vector<double>& lateral) {
  constexpr int rounds = 5;
  std::vector<double> fitted = axial, weight(axial.size());
  LineFit f;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < axial.size(); ++i) weight[i] = 1 / (fitted[i] * fitted[i]);
    f = fit_line(lateral, axial, weight);
    for (std::size_t i = 0; i < axial.size(); ++i) fitted[i] = f.intercept + f.slope * lateral[i];
  }
  const double n = f.slope, root = std::sqrt(n);
  // d phi / d N = 1 / (sqrt(N) (1 + N)); phi = 2 atan(sqrt(N)) - 90 degrees.
  const Angle angle{2 * std::atan(root) / kDegree - 90, f.slope_error / (root * (1 + n)) / kDegree};
  // c = b / (2 sqrt(N)), b the intercept, whose covariance with the slope is -mean(s3) var(N).
  const double by_intercept = 1 / (2 * root), by_slope = -f.intercept / (4 * n * root);
  const double covariance = -middle(lateral, weight) * f.slope_error * f.slope_error;
  const double variance = std::pow(by_intercept * f.intercept_error, 2) + std::pow(by_slope * f.slope_error, 2) +
                          2 * by_intercept * by_slope * covariance;
  return {angle, by_intercept * f.intercept, std::sqrt(std::max(0.0, variance))};
}

MohrCoulomb mohr_coulomb(const std::vector<double>& axial, const std::vector<double>& lateral, bool cohesive) {
  const bool two_stresses =
      *std::max_element(lateral.begin(), lateral.end()) > 1.5 * *std::min_element(lateral.begin(), lateral.end());
  if (cohesive && two_stresses) return by_axial_stress(axial, lateral);
  std::vector<double> sine;
  for (std::size_t i = 0; i < axial.size(); ++i) sine.push_back((axial[i] - lateral[i]) / (axial[i] + lateral[i]));
  const MeanError mean = mean_error(sine);
  return {angle_of_sine(mean.mean, mean.error), 0, 0};
}

}  // namespace

Index triaxial_steps(const TriaxialSettings& s) {
  return Index((kTriaxialPressTimes + kRestTimes + s.strain / s.inertial_number) * s.steps_per_time);
}

TriaxialResult triaxial_test(const TestSoil& soil, const TriaxialSettings& settings, const TestPace& pace,
                             TestScene* scene) {
  check(soil);
  if (!(settings.confining_stress > 0)) throw InputError("triaxial test: the confining stress must be above zero");
  const double time = stress_time(soil, settings.confining_stress), h = time / settings.steps_per_time;
  const Specimen s = compressed(soil, settings, pace, h);
  const Box box = boxed(soil, s, soil.grain, settings.confining_stress, false);
  const double rate = settings.inertial_number / time, speed = rate * s.size.z;
  // Tests of one height, whatever their specimens' size, have equal settings and share a batch.
  const double usual_speed = rate * settings.grains_high * soil.grain_diameter;
  TestRun run("triaxial test", box.world, test_settings(soil.grain_diameter, h, usual_speed, pace), pace);
  run.advance(Index(kRestTimes * settings.steps_per_time));
  run.set_velocity(box.moving[2], {0, 0, Real(-speed)});
  const double volume = s.size.x * s.size.y * s.size.z;
  const Index stride = std::max<Index>(1, Index(std::lround(kStrainSample / rate / h)));
  TriaxialResult r;
  r.solid_fraction = s.solid_volume / volume;
  const auto samples = std::size_t(std::lround(settings.strain / kStrainSample));
  for (std::size_t k = 0; k < samples; ++k) {
    const auto force = run.mean_forces({box.moving[0], box.moving[1], box.moving[2]}, stride);
    const double x = run.body(box.moving[0]).position.x, y = run.body(box.moving[1]).position.y,
                 z = run.body(box.moving[2]).position.z;
    const double lateral = (force[0].x / (y * z) + force[1].y / (x * z)) / 2;
    r.curve.push_back({1 - z / s.size.z, force[2].z / (x * y), lateral, x * y * z / volume - 1});
  }
  summarise(r, settings.strain);
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

TriaxialStrength triaxial_strength(const std::vector<TriaxialResult>& results, bool cohesive) {
  std::vector<double> peak_axial, peak_lateral, axial, lateral;
  for (const TriaxialResult& r : results) {
    peak_axial.push_back(r.peak_axial);
    peak_lateral.push_back(r.peak_lateral);
    axial.push_back(r.steady_axial);
    lateral.push_back(r.steady_lateral);
  }
  const MohrCoulomb peak = mohr_coulomb(peak_axial, peak_lateral, cohesive);
  const MohrCoulomb steady = mohr_coulomb(axial, lateral, cohesive);
  return {.peak_angle = peak.angle,
          .steady_angle = steady.angle,
          .peak_cohesion = peak.cohesion,
          .peak_cohesion_error = peak.cohesion_error,
          .steady_cohesion = steady.cohesion,
          .steady_cohesion_error = steady.cohesion_error};
}

}  // namespace gonogo::terrain

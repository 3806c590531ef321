#include "terrain/soil_test/penetration.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "sim/scene/scene.h"

namespace gonogo::terrain {

namespace {

constexpr Index kRestSteps = 100;        // in which the bed takes up its contact laws and a plate comes to lie on it
constexpr double kGrowth = 1.25;         // of the load from one of its steps to the next
constexpr Index kSamplesPerStep = 8;     // so that a plate that breaks in leaves a curve
constexpr double kWeightOfDatum = 0.25;  // pressure of the plate's own weight over that of the datum
constexpr double kSpeed = 0.05;          // of the plate, about, for the solver's tolerance [sqrt(g d)]

/// Pressures of the samples: the plate's weight first [Pa].
std::vector<double> pressures(const PlateSettings& s) {
  std::vector<double> p = {kWeightOfDatum * s.datum};
  while (p.back() < s.max_pressure) p.push_back(kGrowth * p.back());
  return p;
}

/// A plate one grain thick over the whole width of the periodic bed, above its highest grain, on vertical rails.
sim::BodyIndex add_pressed_plate(sim::SceneWorld& world, const Packing& bed, double width, double mass) {
  const BedSpec& s = bed.spec;
  sim::BodyState state;
  state.position = {s.length / 2, s.width / 2, highest_point(bed) + 0.51 * s.grain_diameter};
  const sim::BodyIndex plate = world.add_body(state, on_vertical_rails(mass));
  sim::Shape box;
  box.type = sim::ShapeType::box;
  box.body = plate;
  box.material = tool_material;
  box.size = {Real(width / 2), Real(s.width / 2), Real(s.grain_diameter / 2)};
  world.add_shape(box);
  return plate;
}

/// From one pressure to the next in `time` each, from `start` on [s].
void add_growing_load(sim::SceneWorld& world, sim::BodyIndex plate, const std::vector<double>& pressure, double area,
                      double start, double time) {
  for (std::size_t k = 0; k + 1 < pressure.size(); ++k) {
    sim::ForceElement more;
    more.body = plate;
    more.force = {0, 0, Real(-(pressure[k + 1] - pressure[k]) * area)};
    more.start = start + double(k) * time;
    more.ramp = time;
    world.force.push_back(more);
  }
}

/// Sinkage counts from the first sample that carries the datum.
void set_datum(PlateResult& r, double datum) {
  const auto at = std::find_if(r.curve.begin(), r.curve.end(), [&](const auto& s) { return s.pressure >= datum; });
  if (r.curve.end() - at < 4)
    throw DeviceError("plate test: the plate had sunk " + number_text(r.curve.back().sinkage) +
                      " m before it carried more than the datum of " + number_text(datum) +
                      " Pa; let it sink farther or lower the datum");
  const double zero = at->sinkage;
  for (PlateSample& s : r.curve) s.sinkage -= zero;
}

struct LogPoints {
  std::vector<double> z, p, weight;
};

/// Logarithms of sinkage and pressure past the datum and past a tenth of the sinkage, where single grains still rule.
LogPoints log_points(const PlateResult& plate) {
  LogPoints points;
  const double from = 0.1 * plate.curve.back().sinkage;
  for (const PlateSample& s : plate.curve)
    if (s.sinkage > from) {
      points.z.push_back(std::log(s.sinkage));
      points.p.push_back(std::log(s.pressure));
      points.weight.push_back(s.pressure * s.pressure);
    }
  if (points.z.size() < 3)
    throw DeviceError("plate test: under " + number_text(plate.curve.back().pressure) +
                      " Pa the plate broke into the bed by " + number_text(plate.curve.back().sinkage) +
                      " m, so that too few samples show a power law; let the load grow in smaller steps");
  return points;
}

/// Makes the plate's weights add up to 1, and appends its points to `all`, less their weighted mean.
void append_centred(LogPoints& plate, LogPoints& all) {
  double sum = 0, mean_z = 0, mean_p = 0;
  for (const double w : plate.weight) sum += w;
  for (double& w : plate.weight) w /= sum;
  for (std::size_t i = 0; i < plate.z.size(); ++i) {
    mean_z += plate.weight[i] * plate.z[i];
    mean_p += plate.weight[i] * plate.p[i];
  }
  for (std::size_t i = 0; i < plate.z.size(); ++i) {
    all.z.push_back(plate.z[i] - mean_z);
    all.p.push_back(plate.p[i] - mean_p);
    all.weight.push_back(plate.weight[i]);
  }
}

/// k of p = k z^n for one plate whose weights add up to 1, with its standard error.
MeanError modulus(const LogPoints& plate, double n) {
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < plate.z.size(); ++i) mean += plate.weight[i] * (plate.p[i] - n * plate.z[i]);
  for (std::size_t i = 0; i < plate.z.size(); ++i) {
    const double off = plate.p[i] - n * plate.z[i] - mean;
    square += plate.weight[i] * off * off;
  }
  return {std::exp(mean), std::exp(mean) * std::sqrt(square / double(plate.z.size() - 1))};
}

}  // namespace

Index plate_steps(const PlateSettings& s) {
  constexpr int usual_samples = 28;  // a soil that carries some hundred times the datum
  return kRestSteps + Index(usual_samples * s.growth_time * s.steps_per_time);
}

BedSpec plate_bed_spec(const TestSoil& soil, const PlateSettings& settings) {
  if (!(settings.width_grains >= 2)) throw InputError("plate test: the plate must be at least two grains wide");
  return test_bed_spec(soil, 6 * settings.width_grains, 6, std::max(8.0, settings.bed_depth * settings.width_grains));
}

Packing plate_bed(const TestSoil& soil, const PlateSettings& settings, int threads) {
  return test_bed(soil, plate_bed_spec(soil, settings), threads);
}

PlateResult plate_test(const Packing& bed, const TestSoil& soil, const PlateSettings& settings, const TestPace& pace,
                       TestScene* scene) {
  const double d = soil.grain_diameter, width = settings.width_grains * d, area = width * bed.spec.width;
  const double h = gravity_time(d) / settings.steps_per_time, speed = kSpeed * std::sqrt(kGravity * d);
  const auto between = std::max<Index>(1, Index(settings.growth_time * settings.steps_per_time) / kSamplesPerStep);
  const std::vector<double> pressure = pressures(settings);
  sim::SceneWorld world = bed_world(bed, soil.laws(), 3 * d);
  const sim::BodyIndex plate = add_pressed_plate(world, bed, width, pressure.front() * area / kGravity);
  add_growing_load(world, plate, pressure, area, double(kRestSteps) * h, double(kSamplesPerStep * between) * h);
  TestRun run("plate test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(kRestSteps);
  const double start = run.body(plate).position.z;
  PlateResult r;
  r.width = width;
  r.solid_fraction = bed.solid_fraction;
  const auto sample = [&](double p) {
    r.curve.push_back({start - run.body(plate).position.z, p});
    return r.curve.back().sinkage <= settings.sinkage * width;
  };
  bool goes_on = sample(pressure.front());
  for (std::size_t k = 0; goes_on && k + 1 < pressure.size(); ++k)
    for (Index part = 1; goes_on && part <= kSamplesPerStep; ++part) {
      run.advance(between);
      goes_on = sample(std::lerp(pressure[k], pressure[k + 1], double(part) / double(kSamplesPerStep)));
    }
  set_datum(r, settings.datum);
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

PowerLaw fit_power_law(const PlateResult& plate) {
  const LogPoints points = log_points(plate);
  const LineFit f = fit_line(points.z, points.p, points.weight);
  return {.k = std::exp(f.intercept), .n = f.slope, .k_error = f.intercept_error, .n_error = f.slope_error, .r2 = f.r2};
}

BekkerFit fit_bekker(const std::vector<PlateResult>& plates) {
  GONOGO_ASSERT(plates.size() >= 2);
  // The exponent in common: slope of ln p over ln z within plates, each plate with its own mean and equal say.
  LogPoints all;
  std::vector<LogPoints> each;
  for (const PlateResult& plate : plates) append_centred(each.emplace_back(log_points(plate)), all);
  const LineFit shared = fit_line(all.z, all.p, all.weight);
  BekkerFit b;
  b.n = shared.slope;
  b.n_error = shared.slope_error;
  b.r2 = shared.r2;
  // k of each plate at that exponent, then k = k_phi + k_c (1 / b).
  std::vector<double> inverse_width, k, k_error;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    const MeanError modulus_of_plate = modulus(each[i], b.n);
    inverse_width.push_back(1 / plates[i].width);
    k.push_back(modulus_of_plate.mean);
    k_error.push_back(modulus_of_plate.error);
  }
  const LineFit line = fit_line(inverse_width, k);
  b.k_phi = line.intercept;
  b.k_c = line.slope;
  if (plates.size() > 2) {
    b.k_phi_error = line.intercept_error;
    b.k_c_error = line.slope_error;
    return b;
  }
  const double spread = inverse_width[0] - inverse_width[1];
  b.k_c_error = std::hypot(k_error[0], k_error[1]) / std::fabs(spread);
  b.k_phi_error = std::hypot(k_error[0] * inverse_width[1], k_error[1] * inverse_width[0]) / std::fabs(spread);
  return b;
}

namespace {

constexpr int kSamples = 120;
constexpr int kDepths = 60;  // at which pressure is read for index and gradient
constexpr int kSides = 24;
constexpr double kShaftShare = 0.783;  // of the cone's diameter: 15.88 mm of 20.27 mm (ASAE S313)

/// Height of a 30 degree cone per diameter of its base.
double cone_height(double diameter) { return diameter / 2 / std::tan(to_radians(15)); }

/// A ring of corners; returns the index of its first.
Index add_ring(sim::TriangleMesh& mesh, double radius, double z) {
  const auto first = Index(mesh.vertex.size());
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * kPi * k / kSides;
    mesh.vertex.push_back({Real(radius * std::cos(angle)), Real(radius * std::sin(angle)), Real(z)});
  }
  return first;
}

/// The band between a ring and the one above it, seen from outside.
void add_band(sim::TriangleMesh& mesh, Index low, Index high) {
  for (int k = 0; k < kSides; ++k) {
    const int next = (k + 1) % kSides;
    mesh.triangle.push_back({low + k, low + next, high + next});
    mesh.triangle.push_back({low + k, high + next, high + k});
  }
}

double base_area(double diameter) { return kPi / 4 * diameter * diameter; }

/// A cone on vertical rails, as heavy as the soil under its base to a depth of one diameter, and what pushes it.
struct Penetrometer {
  sim::BodyIndex cone = 0, drive = 0;
};

Penetrometer add_penetrometer(sim::SceneWorld& world, const Packing& bed, double diameter, double shaft,
                              double unit_weight, double ring) {
  const double mass = unit_weight / kGravity * base_area(diameter) * diameter;
  const double stiffness = ring * unit_weight * base_area(diameter), damping = 2 * std::sqrt(stiffness * mass);
  sim::BodyState state;
  state.position = {bed.spec.length / 2, bed.spec.width / 2,
                    highest_point(bed) + cone_height(diameter) + 0.01 * bed.spec.grain_diameter};
  Penetrometer p;
  p.cone = world.add_body(state, on_vertical_rails(mass));
  p.drive = world.add_body(state, sim::fixed_body());
  sim::Shape shape;
  shape.type = sim::ShapeType::mesh;
  shape.body = p.cone;
  shape.material = tool_material;
  shape.surface = world.add_mesh(cone_mesh(diameter, shaft));
  world.add_shape(shape);
  const Vec3d at = state.position;
  world.spring.push_back(sim::spring_along(world, p.cone, p.drive, at, at, {0, 0, 1}, stiffness, damping));
  return p;
}

/// Pressures of the curve at even depths down to `end`, in straight lines between its samples.
std::vector<ConeSample> even_depths(const std::vector<ConeSample>& curve, double end) {
  std::vector<ConeSample> profile;
  std::size_t next = 1;
  for (int k = 0; k <= kDepths; ++k) {
    const double z = end * k / kDepths;
    while (next + 1 < curve.size() && curve[next].depth < z) ++next;
    const ConeSample &a = curve[next - 1], &b = curve[next];
    const double share = b.depth > a.depth ? std::clamp((z - a.depth) / (b.depth - a.depth), 0.0, 1.0) : 1;
    profile.push_back({z, a.pressure + share * (b.pressure - a.pressure)});
  }
  return profile;
}

}  // namespace

sim::TriangleMesh cone_mesh(double diameter, double shaft_length) {
  sim::TriangleMesh mesh;
  mesh.name = "cone";
  mesh.vertex.push_back({0, 0, Real(-cone_height(diameter))});
  const Index base = add_ring(mesh, diameter / 2, 0);
  for (int k = 0; k < kSides; ++k) mesh.triangle.push_back({0, base + (k + 1) % kSides, base + k});
  const Index shaft = add_ring(mesh, kShaftShare * diameter / 2, 0.1 * diameter);
  const Index top = add_ring(mesh, kShaftShare * diameter / 2, shaft_length);
  add_band(mesh, base, shaft);
  add_band(mesh, shaft, top);
  const auto middle = Index(mesh.vertex.size());
  mesh.vertex.push_back({0, 0, Real(shaft_length)});
  for (int k = 0; k < kSides; ++k) mesh.triangle.push_back({middle, top + k, top + (k + 1) % kSides});
  return mesh;
}

Index cone_steps(const ConeSettings& s) {
  constexpr double usual_pressure = 80;  // at the end, in unit weights times cone diameters: how far the spring gives
  const double way = (s.depth + cone_height(1) + usual_pressure / s.ring) * s.diameter_grains + 0.5;
  return kRestSteps + Index(way / s.speed * s.steps_per_time);
}

BedSpec cone_bed_spec(const TestSoil& soil, const ConeSettings& settings) {
  if (!(settings.diameter_grains >= 2)) throw InputError("cone test: the cone must be at least two grains wide");
  const double wide = 4.5 * settings.diameter_grains;
  const double deep = std::ceil((settings.depth + cone_height(1)) * settings.diameter_grains + 4);
  return test_bed_spec(soil, wide, wide, deep);
}

ConeResult cone_test(const Packing& bed, const TestSoil& soil, const ConeSettings& settings, const TestPace& pace,
                     TestScene* scene) {
  const double d = soil.grain_diameter, diameter = settings.diameter_grains * d;
  const double tip = cone_height(diameter), shaft = 2 * settings.depth * diameter + 2 * d;
  const double h = gravity_time(d) / settings.steps_per_time, speed = settings.speed * std::sqrt(kGravity * d);
  ConeResult r;
  r.diameter = diameter;
  r.bulk_density = bed.solid_fraction * soil.grain_density;
  sim::SceneWorld world = bed_world(bed, soil.laws(), tip + shaft + 2 * d);
  const Penetrometer p = add_penetrometer(world, bed, diameter, shaft, r.bulk_density * kGravity, settings.ring);
  TestRun run("cone test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(kRestSteps);
  run.set_velocity(p.drive, {0, 0, Real(-speed)});
  const Index stride = std::max<Index>(1, (cone_steps(settings) - kRestSteps) / kSamples);
  const double end = settings.depth * diameter;
  do {
    const double before = bed.surface - run.body(p.cone).position.z;
    const Vec3d force = run.mean_force(p.cone, stride);
    r.curve.push_back({(before + bed.surface - run.body(p.cone).position.z) / 2, force.z / base_area(diameter)});
    if (r.curve.back().pressure > settings.max_pressure)
      throw DeviceError("cone test: the soil bears " + number_text(r.curve.back().pressure) +
                        " Pa with the cone's base " + number_text(r.curve.back().depth) +
                        " m below the surface; it is too strong for the test");
  } while (r.curve.back().depth < end);
  r.profile = even_depths(r.curve, end);
  for (const ConeSample& s : r.profile) r.index += s.pressure / double(r.profile.size());
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

std::vector<ConeSample> mean_profile(const std::vector<ConeResult>& tests) {
  std::vector<ConeSample> mean(tests.at(0).profile.size(), {0, 0});
  for (std::size_t k = 0; k < mean.size(); ++k) {
    mean[k].depth = tests[0].profile[k].depth;
    for (const ConeResult& t : tests) mean[k].pressure += t.profile[k].pressure / double(tests.size());
  }
  return mean;
}

LineFit fit_cone(const std::vector<ConeResult>& tests) {
  std::vector<double> depth, pressure;
  for (const ConeSample& s : mean_profile(tests)) {
    depth.push_back(s.depth);
    pressure.push_back(s.pressure);
  }
  return fit_line(depth, pressure);
}

double proportional_gradient(const ConeResult& test) {
  double product = 0, square = 0;
  for (const ConeSample& s : test.profile) {
    const double depth = s.depth + cone_height(test.diameter) / 3;
    product += s.pressure * depth;
    square += depth * depth;
  }
  return product / square;
}

}  // namespace gonogo::terrain

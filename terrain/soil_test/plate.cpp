#include "terrain/soil_test/plate.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/gravity.h"

namespace gonogo::terrain {
namespace {

constexpr Index kRestSteps = 100;  // in which the bed takes up its contact laws
constexpr int kSamples = 50;

/// A plate one grain thick over the whole width of the periodic bed, above its highest grain.
sim::BodyIndex add_plate(sim::SceneWorld& world, const Packing& bed, double width) {
  const BedSpec& s = bed.spec;
  sim::BodyState state;
  state.position = {s.length / 2, s.width / 2, highest_point(bed) + 0.51 * s.grain_diameter};
  const sim::BodyIndex plate = world.add_body(state, sim::fixed_body());
  sim::Shape box;
  box.type = sim::ShapeType::box;
  box.body = plate;
  box.material = tool_material;
  box.size = {Real(width / 2), Real(s.width / 2), Real(s.grain_diameter / 2)};
  world.add_shape(box);
  return plate;
}

/// Sinkage counts from the first sample that carries the datum together with those behind it: one sample alone may be a
/// single grain under the plate, or a moment in which it gives way.
void set_datum(PlateResult& r, double datum) {
  constexpr std::size_t together = 4;
  std::size_t first = 0;
  double running = 0;
  for (std::size_t k = 0; k < r.curve.size(); ++k) {
    running += r.curve[k].pressure;
    if (k >= together) running -= r.curve[k - together].pressure;
    if (k + 1 < together || !(running > double(together) * datum)) continue;
    first = k + 1 - together;
    break;
  }
  if (!(running > double(together) * datum) || first + 2 * together > r.curve.size())
    throw DeviceError("plate test: the bed did not carry the datum of " + std::to_string(datum) +
                      " Pa; press further or lower the datum");
  const double zero = first > 0 ? r.curve[first - 1].sinkage : 0;
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
    if (s.sinkage > from && s.pressure > 0) {
      points.z.push_back(std::log(s.sinkage)), points.p.push_back(std::log(s.pressure));
      points.weight.push_back(s.pressure * s.pressure);
    }
  return points;
}

}  // namespace

Index plate_steps(const PlateSettings& s) {
  return kRestSteps + Index((s.width_grains * s.sinkage + 1) / s.speed * s.steps_per_time);
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
  const double d = soil.grain_diameter, width = settings.width_grains * d;
  sim::SceneWorld world = bed_world(bed, soil.laws(), 3 * d);
  const sim::BodyIndex plate = add_plate(world, bed, width);
  const double h = gravity_time(d) / settings.steps_per_time, speed = settings.speed * std::sqrt(kGravity * d);
  TestRun run("plate test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(kRestSteps);
  run.set_velocity(plate, {0, 0, Real(-speed)});
  const double start = run.body(plate).position.z, area = width * bed.spec.width;
  const Index stride = std::max<Index>(1, (plate_steps(settings) - kRestSteps) / kSamples);
  PlateResult r;
  r.width = width, r.solid_fraction = bed.solid_fraction;
  for (int k = 0; k < kSamples; ++k) {
    const double before = start - run.body(plate).position.z;
    const Vec3d force = run.mean_force(plate, stride);
    r.curve.push_back({(before + start - run.body(plate).position.z) / 2, force.z / area});
  }
  set_datum(r, settings.datum);
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

PowerLaw fit_power_law(const PlateResult& plate) {
  const LogPoints points = log_points(plate);
  const LineFit f = fit_line(points.z, points.p, points.weight);
  return {std::exp(f.intercept), f.slope, f.intercept_error, f.slope_error, f.r2};
}

BekkerFit fit_bekker(const std::vector<PlateResult>& plates) {
  GONOGO_ASSERT(plates.size() >= 2);
  // The exponent in common: slope of ln p over ln z within plates, each plate with its own mean and equal say.
  std::vector<double> z, p, weight;
  std::vector<LogPoints> each;
  for (const PlateResult& plate : plates) {
    LogPoints l = log_points(plate);
    double sum = 0, mean_z = 0, mean_p = 0;
    for (const double w : l.weight) sum += w;
    for (double& w : l.weight) w /= sum;
    for (std::size_t i = 0; i < l.z.size(); ++i) mean_z += l.weight[i] * l.z[i], mean_p += l.weight[i] * l.p[i];
    for (std::size_t i = 0; i < l.z.size(); ++i) {
      z.push_back(l.z[i] - mean_z), p.push_back(l.p[i] - mean_p), weight.push_back(l.weight[i]);
    }
    each.push_back(l);
  }
  const LineFit shared = fit_line(z, p, weight);
  BekkerFit b;
  b.n = shared.slope, b.n_error = shared.slope_error, b.r2 = shared.r2;
  // k of each plate at that exponent, then k = k_phi + k_c (1 / b).
  std::vector<double> inverse_width, k, k_error;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    double mean = 0, square = 0;
    for (std::size_t j = 0; j < each[i].z.size(); ++j) mean += each[i].weight[j] * (each[i].p[j] - b.n * each[i].z[j]);
    for (std::size_t j = 0; j < each[i].z.size(); ++j) {
      const double off = each[i].p[j] - b.n * each[i].z[j] - mean;
      square += each[i].weight[j] * off * off;
    }
    inverse_width.push_back(1 / plates[i].width);
    k.push_back(std::exp(mean));
    k_error.push_back(std::exp(mean) * std::sqrt(square / double(each[i].z.size() - 1)));
  }
  const LineFit line = fit_line(inverse_width, k);
  b.k_phi = line.intercept, b.k_c = line.slope;
  if (plates.size() > 2) {
    b.k_phi_error = line.intercept_error, b.k_c_error = line.slope_error;
    return b;
  }
  const double spread = inverse_width[0] - inverse_width[1];
  b.k_c_error = std::hypot(k_error[0], k_error[1]) / std::fabs(spread);
  b.k_phi_error = std::hypot(k_error[0] * inverse_width[1], k_error[1] * inverse_width[0]) / std::fabs(spread);
  return b;
}

}  // namespace gonogo::terrain

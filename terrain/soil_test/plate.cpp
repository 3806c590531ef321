#include "terrain/soil_test/plate.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::terrain {
namespace {

constexpr Index kRestSteps = 100;        // in which the bed takes up its contact laws and the plate comes to lie on it
constexpr double kGrowth = 1.25;         // of the load from one sample to the next
constexpr double kWeightOfDatum = 0.25;  // pressure of the plate's own weight over that of the datum
constexpr double kSpeed = 0.05;          // of the plate, about, for the solver's tolerance [sqrt(g d)]

/// Pressures of the samples: the plate's weight first [Pa].
std::vector<double> pressures(const PlateSettings& s) {
  std::vector<double> p = {kWeightOfDatum * s.datum};
  while (p.back() < s.max_pressure) p.push_back(kGrowth * p.back());
  return p;
}

/// A plate one grain thick over the whole width of the periodic bed, above its highest grain, on vertical rails.
sim::BodyIndex add_plate(sim::SceneWorld& world, const Packing& bed, double width, double mass) {
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
  const auto stride = std::max<Index>(1, Index(settings.growth_time * settings.steps_per_time));
  const std::vector<double> pressure = pressures(settings);
  sim::SceneWorld world = bed_world(bed, soil.laws(), 3 * d);
  const sim::BodyIndex plate = add_plate(world, bed, width, pressure.front() * area / kGravity);
  add_growing_load(world, plate, pressure, area, double(kRestSteps) * h, double(stride) * h);
  TestRun run("plate test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(kRestSteps);
  const double start = run.body(plate).position.z;
  PlateResult r;
  r.width = width;
  r.solid_fraction = bed.solid_fraction;
  for (std::size_t k = 0; k < pressure.size(); ++k) {
    const double sunk = start - run.body(plate).position.z;
    r.curve.push_back({sunk, pressure[k]});
    if (sunk > settings.sinkage * width || k + 1 == pressure.size()) break;
    run.advance(stride);
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

}  // namespace gonogo::terrain

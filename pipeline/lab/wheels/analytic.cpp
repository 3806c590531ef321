#include "pipeline/lab/wheels/analytic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::lab {
namespace {

using vehicle::BekkerSoil;
using vehicle::RigidWheel;
using vehicle::WheelForces;
using vehicle::WheelMotion;

/// Sets one number of a soil.
using Setter = std::function<void(BekkerSoil&, double)>;

void add_ends(BekkerCases& cases, const terrain::SoilValue& value, const Setter& set) {
  if (value.fixed()) return;
  for (const double end : {value.low, value.high}) {
    cases.soil.push_back(cases.soil.front());
    set(cases.soil.back(), end);
  }
}

/// Slip at the tips from the benchmark's, which may count at the rim, and (w r - v) / max(w r, v) when braked.
double slip_at_tips(const Benchmark& b, const vehicle::Wheel& w, double slip) {
  const double led = slip < 0 ? slip / (1 + slip) : slip;
  return 1 - (1 - slip_of_rim(b, w, led)) * w.radius / (w.radius + w.lug_height);
}

double slip_from_tips(const Benchmark& b, const vehicle::Wheel& w, double slip) {
  return slip_from_rim(b, w, 1 - (1 - slip) * (w.radius + w.lug_height) / w.radius);
}

std::map<Quantity, double> values_of(const Benchmark& b, const vehicle::Wheel& w, const WheelForces& f) {
  return {{Quantity::pull, f.drawbar_pull},
          {Quantity::traction_slope, std::atan(f.drawbar_pull / f.load) / kDegree},
          {Quantity::side_force, f.side},
          {Quantity::torque, f.torque},
          {Quantity::sinkage, sinkage_from_tips(b, w, f.sinkage)}};
}

/// The least slip that climbs: pull over load rises with slip up to the optimum, which a scan finds first.
std::pair<double, WheelForces> forces_on_slope(const BekkerSoil& soil, const RigidWheel& wheel, double load,
                                               double needed) {
  constexpr int kParts = 50;
  constexpr double kFrom = -0.5, kTo = 1;
  const auto at = [&](double slip) { return vehicle::wheel_forces_under(soil, wheel, {slip, 0}, load); };
  const auto slip_of = [&](int k) { return kFrom + (kTo - kFrom) * k / kParts; };
  for (int k = 0; k <= kParts; ++k) {
    if (at(slip_of(k)).drawbar_pull < needed) continue;
    double low = k > 0 ? slip_of(k - 1) : kFrom, high = slip_of(k);
    for (int i = 0; i < 20; ++i) {
      const double middle = 0.5 * (low + high);
      (at(middle).drawbar_pull < needed ? low : high) = middle;
    }
    return {high, at(high)};
  }
  return {kTo, at(kTo)};
}

std::map<Quantity, double> predict(const Benchmark& b, const BenchmarkPoint& p, const BekkerSoil& soil) {
  const vehicle::Wheel& w = wheel_of(b);
  const RigidWheel wheel{w.radius, w.width, w.lug_height};
  const double load = load_at(b, p);
  if (b.leads(Quantity::slope)) {
    const double needed = load * std::tan(to_radians(p.led.at(Quantity::slope)));
    const auto [slip, forces] = forces_on_slope(soil, wheel, load, needed);
    return {{Quantity::slip, slip < 1 ? slip_from_tips(b, w, slip) : 1},
            {Quantity::sinkage, sinkage_from_tips(b, w, forces.sinkage)},
            {Quantity::torque, forces.torque}};
  }
  const double angle = b.leads(Quantity::slip_angle) ? to_radians(p.led.at(Quantity::slip_angle)) : 0;
  const WheelMotion motion{slip_at_tips(b, w, p.led.at(Quantity::slip)), angle};
  return values_of(b, w, vehicle::wheel_forces_under(soil, wheel, motion, load));
}

}  // namespace

std::optional<BekkerCases> measured_numbers(const Benchmark& b) {
  const terrain::SoilState& s = b.soil;
  if (!s.bekker || !s.janosi) return std::nullopt;
  const terrain::MacroscopicSoil sheared = terrain::on_shear_plane(acting_soil(b, s.macroscopic()));
  BekkerCases cases{{BekkerSoil{.n = s.bekker->n.middle(),
                                .k_c = 1e3 * s.bekker->k_c.middle(),
                                .k_phi = 1e3 * s.bekker->k_phi.middle(),
                                .cohesion = sheared.cohesion,
                                .friction_angle = to_radians(sheared.friction_angle),
                                .shear_modulus = 1e-3 * s.janosi->middle(),
                                .unit_weight = kGravity * s.bulk_density.middle()}}};
  add_ends(cases, s.bekker->n, [](BekkerSoil& soil, double x) { soil.n = x; });
  add_ends(cases, s.bekker->k_c, [](BekkerSoil& soil, double x) { soil.k_c = 1e3 * x; });
  add_ends(cases, s.bekker->k_phi, [](BekkerSoil& soil, double x) { soil.k_phi = 1e3 * x; });
  const double ratio = s.cohesion.middle() > 0 ? sheared.cohesion / (1e3 * s.cohesion.middle()) : 1;
  add_ends(cases, s.cohesion, [ratio](BekkerSoil& soil, double x) { soil.cohesion = 1e3 * x * ratio; });
  add_ends(cases, s.friction_angle, [&](BekkerSoil& soil, double x) {
    terrain::MacroscopicSoil end = s.macroscopic();
    end.friction_angle = x;
    soil.friction_angle = to_radians(terrain::on_shear_plane(acting_soil(b, end)).friction_angle);
  });
  add_ends(cases, *s.janosi, [](BekkerSoil& soil, double x) { soil.shear_modulus = 1e-3 * x; });
  return cases;
}

BekkerCases exported_numbers(const inspect::SoilNumbers& n) {
  using inspect::Measure;
  const auto soil_of = [&](const Measure& expo, const Measure& cohesion, const Measure& angle, const Measure& k) {
    return BekkerSoil{.n = expo.value,
                      .k_c = n.k_c.value,
                      .k_phi = n.k_phi.value,
                      .cohesion = std::max(0.0, cohesion.value),
                      .friction_angle = to_radians(angle.value),
                      .shear_modulus = k.value,
                      .unit_weight = kGravity * n.bulk_density};
  };
  BekkerCases cases{{soil_of(n.n, n.cohesion, n.friction_angle, n.janosi)}};
  for (const double sign : {-1.0, 1.0}) {
    const auto moved = [&](const Measure& m) { return Measure{m.value + sign * m.error, m.error}; };
    cases.soil.push_back(soil_of(n.n, moved(n.cohesion), n.friction_angle, n.janosi));
    cases.soil.push_back(soil_of(n.n, n.cohesion, moved(n.friction_angle), n.janosi));
    // K's error may be as large as itself; a K of zero or less has no meaning.
    Measure k = moved(n.janosi);
    k.value = std::max(k.value, 0.1 * n.janosi.value);
    cases.soil.push_back(soil_of(n.n, n.cohesion, n.friction_angle, k));
    BekkerSoil stiff = cases.soil.front();
    stiff.k_phi = std::max(0.1 * n.k_phi.value, n.k_phi.value + sign * n.k_phi.error);
    cases.soil.push_back(stiff);
  }
  return cases;
}

Predictor analytic_predictor(const Benchmark& b, const BekkerCases& cases, const std::string& name,
                             const std::string& about) {
  Predictor predictor{name, about, {}};
  for (const BenchmarkPoint& p : b.point) {
    auto& at = predictor.point.emplace_back();
    for (std::size_t k = 0; k < cases.soil.size(); ++k) {
      std::map<Quantity, double> values;
      try {
        values = predict(b, p, cases.soil[k]);
      } catch (const InputError&) {
        if (k == 0) break;  // the wheel sinks to its axle: no prediction
        continue;
      }
      for (const auto& [quantity, value] : values) {
        if (k == 0) at[quantity] = {value, 0, value, value};
        Predicted& q = at[quantity];
        q.low = std::min(q.low, value);
        q.high = std::max(q.high, value);
      }
    }
  }
  return predictor;
}

}  // namespace gonogo::lab

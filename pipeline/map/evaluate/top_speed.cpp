#include "pipeline/map/evaluate/top_speed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/units.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {
namespace {

constexpr std::size_t kFewestTrials = 12;
constexpr std::size_t kTerms = 4;  // constant, rut, slip, speed
constexpr double kMaxSlip = 0.95;

using Row = std::array<double, kTerms>;
using Square = std::array<std::array<double, kTerms + 1>, kTerms>;

Row row_of(const ResistanceTrial& t) { return {1, t.rut, t.slip, t.speed}; }

/// Gauss-Jordan with pivots on the normal equations, a little ridge added so that terms that never vary get no weight.
Row solve(Square a) {
  for (std::size_t k = 0; k < kTerms; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < kTerms; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    for (std::size_t i = 0; i < kTerms; ++i) {
      if (i == k) continue;
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j <= kTerms; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  Row x{};
  for (std::size_t k = 0; k < kTerms; ++k) x[k] = a[k][kTerms] / a[k][k];
  return x;
}

Row least_squares(std::span<const ResistanceTrial> trials) {
  Square a{};
  for (const ResistanceTrial& t : trials) {
    const Row row = row_of(t);
    for (std::size_t i = 0; i < kTerms; ++i) {
      for (std::size_t j = 0; j < kTerms; ++j) a[i][j] += row[i] * row[j];
      a[i][kTerms] += row[i] * t.resistance;
    }
  }
  for (std::size_t i = 1; i < kTerms; ++i) a[i][i] += 1e-9 * double(trials.size());
  return solve(a);
}

}  // namespace

double ResistanceFit::at(double rut, double slip, double tread_speed) const {
  const double value = constant + per_rut * rut + per_slip * slip + per_speed * std::min(tread_speed, fastest);
  return std::clamp(value, lowest, highest);
}

ResistanceFit fit_resistance(std::span<const ResistanceTrial> trials) {
  ResistanceFit fit;
  fit.trials = trials.size();
  if (trials.empty()) return fit;
  const auto of = [&](double ResistanceTrial::*member, auto pick) {
    double value = trials.front().*member;
    for (const ResistanceTrial& t : trials) value = pick(value, t.*member);
    return value;
  };
  const auto smaller = [](double a, double b) { return std::min(a, b); };
  const auto larger = [](double a, double b) { return std::max(a, b); };
  fit.lowest = of(&ResistanceTrial::resistance, smaller);
  fit.highest = of(&ResistanceTrial::resistance, larger);
  fit.fastest = of(&ResistanceTrial::speed, larger);
  double mean = 0;
  for (const ResistanceTrial& t : trials) mean += t.resistance / double(trials.size());
  fit.constant = mean;
  if (trials.size() >= kFewestTrials) {
    const Row x = least_squares(trials);
    fit.constant = x[0];
    fit.per_rut = x[1];
    fit.per_slip = x[2];
    fit.per_speed = x[3];
  }
  double residual = 0, deviation = 0;
  for (const ResistanceTrial& t : trials) {
    residual += std::pow(t.resistance - fit.at(t.rut, t.slip, t.speed), 2) / double(trials.size());
    deviation += std::pow(t.resistance - mean, 2) / double(trials.size());
  }
  fit.error = std::sqrt(residual);
  fit.spread = std::sqrt(deviation);
  return fit;
}

double SpeedModel::rut(double sinks, double load) const {
  return std::max(0.0, sinks - (tyre_stiffness > 0 ? load / tyre_stiffness : 0));
}

SoilSpeed::SoilSpeed(const SpeedModel& model, const std::vector<std::vector<double>>& points, double max_speed)
    : model_(model),
      slip_(on_soil(model.slip, points)),
      sinkage_(on_soil(model.sinkage, points)),
      max_speed_(max_speed) {
  const std::size_t payload = campaign::contract().variable_index("payload");
  for (const std::vector<double>& point : points)
    payload_ += (std::isnan(point[payload]) ? model.slip.middle[payload] : point[payload]) / double(points.size());
}

double SoilSpeed::at(BedSlopes slopes) const {
  const double along = std::tan(to_radians(slopes.along)), across = std::tan(to_radians(slopes.across));
  const double load = (model_.mass + payload_) * model_.gravity / std::sqrt(1 + along * along + across * across);
  const double slip = std::clamp(slip_.at(slopes), 0.0, kMaxSlip), rut = model_.rut(sinkage_.at(slopes), load);
  const double sampled = (1 - slip) * model_.resistance.fastest;
  const auto needed = [&](double tread_speed) {
    const double speed = (1 - slip) * tread_speed;
    const double thrown = std::max(0.0, speed * speed - sampled * sampled) * model_.rut_width * rut * kThrownDensity;
    return load * (std::max(0.0, along) + model_.resistance.at(rut, slip, tread_speed)) + thrown;
  };
  return std::clamp((1 - slip) * model_.drive.balance(needed), kMinSpeed, std::max(kMinSpeed, max_speed_));
}

}  // namespace gonogo::map

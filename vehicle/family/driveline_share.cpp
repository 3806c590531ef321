#include "vehicle/family/driveline_share.h"

#include <algorithm>
#include <cmath>

#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

constexpr double kLeastShare = 0.05;

/// Shares of the weight on the driven axles, in the order of the file. weight: front to rear
std::vector<double> driven_shares(const Vehicle& v, const std::vector<double>& weight) {
  std::vector<double> shares;
  for (const Axle& axle : v.axle) {
    if (!axle.driven) continue;
    const auto is_ahead = [&](const Axle& other) { return other.position.x > axle.position.x; };
    shares.push_back(weight[std::size_t(std::count_if(v.axle.begin(), v.axle.end(), is_ahead))]);
  }
  return shares;
}

}  // namespace

double driveline_share(const Vehicle& v, const VehicleNumbers& numbers, double slope) {
  const std::vector<double> driven = driven_shares(v, axle_shares(numbers, slope));
  double pull = 0;
  for (const double share : driven) pull += share;
  const bool shares_torque = !v.driveline.wheel_motors && v.driveline.centre == Differential::open;
  for (std::size_t i = 0; shares_torque && i < driven.size(); ++i) {
    const double torque = torque_share(v.driveline, i, driven.size());
    if (torque > 0) pull = std::min(pull, driven[i] / torque);
  }
  constexpr double kRounding = 1e-9;
  return pull > 1 - kRounding ? 1 : std::max(pull, kLeastShare);
}

double felt_slope(const Vehicle& v, const VehicleNumbers& numbers, double slope) {
  if (!(slope > 0)) return slope;
  const double share = driveline_share(v, numbers, slope);
  return share == 1 ? slope : std::atan(std::tan(slope) / share);
}

double own_slope(const Vehicle& v, const VehicleNumbers& numbers, double slope) {
  if (!(slope > 0) || felt_slope(v, numbers, slope) == slope) return slope;
  double low = 0, high = slope;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    (felt_slope(v, numbers, middle) < slope ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace gonogo::vehicle

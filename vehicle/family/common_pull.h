// The pull of a whole vehicle from the forces on its wheels: all wheels turn alike, and statics shares out the weight.
#pragma once
#include <functional>
#include <span>

#include "vehicle/family/vehicle_numbers.h"

namespace gonogo::vehicle {

/// Forces on the wheels of an axle over the load of the axle.
struct AxleForces {
  double pull = 0, side = 0;  // along the heading, and across it against sliding downhill
};

/// Forces on a vehicle over its weight, in one of several ways in which all its wheels may turn: at a slip, say.
struct CommonPull {
  double pull = 0;
  std::size_t way = 0;
};

/// Loads of the axles over those of equally loaded ones, as axle_shares() has them, for wheels to be asked at. Axles
/// that lift off keep a small load, because no wheel was tried without one.
std::vector<double> axle_loads(std::span<const double> shares);

/// The largest pull among the ways whose side force is at least `side`, the tangent of a slope across. Where none has
/// as much, among those within 5 % of the most side force: the vehicle slides sideways. shares: of the weight, by axle.
CommonPull largest_pull(std::span<const double> shares, std::size_t ways, double side,
                        const std::function<AxleForces(std::size_t axle, std::size_t way)>& forces);

}  // namespace gonogo::vehicle

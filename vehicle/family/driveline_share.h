// What a driveline makes of the load on its wheels. Vehicles of the family have a motor in every wheel, which holds all
// of them at one speed: each wheel pulls what its load lets it. Differentials share out torque instead, so that the
// axle that bears least limits all others, and axles without drive only ride along.
#pragma once
#include "vehicle/family/vehicle_numbers.h"

namespace gonogo::vehicle {

/// Largest pull over that of the family's driveline, where pull is proportional to load, on a slope along the vehicle
/// [rad], uphill positive: 1 for a motor in every wheel or locked axles. With s_i the share of the weight on the driven
/// axle i and f_i its share of the torque, an open centre differential leaves min s_i / f_i, and one that is locked or
/// limits slip the sum of s_i. At least 0.05. Left and right wheels count as alike.
double driveline_share(const Vehicle& v, const VehicleNumbers& numbers, double slope);

/// The slope [rad] on which a vehicle of the family needs as much of its wheels as this one does on `slope`:
/// tan(slope) over driveline_share(). Downhill it is the same slope. It rises with `slope`.
double felt_slope(const Vehicle& v, const VehicleNumbers& numbers, double slope);

/// The slope of this vehicle that feels like `slope` to the family's [rad].
double own_slope(const Vehicle& v, const VehicleNumbers& numbers, double slope);

}  // namespace gonogo::vehicle

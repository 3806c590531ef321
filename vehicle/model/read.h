// Readers of the sections of a vehicle file. Each throws through Config::fail: file, place, value, what to do.
#pragma once
#include "base/json/config.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

inline constexpr Range kMass{1e-3, 1e6}, kLength{1e-4, 100}, kForce{-1e8, 1e8};

Vec3d read_vector(const Config& c, const std::string& key, Range range = {-100, 100});
/// Two lists of equal length, the first ascending.
Curve read_curve(const Config& c, const std::string& at, const std::string& value, Range range = kForce);
/// Reads "mass_kg", "centre_m" (when `placed`), "inertia_kg_m2", "products_kg_m2".
Part read_part(const Config& c, const std::string& name, bool placed);
Suspension read_suspension(const Config& c, const std::string& name);
/// Reads "compliant" of a wheel, where it is there.
TyreSpring read_tyre_spring(const Config& wheel);
Wheel read_wheel(const Config& c, const std::string& name);
Axle read_axle(const Config& c);
Track read_track(const Config& c);
Driveline read_driveline(const Config& c);
Differential read_differential(const Config& c, const std::string& key, double& bias);

/// Checks that need more than one section: names, loops, driven axles. `c` is the whole file.
void check_vehicle(const Config& c, const Vehicle& v);
/// Throws for a track whose shoes are too few for its wheels, or too many for its tensioner.
void check_belt(const Config& c, const Vehicle& v);

}  // namespace gonogo::vehicle

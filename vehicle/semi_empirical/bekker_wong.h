// Pressure-sinkage and shear of soft soil (Bekker 1969; Janosi & Hanamoto 1961) under plates, tracks and rigid wheels
// (Wong & Reece, "Prediction of rigid wheel performance based on the analysis of soil-wheel stresses", J.
// Terramechanics 4, 1967).
#pragma once

namespace gonogo::vehicle {

/// p = (k_c / b + k_phi) z^n; tau = (c + p tan phi) (1 - exp(-j / K)).
struct BekkerSoil {
  double n = 1;               // sinkage exponent
  double k_c = 0;             // [N/m^(n+1)]
  double k_phi = 0;           // [N/m^(n+2)]
  double cohesion = 0;        // [Pa]
  double friction_angle = 0;  // [rad]
  double shear_modulus = 0;   // K, Janosi's shear displacement [m]
};

/// Pressure under a plate whose smaller side is `width`, at a sinkage [Pa].
double plate_pressure(const BekkerSoil& soil, double width, double sinkage);
/// Inverse of plate_pressure [m].
double plate_sinkage(const BekkerSoil& soil, double width, double pressure);

/// Forces of a track with uniform pressure.
struct TrackForces {
  double sinkage = 0;     // [m]
  double resistance = 0;  // of compaction [N]
  double thrust = 0;      // [N]
};
TrackForces track_forces(const BekkerSoil& soil, double width, double length, double load, double slip);

/// Angle of the largest normal stress under a wheel: theta_m = (c1 + c2 slip) theta_1.
struct WheelStress {
  double c1 = 0.4, c2 = 0.2;
};

struct WheelForces {
  double entry_angle = 0;             // theta_1 [rad]
  double sinkage = 0;                 // [m]
  double load = 0, drawbar_pull = 0;  // [N]
  double torque = 0;                  // [N m]
};

/// Forces of a rigid wheel that meets the soil at `entry_angle` from its lowest point [rad].
WheelForces wheel_forces(const BekkerSoil& soil, double radius, double width, double slip, double entry_angle,
                         const WheelStress& stress = {});

/// The same for the smallest entry angle that carries `load` [N]. Throws InputError when the wheel sinks to its axle.
WheelForces wheel_forces_under(const BekkerSoil& soil, double radius, double width, double slip, double load,
                               const WheelStress& stress = {});

}  // namespace gonogo::vehicle

// Pressure-sinkage and shear of soft soil (Bekker 1969; Janosi & Hanamoto 1961) under plates, tracks and rigid wheels
// (Wong & Reece, "Prediction of rigid wheel performance based on the analysis of soil-wheel stresses", J.
// Terramechanics 4, 1967). Wheels that slide sideways: Ishigami, Miwa, Nagatani & Yoshida, "Terramechanics-based model
// for steering maneuver of planetary exploration rovers on loose soil", J. Field Robotics 24 (2007) 233-250.
#pragma once

namespace gonogo::vehicle {

/// p = (k_c / b + k_phi) z^n; tau = (c + p tan phi) (1 - exp(-j / K)).
struct BekkerSoil {
  double n = 1;               // sinkage exponent
  double k_c = 0;             // [N/m^(n+1)]
  double k_phi = 0;           // [N/m^(n+2)]
  double cohesion = 0;        // [Pa]
  double friction_angle = 0;  // [rad]
  double shear_modulus = 0;   // K, Janosi's shear displacement, along and across [m]
  double unit_weight = 0;     // of the soil, for what a wheel pushes sideways [N/m^3]
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

/// A rigid wheel. Lugs stand so close that the soil between them turns with the wheel: it rolls and shears on the
/// circle through their tips. Soil shears beside the lugs too, which raises cohesion by 1 + 2 h / b and tan(phi) by 1 +
/// 0.64 (h / b) arccot(h / b) (Bekker 1969, for grousers of height h).
struct RigidWheel {
  double radius = 0, width = 0, lug_height = 0;  // without lugs [m]
  double reach() const { return radius + lug_height; }
};

struct WheelMotion {
  double slip = 0;        // 1 - v / (w reach) with the speed of travel v, whatever its direction; at most 1
  double slip_angle = 0;  // from the way of travel to the wheel's heading, to the left, |angle| <= pi / 2 [rad]
};

struct WheelForces {
  double entry_angle = 0;             // theta_1 [rad]
  double sinkage = 0;                 // of the tips [m]
  double load = 0, drawbar_pull = 0;  // the pull is along the wheel's heading [N]
  double side = 0;                    // to the left of the heading: of the sign of the slip angle [N]
  double torque = 0;                  // [N m]
};

/// Forces of a wheel that meets the soil at `entry_angle` from its lowest point, where it leaves it [rad]. By Ishigami
/// each direction has its own Janosi-Hanamoto curve, and the side that is pushed meets Hegedus's resistance
/// D1 (c h + D2 gamma h^2 / 2), D1 = cot X + tan(X + phi), D2 = cot X + cot^2 X / cot phi, X = 45 deg - phi / 2.
WheelForces wheel_forces(const BekkerSoil& soil, const RigidWheel& wheel, const WheelMotion& motion, double entry_angle,
                         const WheelStress& stress = {});
/// The same for the smallest entry angle that carries `load` [N]. Throws InputError when the wheel sinks to its axle.
WheelForces wheel_forces_under(const BekkerSoil& soil, const RigidWheel& wheel, const WheelMotion& motion, double load,
                               const WheelStress& stress = {});

/// Wheels without lugs that roll straight ahead.
inline WheelForces wheel_forces(const BekkerSoil& soil, double radius, double width, double slip, double entry_angle,
                                const WheelStress& stress = {}) {
  return wheel_forces(soil, RigidWheel{radius, width}, WheelMotion{slip}, entry_angle, stress);
}
inline WheelForces wheel_forces_under(const BekkerSoil& soil, double radius, double width, double slip, double load,
                                      const WheelStress& stress = {}) {
  return wheel_forces_under(soil, RigidWheel{radius, width}, WheelMotion{slip}, load, stress);
}

}  // namespace gonogo::vehicle

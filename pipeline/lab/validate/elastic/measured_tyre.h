// What was measured on one car tyre, 205/60 R15 at 2.2 bar, as the formulas that were fitted to it.
// Numbers: TNO's parameter file TNO_car205_60R15.tir (Delft-Tyre, MF-Tyre/MF-Swift 6.2, 2013), read in the public
// repository github.com/fialaon/VHC_sem. Formulas: Besselink, Schmeitz & Pacejka, An improved Magic Formula/Swift tyre
// model that can handle inflation pressure changes, Vehicle System Dynamics 48:S1, 2010, equations (1), (4), (5), (7),
// (9) and (A48), as the public programs mfeval and Project Chrono (ChMFTire) hold them.
#pragma once

namespace gonogo::lab::measured_tyre {

inline constexpr double kRadius = 0.3135 * 0.9974;                   // UNLOADED_RADIUS times Q_RE0 [m]
inline constexpr double kRimRadius = 0.1905, kSectionWidth = 0.205;  // [m]
inline constexpr double kPressure = 220e3;                           // NOMPRES [Pa]
inline constexpr double kLoad = 4000;                                // FNOMIN [N]
inline constexpr double kSpeed = 16.7;                               // LONGVL [m/s]
inline constexpr double kBeltMass = 7.698, kBeltMoment = 0.4889;     // BELT_MASS [kg], BELT_IYY [kg m^2]
inline constexpr double kShiftFrequency = 76.63;                     // FREQ_LONG, of the belt on a held rim [Hz]
inline constexpr double kTurnFrequency = 67.73;                      // FREQ_WINDUP [Hz]

double deflection(double load, double pressure);                    // at rest [m]
double contact_length(double load, double pressure);                // [m]
double contact_width(double load, double pressure);                 // [m]
double rolling_radius(double load);                                 // at rest, nominal pressure [m]
double rolling_moment(double load, double pressure, double speed);  // about the hub [N m]
inline double shift_stiffness() {                                   // of the belt as a rigid ring [N/m]
  constexpr double w = 2 * 3.14159265358979 * kShiftFrequency;
  return kBeltMass * w * w;
}
inline double turn_stiffness() {  // [N m/rad]
  constexpr double w = 2 * 3.14159265358979 * kTurnFrequency;
  return kBeltMoment * w * w;
}

}  // namespace gonogo::lab::measured_tyre

// What was measured on one car tyre, 205/60 R15 at 2.2 bar, as the formulas that were fitted to it.
// Numbers: TNO's parameter file TNO_car205_60R15.tir (Delft-Tyre, MF-Tyre/MF-Swift 6.2, 2013), read in the public
// repository github.com/fialaon/VHC_sem. Formulas: Besselink, Schmeitz & Pacejka, An improved Magic Formula/Swift tyre
// model that can handle inflation pressure changes, Vehicle System Dynamics 48:S1, 2010, equations (1), (4), (5), (7),
// (9) and (A48), as the public programs mfeval and Project Chrono (ChMFTire) hold them.
#pragma once
#include "sim/elastic/tyre/tyre.h"

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

namespace gonogo::lab {

// A ring fitted to the measured tyre. Sizes, pressure and mass are the tyre's. Three numbers are fitted, each to
// one measured number at the nominal load and pressure: the belt's bending stiffness to the contact length, the
// tangential springs of the sidewalls to the stiffness of the belt against turning on the rim, the loss factor to the
// rolling resistance.

/// Statics: no loss yet.
sim::elastic::Tyre fitted_tyre(int nodes);

struct Patch {
  double deflection = 0, length = 0;  // [m]
};
/// On flat ground. Throws DeviceError where no balance is found.
Patch pressed(const sim::elastic::Tyre& tyre, double load);

struct Rolling {
  double moment = 0;            // about the hub [N m]
  double balance = 0;           // what the hub works less what is lost, over what it works, since the start [-]
  double worked = 0, lost = 0;  // per metre, of the turns that count [N]
};
/// Without friction, at the tyre's loss factor, a pressure and a load, at the measured tyre's speed.
Rolling rolling(sim::elastic::Tyre tyre, double load, double pressure);

/// The loss factor at which the moment at the nominal load and pressure is the measured one.
double fitted_loss(const sim::elastic::Tyre& tyre);

}  // namespace gonogo::lab

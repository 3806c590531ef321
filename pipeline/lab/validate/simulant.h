// A wheel of MGRU3, or the rover, on a lunar simulant whose grains a calibration gives. Shared by the validations
// against tests at NASA Glenn.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/lab/validate/trials.h"

namespace gonogo::lab {

/// Who drives: files of configs/vehicles.
inline constexpr const char* kSimulantWheel = "mgru3_wheel";
inline constexpr const char* kSimulantRover = "mgru3_rover";
inline constexpr double kSimulantWheelSpeed = 0.8;  // [rad/s]

struct SimulantRun {
  std::string vehicle = kSimulantWheel;  // or kSimulantRover
  std::filesystem::path calibration;     // of the grains
  std::string state;                     // of the simulant, in its soil file; empty: the first
  double grain = 0;                      // diameter [m]; 0: the table's. Triaxial tests do not depend on it.
  int seeds = 2;                         // beds per point
  int threads = 1;                       // trials at a time
  bool gpu = false;                      // all trials as one batch
  terrain::AskedNumerics numerics;       // in the place of the table's
  double depth = 0.2;                    // of the bed [m]
  double length = 0;                     // of the bed; 0: 2 for the wheel, 3.5 for the rover [m]
  double width = 0;                      // of the bed; 0: 0.7 for the wheel, folded for the rover [m]
  double time = 0;  // of driving; slip is taken over the last half; 0: 8 for the wheel, 24 for the rover [s]
  // Of grains on the wheel; no experiment gives it. The published simulation (DEM-Engine, WheelSlopeSlip) has 0.8,
  // Project Chrono's VIPER 0.4.
  double wheel_friction = 0.8;
};

/// A state of a soil file of configs/soils, the first where none is named. Throws InputError that lists those there
/// are.
terrain::MacroscopicSoil simulant_soil(const std::string& file, const std::string& state);

/// Radius of a wheel without its grousers, and their height [m].
struct Rim {
  double radius, grouser;
  /// Slip at the circle over the grousers, as experiments give it, from slip at the rim, as trials give it.
  double slip_over_grousers(double slip) const { return 1 - (1 - slip) * radius / (radius + grouser); }
  double slip_of_rim(double slip_over_grousers) const {
    return 1 - (1 - slip_over_grousers) * (radius + grouser) / radius;
  }
};
Rim rim_of(const campaign::TrialSetup& setup);

/// Trials that drive for the run's time, whatever happens, on a moving patch.
campaign::TrialSetup simulant_setup(const SimulantRun& run, const terrain::MacroscopicSoil& soil);

/// On a slope [deg], in the contract's order.
std::vector<double> simulant_variables(const SimulantRun& run, const campaign::TrialSetup& setup,
                                       const terrain::MacroscopicSoil& soil, double slope);

/// As many trials side by side as the run says; the rest as run_trials().
std::vector<campaign::TrialRecord> run_simulant(const SimulantRun& run, const campaign::TrialSetup& setup,
                                                const std::vector<campaign::DesignPoint>& points,
                                                const std::vector<campaign::TrialWatch>& watch = {});

}  // namespace gonogo::lab

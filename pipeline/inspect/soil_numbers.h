// Numbers of soft-soil models from virtual tests of calibrated grains: n, k_c, k_phi of plates (Wong's weighted least
// squares, fit_bekker), c, phi and K of simple shear. `gonogo soil export`.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil_test/strength_test.h"

namespace gonogo::inspect {

/// A number and its standard error.
struct Measure {
  double value = 0, error = 0;
};

struct SoilNumbers {
  std::string soil, state, table;                  // names: of the soil's file, of its state, of the calibration's file
  double grain_diameter = 0;                       // [m]
  Measure n{}, k_c{}, k_phi{};                     // [-], [N/m^(n+1)], [N/m^(n+2)]
  Measure cohesion{}, friction_angle{};            // of steady shear [Pa], [deg]
  Measure peak_cohesion{}, peak_friction_angle{};  // [Pa], [deg]
  Measure janosi{};                                // K [m]
  double bulk_density = 0;                         // [kg/m^3]
  double plate_r2 = 0, shear_r2 = 0;
  std::vector<double> plate_widths{}, stresses{};  // [m], [Pa]
};

struct SoilNumbersRequest {
  std::filesystem::path soil, calibration;
  std::string state;                              // empty: the first
  double grain = 0;                               // [m]; 0: the table's
  std::vector<double> plate_widths{4, 8};         // in grain diameters
  std::vector<double> stresses{5e3, 10e3, 20e3};  // normal [Pa]
  int seeds = 2, threads = 1;
  bool quick = false;
};

/// Runs the tests with the table's numerics. Throws InputError for a soil that the table does not reach.
SoilNumbers measure_soil_numbers(const SoilNumbersRequest& request);

/// "bekker": a file of our own with errors; "scm": the arguments of Project Chrono's SCMTerrain::SetSoilParameters,
/// less elastic_K and damping_R, which no test here measures.
Json numbers_json(const SoilNumbers& numbers, const std::string& format);
std::string numbers_text(const SoilNumbers& numbers);
/// Reads a "bekker" file back.
SoilNumbers read_soil_numbers(const std::filesystem::path& file);

}  // namespace gonogo::inspect

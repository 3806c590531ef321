// Soil files (configs/soils/*.json, schema configs/schema/soil.json): macroscopic properties at one or more moistures.
// Each is a value or a range, with its source.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// A property: uniformly distributed from low to high.
struct SoilValue {
  double low = 0, high = 0;
  std::string source, no_source, note;  // `source` or `no_source` is set

  double middle() const { return (low + high) / 2; }
  bool fixed() const { return low == high; }
};

struct Bekker {
  SoilValue n, k_c, k_phi;  // [-], [kN/m^(n+1)], [kN/m^(n+2)]
};

struct SoilState {
  std::string name, texture, moisture, note;
  std::optional<double> water_percent;
  SoilValue friction_angle;    // [deg]
  SoilValue cohesion;          // [kPa]
  SoilValue bulk_density;      // [kg/m^3]
  SoilValue relative_density;  // [-]
  std::optional<Bekker> bekker;
  std::optional<SoilValue> janosi;  // shear displacement K of Janosi and Hanamoto [mm]

  /// The middle of every range.
  MacroscopicSoil macroscopic() const;
};

struct SoilFile {
  std::string name, about;
  std::vector<SoilState> states;
  Json fits;  // by name of the table; null if there are none
};

/// Throws InputError for files that the schema does not allow.
SoilFile read_soil(const std::filesystem::path& path);

/// Fit of a state by a table: contact law, density of the solid and mismatches, or why there is no fit.
Json fit_record(const Calibration& calibration, const SoilState& state);

/// Writes the fits of all states by this table into the file, in place of earlier fits by a table of that name.
void write_fits(const std::filesystem::path& path, const std::string& table, const Calibration& calibration);

}  // namespace gonogo::terrain

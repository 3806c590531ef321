// Soils as files (configs/soils/*.json, schema configs/schema/soil.json): macroscopic numbers, each a value or a range
// with its source, at one or several moistures.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// A number of a soil: every value from low to high is as likely.
struct SoilValue {
  double low = 0, high = 0;
  std::string source, no_source, note;  // one of the first two is not empty

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

  /// The middles of all ranges.
  MacroscopicSoil macroscopic() const;
};

struct SoilFile {
  std::string name, about;
  std::vector<SoilState> states;
  Json fits;  // by table, or null
};

/// Throws InputError for what the schema does not allow.
SoilFile read_soil(const std::filesystem::path& path);

/// What a table of grains makes of a state: contact law, density of the solid and mismatches, or why it is refused.
Json fit_record(const Calibration& calibration, const SoilState& state);

/// The file with the fits of all its states to a table of this name, in place of earlier ones to the same.
void write_fits(const std::filesystem::path& path, const std::string& table, const Calibration& calibration);

}  // namespace gonogo::terrain

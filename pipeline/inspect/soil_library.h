// `gonogo soil list|show`: the soils that ship, for people and for programs.
#pragma once
#include <filesystem>
#include <string>

#include "base/json/json.h"

namespace gonogo::inspect {

struct SoilReport {
  Json json;         // keys carry their units
  std::string text;  // tables
};

/// A soil's file: a path, or a name in configs/soils. Throws InputError with the known names.
std::filesystem::path soil_file(const std::string& name);

SoilReport list_soils();

/// `calibration`: a table, or empty.
SoilReport show_soil(const std::filesystem::path& file, const std::filesystem::path& calibration);

}  // namespace gonogo::inspect

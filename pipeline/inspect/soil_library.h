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

/// What all tests of each state together speak for, by a table, and which of them disagree. `stress`: normal stress at
/// which the strength acts [Pa]; 0: as tested.
SoilReport weigh_evidence(const std::filesystem::path& file, const std::filesystem::path& calibration, double stress);

/// Cohesion of fine-grained soil that shows a cone index [Pa], at one friction angle [deg] or, below zero, at several.
SoilReport strength_of_cone(double index, double friction_angle);

/// Cone index of each state of a soil; fine-grained ones only, others are named.
SoilReport cone_of_soil(const std::filesystem::path& file);

}  // namespace gonogo::inspect

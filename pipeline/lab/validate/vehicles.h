// Whole vehicles on hard ground against closed forms, with a figure and its numbers for each kind of check.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "vehicle/hard_ground/track_checks.h"

namespace gonogo::lab {

/// Wheel loads, gradeability, top speed in the lower gears, stopping distance, frequencies of the suspension.
std::vector<vehicle::HardGroundReport> check_on_hard_ground(const vehicle::Vehicle& v,
                                                            const vehicle::HardGroundRun& run);

/// Expected, measured, tolerance and whether it holds, by key.
Json as_json(const std::vector<vehicle::HardGroundReport>& reports);
/// The same as a table for people.
std::string as_text(const std::vector<vehicle::HardGroundReport>& reports);
int failures(const std::vector<vehicle::HardGroundReport>& reports);

/// Writes <vehicle>_<name>.csv and, where the build has pictures, .png of each report, and <vehicle>.json.
void write_reports(const std::filesystem::path& folder, const std::string& vehicle,
                   const std::vector<vehicle::HardGroundReport>& reports);

}  // namespace gonogo::lab

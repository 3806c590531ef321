// A study: one JSON file that says what to simulate, learn and map. Each section is read by the room that uses it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/json/config.h"

namespace gonogo::campaign {

struct Study {
  std::filesystem::path file;
  std::string name;               // "study"
  std::uint64_t seed = 0;         // of everything random in the study
  Config config;                  // the whole file; config.object("trial") and so on are the sections
  std::filesystem::path vehicle;  // JSON of the vehicle; empty when the study names none
  std::filesystem::path region;   // JSON of the region; empty when the study names none

  /// A section that this command cannot do without; throws InputError naming the file and the missing section.
  Config section(const std::string& key) const { return config.object(key); }
};

/// Reads the frame of a study: name, seed, paths of vehicle and region, and no key but
/// study, about, seed, vehicle, soil, trial, design, compute, learning, region, map. Throws InputError.
/// Paths are relative to the study's folder. The sections' own keys are checked by the rooms that read them.
Study read_study(const std::filesystem::path& path);

}  // namespace gonogo::campaign

// A study: one JSON file that says what to simulate, learn and map. The folder that uses a section reads it.
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

/// Reads the frame of a study: name, seed, and the paths of vehicle and region, relative to the study's folder. Readers
/// of sections check the keys inside. Throws InputError for top-level keys other than study, about, seed, vehicle,
/// soil, trial, design, compute, learning, region and map.
Study read_study(const std::filesystem::path& path);

}  // namespace gonogo::campaign

// A study: one JSON file that says what to simulate, learn and map. The folder that uses a section reads it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/json/config.h"
#include "base/units.h"

namespace gonogo::campaign {

struct Study {
  std::filesystem::path file;
  std::string name;               // "study"
  std::uint64_t seed = 0;         // of everything random in the study
  Config config;                  // the whole file; config.object("trial") and so on are the sections
  std::filesystem::path vehicle;  // JSON of the vehicle; empty when the study names none
  std::filesystem::path region;   // JSON of the region; empty when the study names none
  double gravity = kGravity;      // where its vehicle drives [m/s^2]
  /// Texts of "vehicle" and "calibration", of a study that a dataset holds with its files; otherwise empty.
  std::map<std::string, std::string> stored{};

  /// One of those files: what is stored, otherwise what is at `path`.
  Config file_named(const std::string& name, const std::filesystem::path& path) const;

  /// A section that this command cannot do without; throws InputError naming the file and the missing section.
  Config section(const std::string& key) const { return config.object(key); }
};

/// Gravity that trials can have [m/s^2]: from small moons to above that of Jupiter's cloud tops.
inline constexpr Range kGravityRange{0.1, 30};
inline constexpr Range kWheelRollingRange{0, 10};  // of trial.wheel_rolling
/// Key of the gravity in model and map files, which only those of another gravity than the Earth's hold.
inline constexpr const char* kGravityKey = "gravity_m_per_s2";

/// Reads the frame of a study: name, seed, gravity, and the paths of vehicle and region, relative to the study's
/// folder. Readers of sections check the keys inside. Throws InputError for top-level keys other than study, about,
/// seed, gravity, vehicle, soil, trial, design, compute, learning, region and map.
Study read_study(const std::filesystem::path& path);
Study read_study(const Config& config);

}  // namespace gonogo::campaign

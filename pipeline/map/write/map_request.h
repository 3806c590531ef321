// From files to a map request: what the commands `map` and `run` share.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

struct MapFiles {
  std::filesystem::path model;                   // model.h5
  std::vector<std::filesystem::path> members{};  // of the model, for its spread
  std::filesystem::path region;                  // region JSON; empty: the one that the study names
  std::filesystem::path study;                   // study JSON for its sections map, region and vehicle; empty: defaults
  std::filesystem::path dataset{};               // trials, for expected speed, slip and sinkage; empty: none
  std::filesystem::path vehicle{};               // whose cone index fine-grained soil must reach; empty: the study's
  std::string moisture{};                        // "dry", "moist" or "wet"; empty: the study's
  std::string heading{};                         // as in MapRules; empty: the study's
  std::filesystem::path out;                     // folder
  bool colour_blind_safe = false;
  int threads = 0;  // 0: all cores
};

/// Reads the model, the region and the rules. Throws InputError, also when neither a region nor a study that names one
/// is given.
MapRequest read_map_request(const MapFiles& files);

/// VCI1 and VCI50 of a vehicle file; throws InputError for one that has none, such as a rig of one wheel.
ConeIndexNeed read_cone_index_need(const std::filesystem::path& file);

}  // namespace gonogo::map

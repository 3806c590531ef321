// Reads the files that a map is made from. The commands `map` and `run` share it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

struct MapFiles {
  std::filesystem::path model;                   // model.h5
  std::vector<std::filesystem::path> members{};  // bootstrap members of the model; empty: none
  std::filesystem::path region;                  // region JSON; empty: as the study says
  std::filesystem::path study;                   // study JSON: sections map, region and vehicle; empty: defaults
  std::filesystem::path dataset{};               // trials, for speed, slip and sinkage; empty: no such layers
  std::filesystem::path vehicle{};               // for its VCI, the limit of fine-grained soil; empty: the study's
  std::string moisture{};                        // "dry", "moist" or "wet"; empty: the study's
  std::string heading{};                         // as in set_heading(); empty: the study's
  std::filesystem::path out;                     // folder of the map
  bool colour_blind_safe = false;
  int threads = 0;  // 0: all cores
};

/// Reads the model, the region and the rules. Throws InputError for files that cannot be used, and if neither `region`
/// nor the study names a region.
MapRequest read_map_request(const MapFiles& files);

/// VCI1 and VCI50 [Pa] of a vehicle file. Throws InputError for a vehicle without them, such as a rig of one wheel.
ConeIndexNeed read_cone_index_need(const std::filesystem::path& file);

}  // namespace gonogo::map

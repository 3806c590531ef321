// Reads the files that a map is made from. The commands `map` and `run` share it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

struct MapFiles {
  std::filesystem::path model;                   // as find_model() takes it; empty: the one that ships for `vehicle`
  std::vector<std::filesystem::path> members{};  // bootstrap members of the model; empty: none
  std::filesystem::path region;                  // region JSON; empty: as the study says
  std::filesystem::path dem{};                   // elevation raster, in place of a region
  std::string soil{};                            // with `dem`: as named_soil() takes it, or a raster of USDA textures
  std::string cone_index{};                      // with `dem`: "60", "60psi", "414kPa" or a raster [psi]; empty: none
  std::string height_unit{};                     // "m", "ft" or "us-ft"; empty: as region and raster say
  bool flat_is_ground = false;                   // large exactly flat areas are ground
  std::filesystem::path crossing_model{};  // of ditches, as `model`; empty: the shipped one of its vehicle, if any
  std::filesystem::path study;             // study JSON: sections map, region and vehicle; empty: defaults
  std::filesystem::path dataset{};         // trials of the model; empty: those beside the model, if any
  std::filesystem::path vehicle{};         // must be the model's; empty: whichever that is. Names a shipped model, too
  std::filesystem::path whole_vehicle{};   // that a quarter vehicle stands for; empty: the study's
  std::string moisture{};                  // "dry", "moist" or "wet"; empty: the study's
  std::vector<std::string> set{};          // "payload=500": values of the mission
  double max_speed_km_h = 0;               // 0: the study's, or none
  std::string heading{};                   // as in set_heading(); empty: the study's
  std::filesystem::path out;               // folder of the map
  bool colour_blind_safe = false;
  int threads = 0;  // 0: all cores
};

/// Reads the model, the region and the rules. Variables of the mission that nobody gave take the range that trials
/// sampled, where the region is an elevation raster alone; in a region file they are summed out. Throws InputError for
/// files that cannot be used, for a model of another vehicle or other grains than asked, and without any region. The
/// model of a family answers for any vehicle of it, at the gravity of the ground. For a vehicle without a model the
/// message says how to make one, and what that costs here.
/// Ditches of the region are answered by a model of trials that cross them: the one asked for, or the one that ships
/// for the model's vehicle.
MapRequest read_map_request(const MapFiles& files);

/// VCI1 and VCI50 [Pa] of a vehicle file. Throws InputError for a vehicle without them, such as a rig of one wheel.
ConeIndexNeed read_cone_index_need(const std::filesystem::path& file);

}  // namespace gonogo::map

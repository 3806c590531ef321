// A region file from a folder of soil rasters and an elevation model.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gonogo::map {

struct RegionMakeRequest {
  std::filesystem::path folder;
  std::string name{};            // of the region; empty: the folder's
  std::optional<int> suction{};  // 10, 33 or 1500 kPa: which water is the ground's; none: 33, or the only one given
  double texture_error = 10;     // standard error of sand and clay without low and high values [%]; no source
};

struct RegionMade {
  std::vector<std::filesystem::path> files;  // the region file is the first
  std::vector<std::string> remarks;          // without a full stop
  int soils = 0;                             // mixtures
};

/// Writes soil_class.tif (a code for each mixture of textures), water.tif (where water and bulk density are given) and
/// region.json into the folder. Throws InputError for folders and rasters that cannot be used, among them shares that
/// do not add up to 100 %, and a soil that does not overlap the elevation.
RegionMade make_region(const RegionMakeRequest& request);

}  // namespace gonogo::map

// The twelve texture classes of the USDA, and which of them are fine-grained soils.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

namespace gonogo::terrain {

/// Names in lower case, from coarse to fine.
inline const std::vector<std::string>& usda_textures() {
  static const std::vector<std::string> names = {
      "sand", "loamy sand", "sandy loam",      "sandy clay loam", "loam",       "silt loam",
      "silt", "clay loam",  "silty clay loam", "sandy clay",      "silty clay", "clay"};
  return names;
}

/// The textures in the order of their codes 1 to 12 in rasters, as NRCS SSURGO derivatives and configs/regions have it:
/// 1 sand to 12 clay.
inline const std::vector<std::string>& usda_texture_codes() {
  static const std::vector<std::string> names = {
      "sand",      "loamy sand",      "sandy loam", "loam",       "silt loam", "silt", "sandy clay loam",
      "clay loam", "silty clay loam", "sandy clay", "silty clay", "clay"};
  return names;
}

/// Fine-grained in the sense of the cone index: more than half passes the 0.075 mm sieve (FM 5-430-00-1, chapter 7).
/// The triangle's silt and clay end at 0.05 mm, so that a class counts from a middle of its area of 48 % silt and clay
/// on: sandy clay is the coarsest of them; sandy clay loam (40 %) and what lies before it in the list are not.
inline bool is_fine_grained(const std::string& texture) {
  const auto& all = usda_textures();
  const auto place = std::find(all.begin(), all.end(), texture) - all.begin();
  return place >= 4 && place < std::ptrdiff_t(all.size());
}

}  // namespace gonogo::terrain

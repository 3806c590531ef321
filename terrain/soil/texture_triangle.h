// The USDA texture triangle.
#pragma once
#include <string>

namespace gonogo::terrain {

/// Texture class of shares by mass of the particles below 2 mm [%], which add up to 100. One of usda_textures().
/// Source: Soil Science Division Staff, Soil Survey Manual, USDA Handbook 18 (2017), chapter 3, texture classes.
inline std::string usda_texture(double sand, double silt, double clay) {
  if (silt + 1.5 * clay < 15) return "sand";
  if (silt + 2 * clay < 30) return "loamy sand";
  if (clay >= 40) return sand > 45 ? "sandy clay" : silt >= 40 ? "silty clay" : "clay";
  if (clay >= 35 && sand > 45) return "sandy clay";
  if (clay >= 27) {
    if (sand > 45) return silt < 28 ? "sandy clay loam" : "clay loam";
    return sand > 20 ? "clay loam" : "silty clay loam";
  }
  if (silt >= 80 && clay < 12) return "silt";
  if (silt >= 50) return "silt loam";
  if (clay >= 20 && silt < 28) return "sandy clay loam";
  if (clay < 7 || sand > 52) return "sandy loam";
  return "loam";
}

}  // namespace gonogo::terrain

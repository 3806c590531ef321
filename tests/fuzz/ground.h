// What several readers' files are made of.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "base/files/file.h"
#include "tests/terrain/raster_maker.h"

namespace gonogo::fuzz {

inline constexpr int kSide = 40;  // cells

/// 40 x 40 cells of 10 m in UTM zone 10, a plain with waves.
inline test::RasterRecipe ground() {
  test::RasterRecipe recipe{.columns = kSide, .rows = kSide};
  for (int i = 0; i < kSide * kSide; ++i) recipe.value.push_back(float(100 + i % 7 + 0.25 * (i / kSide)));
  return recipe;
}

/// Writes a file of text into a folder.
inline std::function<void(const std::filesystem::path&)> writing(const std::string& file, const std::string& text) {
  return [file, text](const std::filesystem::path& folder) { write_file_atomically(folder / file, text); };
}

}  // namespace gonogo::fuzz

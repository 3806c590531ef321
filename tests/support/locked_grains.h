// Soil in which rounding does not grow: for tests that compare trials which are equal but for it.
#pragma once
#include <filesystem>

#include "terrain/soil/calibration.h"

namespace gonogo::test {

/// Its grains hardly roll at friction angles above 32 degrees; an older table, see tests/data/soils.
inline terrain::Calibration locked_grains() {
  return terrain::read_calibration(std::filesystem::path(GONOGO_SOURCE_DIR) /
                                   "tests/data/soils/calibration_90mm_shear.json");
}

}  // namespace gonogo::test

// Virtual soil tests against soil mechanics, and soils of configs/soils against tests of their calibrated grains.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/lab/validate/check_figure.h"

namespace gonogo::lab {

struct SoilValidation {
  std::filesystem::path calibration;  // its grains are tested
  int seeds = 2;                      // packings per test
  int threads = 1;
  bool quick = false;  // smaller beds and shorter ways
};

/// Names of all figures: shear, triaxial, plate, cone, repose, geostatic, inversion.
const std::vector<std::string>& soil_figures();

/// Runs what one figure shows. Throws InputError for an unknown name.
CheckFigure soil_figure(const std::string& name, const SoilValidation& run);

}  // namespace gonogo::lab

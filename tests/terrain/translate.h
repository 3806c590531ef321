// What gdal_translate does, for tests that follow advice.
#pragma once
#include <gdal_utils.h>

#include <string>

#include "tests/support/catch.h"

namespace gonogo::test {

/// gdal_translate -a_srs <system> <in> <out>
inline void translate(const std::string& in, const std::string& system, const std::string& out) {
  GDALAllRegister();
  const GDALDatasetH source = GDALOpen(in.c_str(), GA_ReadOnly);
  REQUIRE(source != nullptr);
  std::string option = "-a_srs", value = system;
  char* words[] = {option.data(), value.data(), nullptr};
  GDALTranslateOptions* options = GDALTranslateOptionsNew(words, nullptr);
  const GDALDatasetH made = GDALTranslate(out.c_str(), source, options, nullptr);
  GDALTranslateOptionsFree(options);
  REQUIRE(made != nullptr);
  GDALClose(made);
  GDALClose(source);
}

}  // namespace gonogo::test

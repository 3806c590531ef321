// A region: its rasters, and what its soil classes mean in the variables of the contract. configs/schema/region.json
// describes the file.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/map/spread.h"

namespace gonogo::pipeline {

struct RegionRaster {
  std::filesystem::path file;
  std::string source, licence;
  double error = 0;              // of elevations: standard error [m], 0 when not stated
  double error_correlation = 0;  // between neighbouring cells
};

/// Values measured together on one sample of a soil; the rest of the soil's variables follow its own spreads.
struct SoilSample {
  Spreads values;  // all fixed
  std::string source;
};

struct Soil {
  int code = 0;  // in the soil class raster
  std::string name;
  std::string note;
  std::vector<SoilSample> samples;  // equally likely; empty: only `values`
  Spreads values;
};

struct Region {
  std::filesystem::path file;
  std::string name, about;
  RegionRaster elevation;
  std::optional<RegionRaster> soil_class;
  std::vector<Soil> soils;  // empty when the region names no soil raster: `values` hold everywhere
  Spreads values;           // for every soil that does not say otherwise
};

/// Throws InputError. Paths are relative to the region's folder; the rasters themselves are opened by the map.
Region read_region(const std::filesystem::path& path);

/// Equally weighted points of a soil over the variables of the contract (slopes not-a-number): every sample with every
/// drawn point of the ranges. `overriding` values win over the soil's, those over the region's.
std::vector<std::vector<double>> soil_points(const Region& region, const Soil& soil, const Spreads& overriding,
                                             int draws);

}  // namespace gonogo::pipeline

// The soils of a region with their tabulated answers, looked up by the code of the soil raster.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/map/region.h"
#include "pipeline/map/soil_response.h"

namespace gonogo::pipeline {

struct SoilTable {
  std::vector<Soil> soils;
  std::vector<SoilResponse> responses;         // [soils]
  std::unordered_map<int, int> index_of_code;  // code in the raster -> position in `soils`
  std::vector<std::uint64_t> cells;            // [soils], cells with a slope, counted while the map is made
};

}  // namespace gonogo::pipeline

// The soils of a region with their tabulated answers, looked up by the code of the soil raster and the state of the
// moisture.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/map/region.h"
#include "pipeline/map/soil_response.h"

namespace gonogo::pipeline {

struct SoilTable {
  static constexpr int kUnknown = -1;

  std::vector<Soil> soils;                   // with "wet" and the like in the name where moisture is told apart
  std::vector<SoilResponse> responses;       // [soils]
  std::vector<int> moisture;                 // [soils] state, 0: any; k: the region's k-th
  std::vector<std::uint64_t> cells;          // [soils], cells with a slope, counted while the map is made
  std::vector<std::string> without_samples;  // "wet loam": soils that no sample tells anything of

  /// Position in `soils`; kUnknown for a code that the table does not list, or without samples in this state.
  int find(int code, int state) const {
    const auto found = index_.find(key(code, state));
    return found == index_.end() ? kUnknown : found->second;
  }
  void add(Soil soil, int state, SoilResponse response) {
    index_[key(soil.code, state)] = int(soils.size());
    soils.push_back(std::move(soil));
    responses.push_back(std::move(response));
    moisture.push_back(state);
    cells.push_back(0);
  }

 private:
  static std::int64_t key(int code, int state) { return std::int64_t(code) * 8 + state; }
  std::unordered_map<std::int64_t, int> index_;
};

}  // namespace gonogo::pipeline

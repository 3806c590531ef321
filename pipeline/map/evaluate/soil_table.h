// The soils of a region with their tabulated answers, looked up by the code of the soil raster and the state of the
// moisture, and of fine-grained soils also by whether their cone index was measured and is high enough.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/region/region.h"

namespace gonogo::map {

struct SoilTable {
  static constexpr int kUnknown = -1;

  std::vector<Soil> soils;                   // with "wet" and the like in the name where moisture is told apart
  std::vector<SoilResponse> responses;       // [soils]
  std::vector<int> moisture;                 // [soils] state, 0: any; k: the region's k-th
  std::vector<char> may_be_soft;             // [soils] not known to be coarse: a measured cone index counts
  ConeIndexNeed need;                        // what it is compared with
  std::vector<std::uint64_t> cells;          // [soils], cells with a slope, counted while the map is made
  std::vector<std::string> without_samples;  // "wet loam": soils that no sample tells anything of

  /// Position in `soils`; kUnknown for a code that the table does not list, or without samples in this state.
  int find(int code, int state) const { return find(key(code, state, false)); }
  /// The same soil where a cone found it firm enough.
  int find_firm(int code, int state) const { return find(key(code, state, true)); }

  void add(Soil soil, int state, bool soft_allowed, bool firm, SoilResponse response) {
    index_[key(soil.code, state, firm)] = int(soils.size());
    may_be_soft.push_back(soft_allowed);
    soils.push_back(std::move(soil));
    responses.push_back(std::move(response));
    moisture.push_back(state);
    cells.push_back(0);
  }

 private:
  static std::int64_t key(int code, int state, bool firm) { return std::int64_t(code) * 16 + 2 * state + firm; }
  int find(std::int64_t key) const {
    const auto found = index_.find(key);
    return found == index_.end() ? kUnknown : found->second;
  }
  std::unordered_map<std::int64_t, int> index_;
};

}  // namespace gonogo::map

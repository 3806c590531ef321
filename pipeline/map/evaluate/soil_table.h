// The soils of a region with their tabulated answers. The key is the soil code of the raster and the moisture state.
// Fine-grained soils have a second entry for cells whose measured cone index is high enough. Ditches that a model
// answers for have an entry for every soil in which they lie.
#pragma once
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/region/region.h"

namespace gonogo::map {

struct SoilTable {
  static constexpr int kUnknown = -1;

  std::vector<Soil> soils;                   // the name includes the moisture state, if there is one
  std::vector<SoilResponse> responses;       // [soils]
  std::vector<int> moisture;                 // [soils] 0: any state; k: the region's k-th state
  std::vector<char> may_be_soft;             // [soils] 1: may be fine-grained, a measured cone index counts
  ConeIndexNeed need;                        // the measured cone index is compared with it
  std::vector<std::uint64_t> cells;          // [soils] cells with a slope; counted while the map is made
  std::vector<std::string> without_samples;  // "wet loam": soils without a sample in that state
  std::vector<char> has_ditch;               // [soils] 1: the entry of a ditch

  /// Position in `soils`. kUnknown if the table does not list the code or has no sample in this state.
  int find(int code, int state) const { return find(key(code, state, false)); }
  /// The entry for cells whose measured cone index is high enough.
  int find_firm(int code, int state) const { return find(key(code, state, true)); }

  void add(Soil soil, int state, bool soft_allowed, bool firm, SoilResponse response) {
    index_[key(soil.code, state, firm)] = int(soils.size());
    append(std::move(soil), state, soft_allowed, std::move(response), false);
  }

  /// The entry of a ditch, by its number, in the soil at a position of `soils`.
  int find_ditch(int soil, int ditch) const {
    const auto found = ditch_.find({soil, ditch});
    return found == ditch_.end() ? kUnknown : found->second;
  }
  void add_ditch(int soil, int ditch, Soil with_ditch, SoilResponse response) {
    const std::size_t ground = std::size_t(soil);
    ditch_[{soil, ditch}] = int(soils.size());
    append(std::move(with_ditch), moisture[ground], may_be_soft[ground], std::move(response), true);
  }

 private:
  void append(Soil soil, int state, bool soft_allowed, SoilResponse response, bool ditch) {
    may_be_soft.push_back(soft_allowed);
    has_ditch.push_back(ditch);
    soils.push_back(std::move(soil));
    responses.push_back(std::move(response));
    moisture.push_back(state);
    cells.push_back(0);
  }

  static std::int64_t key(int code, int state, bool firm) { return std::int64_t(code) * 16 + 2 * state + firm; }
  int find(std::int64_t key) const {
    const auto found = index_.find(key);
    return found == index_.end() ? kUnknown : found->second;
  }
  std::unordered_map<std::int64_t, int> index_;
  std::map<std::pair<int, int>, int> ditch_;  // (position of the soil, number of the ditch)
};

}  // namespace gonogo::map
